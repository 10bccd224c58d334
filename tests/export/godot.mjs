// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the bodies of a scene that `export --to godot` wrote, as Godot 4 would place them: a body stands where its bone
// does, without the bone's scale.
import { readFileSync } from 'node:fs';
import { Matrix4, Quaternion, Vector3 } from 'three';

export const ending = 'tscn', shapes = ['spheres', 'capsules', 'boxes'];

// Sections as { tag, HEADER'S KEYS, PROPERTIES }; values stay text. A string may have several lines.
function parse(text) {
  const sections = [];
  const pattern = /^;.*$|^\[(\w+)((?:\s+\w+=(?:"(?:[^"\\]|\\.)*"|\S+?))*)\]$|^([\w/]+) = ((?:"(?:[^"\\]|\\[^])*"|[^"\n])*)$/gm;
  for (const [, tag, header, key, value] of text.matchAll(pattern)) {
    if (tag) {
      const keys = [...header.matchAll(/(\w+)=("(?:[^"\\]|\\.)*"|\S+)/g)].map(([, k, v]) => [k, JSON.parse(v)]);
      sections.push({ tag, ...Object.fromEntries(keys) });
    } else if (key) {
      sections.at(-1)[key] = value;
    }
  }
  return sections;
}

const numbers = (text) => /\((.*)\)/.exec(text)[1].split(',').map(Number);

function transformOf(text) {
  const m = numbers(text);
  const basis = new Matrix4().set(m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, 0, 0, 0, 1);
  return { position: m.slice(9), rotation: new Quaternion().setFromRotationMatrix(basis).toArray() };
}

function volumeOf(shape, { position: center, rotation }) {
  const radius = Number(shape.radius);
  if (shape.type === 'SphereShape3D') return { type: 'sphere', center, radius };
  if (shape.type === 'BoxShape3D') return { type: 'box', center, rotation, half: numbers(shape.size).map((s) => s / 2) };
  if (shape.type !== 'CapsuleShape3D' || !(shape.height >= 2 * radius)) throw new Error(`what is ${JSON.stringify(shape)}`);
  const along = new Vector3(0, Number(shape.height) / 2 - radius, 0).applyQuaternion(new Quaternion(...rotation));
  const middle = new Vector3(...center);
  return { type: 'capsule', a: middle.clone().sub(along).toArray(), b: middle.clone().add(along).toArray(), radius };
}

export function rebuild(path, file) {
  const text = readFileSync(path, 'utf8');
  if (!/^\[gd_scene [^\]]*format=3\]\n/.test(text)) throw new Error('not a scene of Godot 4');
  const sections = parse(text);
  const resources = new Map(sections.filter(({ tag }) => tag === 'sub_resource').map((r) => [r.id, r]));
  const [root, ...nodes] = sections.filter(({ tag }) => tag === 'node');
  if (root.type !== 'PhysicalBoneSimulator3D' || root.parent !== undefined) throw new Error('the root is no simulator');
  if (!resources.get('script')['script/source'].includes(`extends ${root.type}`)) throw new Error('not the script of its node');
  const partOf = new Map();
  const bodies = nodes.filter(({ type }) => type === 'PhysicalBone3D').map((body) => {
    const bone = JSON.parse(body.bone_name), { part } = file.bodies.find((one) => one.bone === bone);
    partOf.set(body.name, part);
    if (body.parent !== '.') throw new Error(`${part} is not the simulator's child`);
    const volumes = nodes.filter(({ type, parent }) => type === 'CollisionShape3D' && parent === body.name)
      .map((node) => volumeOf(resources.get(/"(.*)"/.exec(node.shape)[1]), transformOf(node.transform)));
    return { part, rest: transformOf(body.transform), volumes };
  });
  const names = JSON.parse(`[${/\((.*)\)/.exec(root.ignored)[1]}]`);
  const ignored = [];
  for (let i = 0; i < names.length; i += 2) ignored.push([partOf.get(names[i]), partOf.get(names[i + 1])]);
  return { bodies, ignored };
}
