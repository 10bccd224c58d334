// gltf.mjs TOOL POSED_COLLIDERS [SOURCE...]: what readers of glTF physics and of VRM make of exports: of two persons that
// this folder makes, briefly; or of characters of your own, in all shapes.
import fs from 'node:fs';
import path from 'node:path';
import { person } from './person.mjs';
import { checkSchemas, judgePhysics } from './judge_physics.mjs';
import { judgeVrm } from './judge_vrm.mjs';
import { posedColliders, run } from './poses.mjs';
import { readGlb } from './glb.mjs';

const [tool, program, ...sources] = process.argv.slice(2);
const folder = path.resolve('gltf'), asset = `${folder}/asset.sphc`;
fs.mkdirSync(folder, { recursive: true });

const write = (format, shape, count) => (source, out) => run(tool, ['export', asset, '--source', source, '--to', format, '--volumes', shape,
  ...(count > 0 ? ['--at-most', String(count)] : []), '-o', out, '--force']);

async function physics(source, format, shape, count = 0) {
  const file = `${folder}/${format}.glb`, ours = posedColliders(program, asset, source, shape, count, 200);
  write(format, shape, count)(source, file);
  const hasSchemas = checkSchemas(file, format);
  const { result, overlaps } = await judgePhysics(file, format, ours);
  if (overlaps === 0) throw new Error(`nothing overlaps: ${result}`);
  console.log(`${path.basename(source)} ${format} ${shape}: ${result}${hasSchemas ? '' : ' (SKIPPED: schemas, which SPHERECHAIN_TEST_DATA has)'}`);
}

async function vrm(source, version, shape, count = 0) {
  const ours = posedColliders(program, asset, source, shape, count, 5);
  console.log(`${path.basename(source)} vrm ${version} ${shape}: ${await judgeVrm(source, folder, ours, write('vrm', shape, count), version === 0)}`);
}

if (sources.length > 0) {
  for (const source of sources) {
    run(tool, ['bake', source, '-o', asset]);
    for (const format of ['khr', 'omi']) for (const shape of ['cones', 'boxes', 'spheres']) await physics(source, format, shape);
    const { extensions = {} } = readGlb(source).json;
    if (!extensions.VRM) for (const shape of ['capsules', 'spheres']) await vrm(source, 1, shape);
    if (!extensions.VRMC_vrm) await vrm(source, 0, 'spheres');
  }
} else {
  const awkward = `${folder}/awkward.glb`, plain = `${folder}/plain.glb`;
  fs.writeFileSync(awkward, person(true));
  fs.writeFileSync(plain, person(false));
  run(tool, ['bake', awkward, '-o', asset]);
  await physics(awkward, 'khr', 'cones', 17);
  await physics(awkward, 'omi', 'spheres');
  run(tool, ['bake', plain, '-o', asset]);
  await vrm(plain, 1, 'capsules', 10);
  await vrm(plain, 0, 'spheres');
}
