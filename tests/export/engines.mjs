// SPDX-License-Identifier: GPL-3.0-or-later
// engines.mjs TOOL POSED_COLLIDERS POSES FILE [MOTION...]: exports a character for each engine, rebuilds the bodies from
// what was written and lets Jolt judge them, in POSES poses of each motion; without one in those of the file's clips.
// Where FILE has no rig the bake makes one.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { judge } from './engine_judge.mjs';
import * as godot from './godot.mjs';
import * as unity from './unity.mjs';
import * as unreal from './unreal.mjs';
import * as usd from './usd.mjs';

const [tool, posedColliders, poses, given, ...motions] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'spherechain_engines_'));
const run = (program, ...args) => execFileSync(program, args, { encoding: 'utf8', maxBuffer: 1 << 30 });
try {
  const asset = join(folder, 'character.sphc');
  let source = given;
  if (!given.endsWith('.glb')) {
    source = join(folder, 'rigged.glb');
    run(tool, 'bake', given, '-o', asset, '--preview', source);
  }
  run(tool, 'bake', source, '-o', asset, '--force');
  const shapes = process.env.SHAPES?.split(',') ?? ['cones', 'capsules'];
  for (const shape of shapes) {
    const posed = (...motion) => JSON.parse(run(posedColliders, asset, source, shape, '0', poses, ...motion));
    const [ours, ...others] = motions.length > 0 ? motions.map((motion) => posed(motion)) : [posed()];
    ours.poses.push(...others.flatMap((other) => other.poses));
    run(tool, 'export', asset, '--to', 'capsules.json', '--volumes', shape, '-o', join(folder, 'capsules.json'), '--force');
    const file = JSON.parse(readFileSync(join(folder, 'capsules.json'), 'utf8'));
    for (const [name, engine] of Object.entries({ usd, godot, unity, unreal })) {
      if (!engine.shapes.includes(shape)) continue;
      const path = join(folder, `${name}.${engine.ending}`);
      run(tool, 'export', asset, '--to', name, '--volumes', shape, '-o', path, '--force');
      const { bodies, ignored } = engine.rebuild(path, file);
      console.log(`${basename(given)} ${shape}: ${judge(name, bodies, ignored, ours, file)}`);
    }
  }
} finally {
  rmSync(folder, { recursive: true });
}
