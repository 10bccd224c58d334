// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the bodies of a stage that `export --to usd` wrote: a parser of USD's text form, as much as that needs.
import { readFileSync } from 'node:fs';
import { Quaternion, Vector3 } from 'three';

export const ending = 'usda', shapes = ['spheres', 'cones', 'capsules', 'ellipsoids', 'boxes'];

// Prims as { type, name, children, schemas, NAME OF AN ATTRIBUTE: value }.
function parse(text) {
  const root = { children: [] }, stack = [root];
  let header = null;
  for (const line of text.split('\n').map((l) => l.trim())) {
    const def = /^def (\w+) "(\w+)"( \()?$/.exec(line);
    const attribute = /^(?:custom |uniform |prepend )*([\w[\]]+ )?([\w:]+) = (.*)$/.exec(line);
    if (def) {
      const prim = { type: def[1], name: def[2], children: [] };
      stack.at(-1).children.push(prim);
      header = prim;
    } else if (line === '{' && header) {
      stack.push(header);
      header = null;
    } else if (line === '}') {
      if (stack.length > 1) stack.pop();
    } else if (attribute && !/\{$/.test(line)) {
      (header ?? stack.at(-1))[attribute[2]] = attribute[3];
    } else if (/\{$/.test(line)) {
      stack.push({ children: [] });  // a dictionary of the layer
    }
  }
  return root;
}

const numbers = (text) => text.replace(/[()[\]]/g, '').split(',').map(Number);
const rotation = (text) => { const [w, x, y, z] = numbers(text); return [x, y, z, w]; };

function volumeOf(prim) {
  if (!prim.apiSchemas.includes('PhysicsCollisionAPI')) throw new Error(`${prim.name} is no collider`);
  const center = numbers(prim['xformOp:translate']), turn = rotation(prim['xformOp:orient']);
  const scale = prim['xformOp:scale'] ? numbers(prim['xformOp:scale']) : [1, 1, 1];
  if (prim.type === 'Cube') return { type: 'box', center, rotation: turn, half: scale.map((s) => (s * Number(prim.size)) / 2) };
  if (prim.type === 'Sphere') {
    const radius = Number(prim.radius);
    if (!prim['xformOp:scale']) return { type: 'sphere', center, radius };
    return { type: 'ellipsoid', center, rotation: turn, radii: scale.map((s) => s * radius) };
  }
  if (!/^Capsule(_1)?$/.test(prim.type) || prim.axis !== '"Y"') throw new Error(`what is ${prim.type} along ${prim.axis}`);
  const along = new Vector3(0, Number(prim.height) / 2, 0).applyQuaternion(new Quaternion(...turn));
  const middle = new Vector3(...center);
  const [a, b] = [middle.clone().sub(along).toArray(), middle.clone().add(along).toArray()];
  if (prim.type === 'Capsule') return { type: 'capsule', a, b, radius: Number(prim.radius) };
  return { type: 'cone', a, b, radius_a: Number(prim.radiusBottom), radius_b: Number(prim.radiusTop) };
}

export function rebuild(path) {
  const text = readFileSync(path, 'utf8');
  if (!text.startsWith('#usda 1.0\n') || !/metersPerUnit = 1\n/.test(text)) throw new Error('not a stage in metres');
  const [stage] = parse(text).children.filter(({ type }) => type === 'Xform');
  const parts = new Map(stage.children.map((prim) => [prim.name, JSON.parse(prim['spherechain:part'])]));
  const bodies = [], ignored = [];
  for (const prim of stage.children) {
    if (!prim.apiSchemas.includes('PhysicsRigidBodyAPI') || prim['physics:kinematicEnabled'] !== '1') throw new Error(`${prim.name} is no kinematic body`);
    const filtered = prim['physics:filteredPairs'];
    if (Boolean(filtered) !== prim.apiSchemas.includes('PhysicsFilteredPairsAPI')) throw new Error(`${prim.name}: pairs without their schema`);
    for (const [, other] of (filtered ?? '').matchAll(/<\/colliders\/(\w+)>/g)) ignored.push([parts.get(prim.name), parts.get(other)]);
    bodies.push({
      part: parts.get(prim.name),
      rest: { position: numbers(prim['xformOp:translate']), rotation: rotation(prim['xformOp:orient']) },
      volumes: prim.children.map(volumeOf),
    });
  }
  return { bodies, ignored };
}
