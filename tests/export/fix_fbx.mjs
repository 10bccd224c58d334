// fix_fbx.mjs TOOL POSED_COLLIDERS TURNED_FBX ENCODINGS [SOURCE.fbx...]: what three.js makes of FBX files whose clips were
// turned. It must pose each joint as the GLB has it that was written with the same turns, at every key.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import * as THREE from 'three';
import { FBXLoader } from 'three/examples/jsm/loaders/FBXLoader.js';
import { loadGlb } from './glb.mjs';

const kDegrees = 0.05, kSame = 5e-5;  // seconds

// Pictures are not decoded in Node.
globalThis.document ??= { createElementNS: () => ({ addEventListener() {}, removeEventListener() {} }) };
globalThis.window ??= globalThis;

function loadFbx(file) {
  let bytes = fs.readFileSync(file);
  const warn = console.warn;
  // three.js knows a text by some letters of the comment that it begins with, and reads properties without spaces alone.
  if (!bytes.toString('latin1', 0, 7).startsWith('Kaydara')) {
    const text = bytes.toString().replace(/^\s*P: .*$/gm, (line) => line.replace(/, (?=[-\d])/g, ','));
    bytes = Buffer.from(`; FBX 7.4.0 project file\n; ${'-'.repeat(200)}\n${text}`);
  }
  console.warn = () => {};  // of what it leaves out
  try {
    return new FBXLoader().parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
  } finally {
    console.warn = warn;
  }
}

// Half a turn or none: what is left of a node's scale where it mirrors.
function halfTurn({ scale }) {
  const signs = scale.toArray().map((s) => (s < 0 ? -1 : 1)), mirror = signs[0] * signs[1] * signs[2];
  return new THREE.Quaternion().setFromRotationMatrix(new THREE.Matrix4().makeScale(...signs.map((sign) => sign * mirror)));
}

// The turns of a clip's nodes by name, at a time from its first key on.
function turnsOf(clip, scene) {
  const tracks = clip.tracks.filter((track) => track.name.endsWith('.quaternion'));
  const start = Math.min(...clip.tracks.map((track) => track.times[0]));
  return new Map(tracks.map((track) => {
    const node = track.name.slice(0, -'.quaternion'.length), half = halfTurn(scene.getObjectByName(node));
    return [node, {
      times: [...track.times].map((time) => time - start),
      at: (time) => new THREE.Quaternion().fromArray(track.createInterpolant().evaluate(time + start)).normalize().multiply(half),
    }];
  }));
}

export async function compare(fbxFile, glbFile, joints) {
  const fbx = loadFbx(fbxFile), glb = await loadGlb(glbFile);
  let worst = 0, compared = 0;
  const name = (joint) => THREE.PropertyBinding.sanitizeNodeName(joint);
  if (fbx.animations.length !== glb.animations.length) throw new Error(`${fbx.animations.length} clips, not ${glb.animations.length}`);
  glb.animations.forEach((clip, number) => {
    const own = fbx.animations.find((one) => one.name === clip.name) ?? fbx.animations[number];
    const ours = turnsOf(clip, glb.scene), theirs = turnsOf(own, fbx);
    for (const joint of joints.map(name)) {
      const wanted = ours.get(joint), got = theirs.get(joint);
      if (!wanted) continue;
      if (!got) throw new Error(`${clip.name}: ${joint} does not turn`);
      // Where angles jump, importers put keys of their own between frames.
      for (const time of wanted.times.filter((one) => got.times.some((key) => Math.abs(key - one) < kSame))) {
        const degrees = THREE.MathUtils.radToDeg(wanted.at(time).angleTo(got.at(time)));
        if (degrees > worst) worst = degrees;
        if (!(degrees <= kDegrees)) throw new Error(`${clip.name}: ${joint} is off by ${degrees} degrees at ${time} s`);
        ++compared;
      }
    }
  });
  return { worst, compared };
}

// The box man with all rotation orders, pre- and post-rotations, pivots; binary and text; with a key a frame and without.
function men(encodings, folder) {
  const python = ['python3', '/usr/bin/python3'].find((one) => spawnSync(one, ['-c', 'import numpy']).status === 0);
  if (!python) {
    console.log('the box man is left out: numpy is missing (Debian: python3-numpy)');
    return [];
  }
  const seeds = [2, 4, 6, 7, 13, 15, 16, 17, 18, 19, 20, 22, 25, 32, 35, 36];
  execFileSync(python, [`${encodings}/write_fbx.py`, folder, ...seeds.map(String)]);
  return seeds.map((seed) => `${folder}/man_${seed}.fbx`);
}

const [, , turned, encodings, ...given] = process.argv.slice(2);
const folder = path.resolve('fix_fbx');
fs.mkdirSync(folder, { recursive: true });
const models = '/usr/share/assimp/models/FBX';
const sources = given.length > 0 ? given : [`${models}/huesitos.fbx`, `${models}/animation_with_skeleton.fbx`, ...men(encodings, folder)];
let failed = 0;
for (const source of sources) {
  const fbx = `${folder}/turned.fbx`, glb = `${folder}/turned.glb`;
  try {
    const joints = execFileSync(turned, [source, fbx, glb], { encoding: 'utf8' }).trim().split('\n');
    const { worst, compared } = await compare(fbx, glb, joints);
    if (compared === 0) throw new Error('no joint turns');
    console.log(`${path.basename(source)}: ${joints.length} joints, ${compared} turns within ${worst.toFixed(4)} degrees`);
  } catch (error) {
    console.log(`${path.basename(source)}: ${error.message}`);
    ++failed;
  }
}
process.exit(failed > 0 ? 1 : 0);
