#!/usr/bin/env node
// SPDX-License-Identifier: MIT
// Compares hide masks with masks that people made, by area of the body (docs/hide-masks.md):
//   scripts/mask_score.mjs build/release/bin/spherechain CHARACTER.glb...
// CHARACTER.masks.json lies beside CHARACTER.glb, as MakeHuman's: for each garment the triangles of the first mesh that it
// hides.
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';

const [tool, ...characters] = process.argv.slice(2);
if (!tool || characters.length === 0) {
  console.error('usage: mask_score.mjs SPHERECHAIN CHARACTER.glb...');
  process.exit(2);
}

// Areas of the triangles of the first mesh.
function areasOf(file) {
  const bytes = readFileSync(file), jsonSize = bytes.readUInt32LE(12);
  const gltf = JSON.parse(bytes.subarray(20, 20 + jsonSize)), binary = bytes.subarray(20 + jsonSize + 8);
  const read = (number, width, type) => {
    const { bufferView, byteOffset = 0, count } = gltf.accessors[number], from = (gltf.bufferViews[bufferView].byteOffset ?? 0) + byteOffset;
    const copy = new Uint8Array(binary.subarray(from, from + count * width * type.BYTES_PER_ELEMENT));
    return new type(copy.buffer);
  };
  const out = [];
  for (const { attributes, indices } of gltf.meshes[0].primitives) {
    const p = read(attributes.POSITION, 3, Float32Array);
    const corners = read(indices, 1, gltf.accessors[indices].componentType === 5123 ? Uint16Array : Uint32Array);
    for (let i = 0; i < corners.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => p.subarray(3 * corners[i + k], 3 * corners[i + k] + 3));
      const [u, v] = [b, c].map((q) => [q[0] - a[0], q[1] - a[1], q[2] - a[2]]);
      out.push(Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2);
    }
  }
  return { areas: out, mesh: gltf.meshes[0].name };
}

const all = { both: 0, found: 0, made: 0 };
const say = (name, { both, found, made }) => console.log(`${name.padEnd(24)} precision ${(both / found).toFixed(3)}, recall ${(both / made).toFixed(3)}`);
for (const character of characters) {
  const folder = mkdtempSync(join(tmpdir(), 'mask-score-')), out = join(folder, 'mask.json');
  const run = spawnSync(tool, ['mask', character, '--as', 'json', '-o', out], { stdio: ['ignore', 'ignore', 'inherit'] });
  if (run.status !== 0) process.exit(run.status ?? 1);
  const { meshes } = JSON.parse(readFileSync(out));
  rmSync(folder, { recursive: true });
  const { areas, mesh } = areasOf(character);
  const made = new Set(Object.values(JSON.parse(readFileSync(character.replace(/\.glb$/, '.masks.json')))).flat());
  const found = new Set(meshes.find((m) => m.mesh === mesh)?.hidden);
  const sum = (of) => [...of].reduce((area, t) => area + areas[t], 0);
  const figures = { both: sum([...found].filter((t) => made.has(t))), found: sum(found), made: sum(made) };
  say(basename(character), figures);
  for (const key of Object.keys(all)) all[key] += figures[key];
}
say('all', all);
