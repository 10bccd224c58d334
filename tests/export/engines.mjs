// SPDX-License-Identifier: GPL-3.0-or-later
// engines.mjs TOOL POSED_COLLIDERS ENGINE_COLLIDERS SAMPLES: rebuilds bodies from what was written for each engine and
// checks them with Jolt, of made-up bodies and of Debian's character, which the tool itself exports, too.
// Then POSES SHAPE FILE [MOTION...]: of any character; without MOTION in its own clips.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { compareOverlaps } from './engine_overlaps.mjs';
import * as godot from './godot.mjs';
import * as unity from './unity.mjs';
import * as unreal from './unreal.mjs';
import * as usd from './usd.mjs';

const engines = { usd, godot, unity, unreal };
const [tool, , program, samples, ...given] = process.argv.slice(2);
if (spawnSync('mcs', ['--version']).error) {
  console.log('SKIPPED: export.engines needs mono-mcs, and it is not installed');
  process.exit(77);
}
const folder = mkdtempSync(join(tmpdir(), 'spherechain_engines_'));
const run = (...command) => execFileSync(command[0], command.slice(1), { encoding: 'utf8' });
const read = (name) => readFileSync(join(folder, name), 'utf8');

function check(name, poses, shape, ...more) {
  run(program, folder, poses, shape, ...more);
  const [ours, file] = ['ours.json', 'capsules.json'].map((one) => JSON.parse(read(one)));
  for (const [engine, { shapes, ending, rebuild }] of Object.entries(engines)) {
    if (!shapes.includes(shape)) continue;
    const { bodies, ignored } = rebuild(join(folder, `${engine}.${ending}`), file);
    console.log(compareOverlaps(`${name} ${shape}: ${engine}`, bodies, ignored, ours, file));
  }
}

function checkCharacter(poses, shape, source, ...motions) {
  const asset = join(folder, 'character.sphc');
  run(tool, 'bake', source, '-o', asset);
  check(basename(source), poses, shape, asset, source, ...motions);
  return asset;
}

try {
  if (given.length > 0) {
    checkCharacter(...given);
  } else {
    for (const shape of ['cones', 'capsules', 'boxes', 'ellipsoids']) check('made-up', '50', shape);
    const poses = ['deep_squat', 'arms_crossed'].map((name) => join(samples, `${name}.json`));
    const asset = checkCharacter('6', 'spheres', '/usr/share/assimp/models/Collada/human.zae', ...poses);
    // The tool writes the same, and the script beside.
    for (const [engine, { ending }] of Object.entries(engines)) {
      run(tool, 'export', asset, '--to', engine, '--volumes', 'spheres', '-o', join(folder, `tool.${ending}`));
      if (read(`tool.${ending}`) !== read(`${engine}.${ending}`)) throw new Error(`the tool exports ${engine} otherwise`);
    }
  }
} finally {
  rmSync(folder, { recursive: true });
}
