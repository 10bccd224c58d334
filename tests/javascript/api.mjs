// SPDX-License-Identifier: MIT
// api.mjs PACKAGE ASSET PALETTES NATIVE: the package through its public functions, beside the C interface: NATIVE is what
// reference.cpp prints. And what it refuses.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { pathToFileURL } from 'node:url';
import { readPalettes } from '../../samples/javascript/palettes.mjs';
import { frameHashes } from './frame_hashes.mjs';

const [packageFolder, assetFile, palettesFile, nativeFile] = process.argv.slice(2);
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

test('vertices lie in the spheres’ space, and triangles name them', () => {
  const asset = spherechain.open(bytes);
  const character = asset.createCharacter(joints);
  character.setPalette(posed);
  const found = character.penetrations()[0].deepestA, vertices = character.vertices();
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
  refuses(() => spherechain.open([...bytes]), /\.sphc/);
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
  refuses(() => asset.createCharacter(joints.map(joint => ({ ...joint, inverseBind: [1, 2] }))), /16 floats by columns/);
  refuses(() => asset.createCharacter([]), /joints/);
  character.setPalette(posed);
  refuses(() => character.checkRest(), /bind pose/);
  for (const value of [NaN, Infinity]) {
    character.setPalette(new Float32Array(16 * joints.length).fill(value));
    character.detect();
    character.penetrations();
    character.vertices();
  }
  asset.dispose();
  refuses(() => character.refit(), /disposed/);
  refuses(() => asset.createCharacter(), /disposed/);
  asset.dispose();
  character.dispose();
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
