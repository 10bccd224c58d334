// SPDX-License-Identifier: MIT
// api.mjs PACKAGE ASSET PALETTES NATIVE PAIR: the package through its public functions, beside the C interface: NATIVE and PAIR are what
// reference.cpp prints, without and with --pair. And what it refuses.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { pathToFileURL } from 'node:url';
import { readPalettes } from '../../samples/javascript/palettes.mjs';
import { frameHashes, pairHashes } from './frame_hashes.mjs';

const [packageFolder, assetFile, palettesFile, nativeFile, pairFile] = process.argv.slice(2);
const { load, SpherechainError } = await import(pathToFileURL(`${packageFolder}/index.js`));
const spherechain = await load();
const bytes = new Uint8Array(readFileSync(assetFile));
const { joints, rest, frames } = readPalettes(new Uint8Array(readFileSync(palettesFile)).buffer);

const posed = frames[30];  // with the arms crossed

const refuses = (call, message) =>
  assert.throws(call, error => error instanceof SpherechainError && message.test(error.message), `not refused as ${message}`);

test('the module is loaded once and knows its version', async () => {
  assert.equal(await load(), spherechain);
  assert.equal(spherechain.version, JSON.parse(readFileSync(`${packageFolder}/package.json`)).version);
});

test('an asset says what it is', () => {
  const asset = spherechain.open(bytes);
  assert.ok(asset.vertexCount > 14000);
  assert.equal(asset.triangleCount, 28796);
  assert.equal(asset.triangles.length, 3 * asset.triangleCount);
  assert.ok(asset.metresPerUnit > 0 && asset.height > 0 && asset.spheres.length > 40);
  assert.ok(asset.up[1] > 0.99);
  const hand = asset.parts.find(part => part.name === 'right hand');
  assert.equal(hand.side, 'right');
  assert.equal(asset.parts[hand.parent].name, 'right forearm');
  // The inverse bind matrix takes a joint's own place to the origin: by columns, the last row 0 0 0 1.
  const { inverseBind } = asset.bones.find(bone => bone.name === 'right_wrist');
  assert.deepEqual([3, 7, 11, 15].map(i => inverseBind[i]), [0, 0, 0, 1]);
  const own = joints.find(joint => joint.name === 'right_wrist').inverseBind;
  assert.ok(own.every((value, i) => Math.abs(value - inverseBind[i]) < 1e-5));
  assert.ok(asset.spheres.every(sphere => sphere.detectRadius > 0 && asset.regions[sphere.region]));
  asset.dispose();
});

test('each frame of a clip gives the bits that the C interface gives', () => {
  const asset = spherechain.open(bytes);
  const wanted = readFileSync(nativeFile, 'utf8').trim().split('\n');
  assert.equal(wanted.length, frames.length);
  frames.forEach((palette, frame) => {
    if (frame % 4 !== 2) return;  // the arms are crossed from 27 on
    const character = asset.createCharacter(joints);
    character.setPalette(palette);
    assert.equal(frameHashes(character), wanted[frame], `frame ${frame}`);
    character.dispose();
  });
  asset.dispose();
});

test('two characters give the bits that the C interface gives', () => {
  const asset = spherechain.open(bytes);
  const a = asset.createCharacter(joints), b = spherechain.open(bytes).createCharacter(joints);
  refuses(() => a.contactsWith(b), /setPalette/);
  const wanted = readFileSync(pairFile, 'utf8').trim().split('\n');
  wanted.forEach((line, i) => {
    a.setPalette(frames[10 * i]);
    b.setPalette(frames[10 * i].map((value, k) => (k % 16 === 12 || k % 16 === 14 ? value + Math.fround(0.3) : value)));
    assert.equal(pairHashes(a, b), line, `frame ${10 * i}`);
  });
  a.setPalette(posed);
  const alone = frameHashes(a), [found] = a.penetrationsWith(b, false);
  assert.equal(frameHashes(a), alone);
  assert.equal(a.penetrationsWith(b, false)[0], found);
  for (const other of [a, null, asset]) refuses(() => a.contactsWith(other), /another character/);
  refuses(() => a.penetrationsWith(b, 'full'), /true or false/);
  b.asset.dispose();
  refuses(() => a.contactsWith(b), /disposed/);
  asset.dispose();
});

test('palettes come by columns or rows, in the order of the joints', () => {
  const asset = spherechain.open(bytes);
  const spheresOf = (character, palette) => {
    character.setPalette(palette);
    return character.refit().slice();
  };
  const byColumns = posed;
  const wanted = spheresOf(asset.createCharacter(joints), byColumns);
  const byRows = new Float32Array(12 * joints.length).map((_, i) =>
    byColumns[16 * Math.floor(i / 12) + 4 * (i % 4) + Math.floor((i % 12) / 4)]);
  assert.deepEqual(spheresOf(asset.createCharacter(joints), byRows), wanted);
  const turned = [...joints].reverse();
  const reversed = new Float32Array(byColumns.length).map((_, i) => byColumns[16 * (joints.length - 1 - Math.floor(i / 16)) + (i % 16)]);
  assert.deepEqual(spheresOf(asset.createCharacter(turned), reversed), wanted);
  assert.notDeepEqual(spheresOf(asset.createCharacter(joints), reversed), wanted);
  asset.dispose();
});

test('a palette’s scale changes depths, and no class', () => {
  const asset = spherechain.open(bytes), character = asset.createCharacter(joints);
  const answers = palette => {
    character.setPalette(palette);
    return character.penetrations(false).map(({ part, other, kind, depth }) => ({ part, other, kind, depth }));
  };
  const own = answers(posed), small = answers(posed.map((value, i) => (i % 4 === 3 ? value : value / 100)));
  assert.ok(own.some(({ kind }) => kind === 'penetration'));
  assert.deepEqual(small.map(({ part, other, kind }) => [part, other, kind]), own.map(({ part, other, kind }) => [part, other, kind]));
  small.forEach(({ depth }, i) => assert.ok(Math.abs(100 * depth / own[i].depth - 1) < 0.3));
  asset.dispose();
});

test('vertices lie in the spheres’ space, and triangles name them', () => {
  const asset = spherechain.open(bytes);
  const character = asset.createCharacter(joints);
  character.setPalette(posed);
  const found = character.penetrations()[0].deepest, vertices = character.vertices();
  assert.ok(asset.triangles.every(vertex => 3 * vertex + 2 < vertices.length));
  for (const axis of [0, 1, 2]) {
    const corners = [0, 1, 2].map(k => vertices[3 * asset.triangles[3 * found.triangle + k] + axis]);
    const place = corners.reduce((sum, value, k) => sum + value * found.weights[k], 0);
    assert.ok(Math.abs(place - found.position[axis]) < 1e-5);
  }
  asset.dispose();
});

test('views are the same object while nothing grows, and lists are used again', () => {
  const asset = spherechain.open(bytes);
  const character = asset.createCharacter(joints);
  character.setPalette(posed);
  const penetrations = character.penetrations(), [one] = penetrations, first = character.refit();
  character.setPalette(frames[frames.indexOf(posed) + 1]);
  assert.equal(character.refit(), first);
  assert.equal(character.penetrations(), penetrations);
  assert.equal(penetrations[0], one);
  const opened = Array.from({ length: 20 }, () => spherechain.open(bytes));  // the memory grows
  assert.equal(first.length, 0);
  assert.equal(character.refit().length, 4 * asset.spheres.length);
  for (const other of opened) other.dispose();
  asset.dispose();
});

test('broken bytes are refused', () => {
  refuses(() => spherechain.open(new Uint8Array(0)), /./);
  refuses(() => spherechain.open(new TextEncoder().encode('{"not": "an asset", "but": "long enough to be one"}')), /asset/);
  refuses(() => spherechain.open(null), /\.sphc/);
  refuses(() => spherechain.open([...bytes]), /ArrayBuffer or a Uint8Array, not an Array of \d+$/);
  refuses(() => spherechain.open(new DataView(bytes.buffer)), /not a DataView/);
  refuses(() => spherechain.open(new SharedArrayBuffer(8)), /not a SharedArrayBuffer/);
  refuses(() => spherechain.open(Promise.resolve(bytes)), /not a Promise: await it/);
  refuses(() => spherechain.open(new Blob([bytes])), /not a Blob: await its arrayBuffer\(\)/);
  for (let part = 1; part < 32; ++part) refuses(() => spherechain.open(bytes.subarray(0, Math.floor((bytes.length * part) / 32))), /./);
  let refused = 0;
  for (let i = 0; i < 60; ++i) {
    const broken = bytes.slice();
    broken[(i * 7919 * 131) % broken.length] ^= 1 << i % 8;
    try {
      const asset = spherechain.open(broken);
      const character = asset.createCharacter();
      character.setPalette(new Float32Array(12 * asset.bones.length).map((_, k) => (k % 12 % 5 === 0 ? 1 : 0)));
      character.penetrations();
      asset.dispose();
    } catch (error) {
      assert.ok(error instanceof SpherechainError, `${error.stack}`);
      ++refused;
    }
  }
  assert.ok(refused > 0);
  spherechain.open(bytes).dispose();  // the module still works
});

test('wrong arguments are refused', () => {
  const asset = spherechain.open(bytes);
  const character = asset.createCharacter(joints);
  refuses(() => character.contacts(), /setPalette/);
  refuses(() => character.setPalette(new Float32Array(15)), new RegExp(`15 floats: ${16 * joints.length}`));
  refuses(() => character.setPalette(undefined), /no floats/);
  refuses(() => character.setPalette(rest, new Float32Array(3)), /3 morph weights: the asset has 0/);
  character.setPalette(rest);
  refuses(() => character.refit('large'), /"large": one of detect, fit/);
  refuses(() => character.contacts('everything'), /one of apart, neighbours, all/);
  refuses(() => asset.createCharacter(joints.slice(1)), new RegExp(`bone "${joints[0].name}"`));
  refuses(() => asset.createCharacter(joints.map(joint => ({ ...joint, inverseBind: joint.inverseBind.map(x => 2 * x) }))), /inverse bind/);
  character.setPalette(posed);
  refuses(() => character.checkRest(), /bind pose/);
  refuses(() => character.penetrations('full'), /true or false is wanted, not "full"/);
  for (const value of [NaN, Infinity, -Infinity]) {
    const palette = rest.slice();
    palette[16 * 3 + 5] = value;
    refuses(() => character.setPalette(palette), new RegExp(`bone "${joints[3].name}" \\(joint 3\\) is not finite`));
    refuses(() => character.contacts(), /setPalette/);
  }
  character.setPalette(rest.map(value => 1e38 * value));
  character.detect();
  character.penetrations();
  character.vertices();
  asset.dispose();
  refuses(() => character.refit(), /disposed/);
  refuses(() => asset.createCharacter(), /disposed/);
  asset.dispose();
  character.dispose();
});

test('a skeleton that does not fit is refused, and the joint named', () => {
  const asset = spherechain.open(bytes);
  const { name } = joints[2], changed = change => joints.map((joint, i) => (i === 2 ? { ...joint, ...change } : joint));
  const joint = `joint "${name}" \\(joints\\[2\\]\\): inverseBind`;
  for (const [wrong, message] of [
    [null, /array of \{ name, inverseBind \} is wanted, not null/],
    [{ bones: joints }, /not an Object/],
    [[], /the list is empty/],
    [[null], /joints\[0\]: its name is undefined/],
    [changed({ name: 7 }), /joints\[2\]: its name is 7/],
    [changed({ inverseBind: { elements: joints[2].inverseBind } }), new RegExp(`${joint} is an Object: 16 numbers.*pass its elements`)],
    [changed({ inverseBind: [1, 2] }), new RegExp(`${joint} is an Array of 2: 16 numbers`)],
    [changed({ inverseBind: new Float32Array(16).fill(NaN) }), new RegExp(`${joint} is a Float32Array of 16`)],
    [changed({ inverseBind: '0'.repeat(16) }), new RegExp(`${joint} is "0+"`)],
    [changed({ inverseBind: new Float32Array(12) }), new RegExp(`${joint} has 12 numbers, that of joint "${joints[0].name}" 16`)],
    [changed({ inverseBind: undefined }), new RegExp(`${joint} is missing, but joint "${joints[0].name}" has one`)],
    [joints.map(one => ({ ...one, name: one.name.replace('_', '') })), /bone "left_\w+".*but "left\w+" is/],
  ]) {
    refuses(() => asset.createCharacter(wrong), message);
  }
  assert.equal(asset.createCharacter(joints.map(one => ({ name: one.name }))).jointCount, joints.length);
  asset.dispose();
});

test('memory is given back', () => {
  const round = () => {
    const asset = spherechain.open(bytes);
    const character = asset.createCharacter(joints);
    character.setPalette(posed);
    character.penetrations();
    const { buffer } = character.refit();
    asset.dispose();
    return buffer.byteLength;
  };
  const first = round();
  for (let i = 0; i < 20; ++i) round();
  assert.equal(round(), first);
});
