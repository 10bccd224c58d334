// SPDX-License-Identifier: MIT
// api.mjs PACKAGE ASSET PALETTES NATIVE PAIR: the package through its public functions, beside the C interface: NATIVE and PAIR are what
// reference.cpp prints, without and with --pair. And what it refuses.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import test from 'node:test';
import { pathToFileURL } from 'node:url';
import { readPalettes } from '../../samples/javascript/palettes.mjs';
import { ignoredPairsOf, frameHashes, pairHashes } from './frame_hashes.mjs';

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

test('a model says what it is', () => {
  const model = spherechain.createModel(bytes, joints);
  assert.ok(model.vertexCount > 14000);
  assert.equal(model.triangleCount, 28796);
  assert.equal(model.triangles.length, 3 * model.triangleCount);
  assert.equal(model.triangles, model.triangles);
  assert.ok(model.metresPerUnit > 0 && model.height > 0 && model.sphereCount > 40);
  assert.equal(model.millimetres(2), 2000 * model.metresPerUnit);
  assert.ok(model.up[1] > 0.99);
  assert.match(model.writer, /^spherechain \d/);
  assert.match(model.sourceSha256, /^[0-9a-f]{64}$/);
  const hand = model.parts.find(part => part.name === 'right hand');
  assert.equal(hand.side, 'right');
  assert.equal(model.parts[hand.parent].name, 'right forearm');
  assert.ok(hand.mobility > model.parts[hand.parent].mobility);
  assert.equal(joints[hand.joint].name, model.bones[hand.bone].name);
  const head = model.parts.findIndex(part => part.name === 'head');
  const triangle = Array.from({ length: model.triangleCount }, (_, i) => model.triangle(i)).find(found => found?.part === head);
  assert.equal(model.spheres[triangle.sphere].region, triangle.region);
  assert.equal(model.triangle(model.triangleCount), null);
  // The inverse bind matrix takes a joint's own place to the origin: by columns, the last row 0 0 0 1.
  const { inverseBind } = model.bones.find(bone => bone.name === 'right_wrist');
  assert.deepEqual([3, 7, 11, 15].map(i => inverseBind[i]), [0, 0, 0, 1]);
  const own = joints.find(joint => joint.name === 'right_wrist').inverseBind;
  assert.ok(own.every((value, i) => Math.abs(value - inverseBind[i]) < 1e-5));
  assert.ok(model.spheres.every(sphere => sphere.detectRadius > 0 && model.regions[sphere.region]));
  model.dispose();
});

test('each frame of a clip gives the bits that the C interface gives', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody({ findsSteps: true }), ignoredPairs = ignoredPairsOf(model);
  const wanted = readFileSync(nativeFile, 'utf8').trim().split('\n');
  assert.equal(wanted.length, frames.length);
  for (let frame = 2; frame < frames.length; frame += 4) {  // the arms are crossed from 27 on
    assert.equal(frameHashes(body, ignoredPairs, frames, frame), wanted[frame], `frame ${frame}`);
  }
  model.dispose();
});

test('two bodies give the bits that the C interface gives', () => {
  const model = spherechain.createModel(bytes, joints), otherModel = spherechain.createModel(bytes, joints);
  const a = model.createBody({ findsSteps: true, largestOther: otherModel }), b = otherModel.createBody({ findsSteps: true });
  refuses(() => a.contacts(b), /setPose/);
  const wanted = readFileSync(pairFile, 'utf8').trim().split('\n');
  wanted.forEach((line, i) => assert.equal(pairHashes(a, b, frames, 10 * i), line, `frame ${10 * i}`));
  a.setPose(posed);
  b.setPose(posed, { place: { translation: [0.1, 0, 0] } });
  const alone = structuredClone(a.penetrations()), found = a.penetrations(b), [first] = found;
  assert.ok(found.length > 0 && first.measures.relation === 'two_bodies' && first.measures.restDistance === Infinity);
  assert.deepEqual(structuredClone(a.penetrations()), alone);
  assert.equal(a.penetrations(b), found);
  assert.equal(found[0], first);
  refuses(() => a.contacts(a), /another body/);
  for (const other of [model, null, 'b']) {
    refuses(() => a.contacts(other, {}), /another body/);
    refuses(() => a.contacts(other), /query: /);
  }
  otherModel.dispose();
  refuses(() => a.contacts(b), /disposed/);
  model.dispose();
});

test('a query says what is listed', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody();
  body.setPose(posed);
  const all = structuredClone(body.penetrations({ classes: spherechain.classes })), faults = structuredClone(body.penetrations());
  assert.equal(all.total, all.length);
  assert.ok(faults.length > 1 && all.length > faults.length);
  assert.deepEqual([...faults], all.slice(0, faults.length).filter(({ kind }) => ['deep_fold', 'penetration', 'inside'].includes(kind)));
  const limited = structuredClone(body.penetrations({ limit: 1 }));
  assert.deepEqual([limited.length, limited.total, limited[0]], [1, faults.length, faults[0]]);
  assert.equal(model.createBody({ maxPenetrations: 1 }).model, model);
  // The classes of full measurements follow from them, by any rule.
  const full = body.penetrations({ full: true, classes: spherechain.classes });
  for (const { kind, measures } of full) assert.equal(spherechain.classify(measures), kind);
  const { depth } = full[0].measures, { version, touchDepth, foldDepth, inside } = spherechain.defaultRule;
  assert.deepEqual([version, touchDepth], [4, 0]);
  assert.ok(foldDepth > 0 && inside > 0.5 && inside <= 1);
  assert.equal(spherechain.classify({ ...full[0].measures, swallowed: 1 }), 'inside');
  assert.equal(spherechain.classify(full[0].measures, { touchDepth: 2 * depth, hidden: 0, shell: 0, fold: 0, neighbours: 0 }), 'touch');
  assert.equal(body.penetrations({ rule: { ...spherechain.defaultRule, touchDepth: 2 * depth } }).length, 0);
  const pair = [faults[0].part, faults[0].other];
  assert.deepEqual(structuredClone([...body.penetrations({ partPairs: [pair] })]), [faults[0]]);
  assert.equal(body.contacts({ partPairs: [pair] }).parts.length, 1);
  refuses(() => body.contacts({ partPairs: [[0, 99]] }), /partPairs: \[0, 99\]/);
  refuses(() => body.contacts({ partPairs: [3, 7] }), /partPairs: two numbers/);
  // Everything is ignored.
  const ignoredPairs = model.createIgnoredPairs();
  for (let a = 0; a < model.partCount; ++a) for (let b = 0; b <= a; ++b) ignoredPairs.ignoreParts(a, b);
  assert.equal(body.contacts({ ignoredPairs }).parts.length, 0);
  assert.equal(body.spherePairs({ ignoredPairs }).total, 0);
  const { triangles, triangleTotal } = body.contacts({ full: true });
  assert.equal(triangles.length, 12 * triangleTotal);
  const small = model.createBody({ maxTriangles: 2 });
  small.setPose(posed);
  assert.deepEqual([small.contacts({ full: true }).triangles.length, small.contacts({ full: true }).triangleTotal], [24, triangleTotal]);
  assert.deepEqual(structuredClone(small.contacts().parts), structuredClone(body.contacts().parts));
  // A direction of the frame before stays where the way is nearly as short.
  const own = structuredClone(body.penetrations()), turned = new Set();
  for (const direction of [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]) {
    const found = body.penetrations({ previous: own.map(one => ({ ...one, direction: Float32Array.from(direction) })) });
    assert.equal(found.length, own.length);
    for (const one of found) {
      const { direction: before } = own.find(({ part, other }) => part === one.part && other === one.other);
      const cosines = [before, direction].map(other => one.direction.reduce((sum, x, k) => sum + x * other[k], 0));
      if (cosines[0] < 0.99) turned.add(one.part);
      assert.ok(cosines[0] > 0.99 || (cosines[1] > 0.86 && one.distance <= 1.5 * one.measures.depth));
    }
  }
  assert.ok(turned.size > 0);
  for (const [query, message] of [
    [{ scope: 'everything' }, /scope "everything": one of apart, neighbours, all/],
    [{ detail: 'slow' }, /query: "detail" is none of scope, full/],
    [{ classes: ['fault'] }, /classes "fault": one of rest, shell/],
    [{ classes: 'touch' }, /classes: a list is wanted/],
    [{ radius: 'large' }, /radius "large": one of detect, fit/],
    [{ limit: '3' }, /limit: a whole number is wanted, not "3"/],
    [{ limt: 3 }, /query: "limt" is none of scope, /],
    [{ rule: { touchdepth: 1 } }, /rule: "touchdepth" is none of version, touchDepth/],
    [{ rule: { version: 1 } }, /rule/],
    [{ rule: { shell: NaN } }, /rule/],
    [{ previous: 3 }, /previous: a list is wanted, not 3/],
    [{ previous: [{}] }, /./],
    [{ ignoredPairs: {} }, /ignoredPairs: what createIgnoredPairs\(\) made is wanted, not an Object/],
    [{ ignoredPairs: model }, /ignoredPairs: what createIgnoredPairs\(\) made is wanted, not a Model/],
    [{ ignoredParts: [1] }, /ignored/],
    [{ ignoredParts: [-1] }, /ignoredParts: -1 is no body part/],
    [7, /query: an object is wanted, not 7/],
  ]) refuses(() => body.penetrations(query), message);
  refuses(() => ignoredPairs.ignorePair(0, model.sphereCount), /two different spheres/);
  ignoredPairs.dispose();
  refuses(() => ignoredPairs.ignorePair(0, 1), /disposed/);
  refuses(() => body.contacts({ ignoredPairs }), /ignoredPairs/);
  model.dispose();
});

test('steps, the ground and bounds', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody({ findsSteps: true });
  body.setPose(rest);
  refuses(() => body.steps(), /two poses/);
  assert.deepEqual([...body.steps.call(moved(body, posed))].map(({ atStart }) => atStart).includes(false), true);
  const { low, high } = body.bounds(), top = high[1];
  assert.ok(low.every((value, i) => value < high[i]));
  assert.equal(body.below({ up: [0, 1, 0], height: low[1] - 1 }).total, 0);
  const under = body.below({ up: [0, 1, 0], height: top + 1 }), [first] = under;
  assert.equal(under.length, model.partCount);
  assert.deepEqual([first.other, first.deepestOther.triangle, [...first.direction]], [-1, -1, [0, 1, 0]]);
  const feet = model.parts.flatMap(({ name }, i) => (/foot|shin|thigh/.test(name) ? [] : [i]));
  const some = body.below({ height: low[1] + 0.125 * model.height }, { ignoredParts: feet });
  assert.ok(some.length > 0 && some.every(({ part }) => !feet.includes(part)));
  refuses(() => body.below({ up: [0, 2, 0], height: 0 }), /./);
  refuses(() => body.below({ up: 1 }), /up: 3 numbers are wanted, not 1/);
  refuses(() => body.below(), /ground: an object is wanted/);
  const plain = model.createBody();
  moved(moved(plain, rest), posed);
  refuses(() => plain.steps(), /findsSteps/);
  refuses(() => model.createBody({ findSteps: true }), /"findSteps" is none of/);
  refuses(() => model.createBody({ largestOther: body }), /largestOther: what createModel\(\) made is wanted, not a Body/);
  model.dispose();

  function moved(one, palette) {
    one.setPose(palette);
    return one;
  }
});

test('a pose has a place, or vertices', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody(), other = model.createBody();
  const place = { translation: [1, 2, 3], rotation: [0, 1, 0, 0] };  // half a turn about y
  body.setPose(posed, { place });
  other.setPose(posed);
  const wanted = other.spherePairs().spheres.slice(), found = body.spherePairs().spheres;
  for (let i = 0; i < found.length; i += 4) {
    for (const [axis, sign] of [[0, -1], [1, 1], [2, -1]]) {
      assert.ok(Math.abs(found[i + axis] - (place.translation[axis] + sign * wanted[i + axis])) < 1e-4);
    }
  }
  refuses(() => body.setPose(posed, { place: { translation: [1, 2] } }), /translation: 3 numbers are wanted, not an Array of 2/);
  refuses(() => body.setPose(posed, { place: { position: [1, 2, 3] } }), /place: "position" is none of/);
  refuses(() => body.setPose(posed, { place: { rotation: [0, 0, 0, 0] } }), /transform/);
  refuses(() => body.contacts(), /setPose/);
  const vertices = new Float32Array(3 * model.vertexCount).fill(0.5);
  body.setPose(null, { vertices });
  vertices.fill(NaN);  // it was copied
  assert.ok(body.vertices().every(value => value === 0.5));
  assert.equal(body.contacts().parts.length, 0);
  assert.deepEqual([...body.bounds().low, ...body.bounds().high], Array(6).fill(0.5));
  refuses(() => body.setPose(null, { vertices }), /vertex 0 is not finite/);
  refuses(() => body.setPose(null, { vertices: vertices.subarray(3) }), new RegExp(`${vertices.length} floats are wanted`));
  refuses(() => body.setPose(null, {}), /no floats/);
  refuses(() => body.setPose(posed, { vertexes: vertices }), /"vertexes" is none of morphWeights, place, vertices/);
  refuses(() => body.setPose(posed, new Float32Array(3)), /"0" is none of/);
  model.dispose();
});

test('vertices answer as the bones that moved them do', () => {
  const model = spherechain.createModel(bytes, joints), bones = model.createBody({ findsSteps: true }), own = model.createBody({ findsSteps: true });
  own.setPose(null, { vertices: new Float32Array(3 * model.vertexCount).map((_, i) => Math.floor(i / 3)) });
  const numbers = own.vertices().filter((_, i) => i % 3 === 0), vertices = new Float32Array(3 * model.vertexCount);
  for (const palette of [frames[22], posed]) {
    bones.setPose(palette);
    const skin = bones.vertices();
    numbers.forEach((number, i) => vertices.set(skin.subarray(3 * i, 3 * i + 3), 3 * number));
    own.setPose(null, { vertices });
  }
  assert.deepEqual(own.vertices(), bones.vertices());
  const partsOf = list => list.map(({ partA, partB }) => `${partA} ${partB}`);
  assert.ok(bones.contacts().parts.length > 0 && bones.steps().length > 0);
  assert.deepEqual(partsOf(own.contacts().parts), partsOf(bones.contacts().parts));
  assert.deepEqual(partsOf(own.steps()), partsOf(bones.steps()));
  assert.deepEqual(own.steps().map(({ atStart }) => atStart), bones.steps().map(({ atStart }) => atStart));
  own.steps().forEach(({ begin }, i) => assert.ok(Math.abs(begin - bones.steps()[i].begin) < 0.1));
  model.dispose();
});

test('palettes come by columns or rows, in the order of the joints', () => {
  const spheresOf = (ordered, palette) => {
    const body = spherechain.createModel(bytes, ordered).createBody();
    body.setPose(palette);
    const spheres = body.spherePairs().spheres.slice();
    body.model.dispose();
    return spheres;
  };
  const byColumns = posed;
  const wanted = spheresOf(joints, byColumns);
  const byRows = new Float32Array(12 * joints.length).map((_, i) =>
    byColumns[16 * Math.floor(i / 12) + 4 * (i % 4) + Math.floor((i % 12) / 4)]);
  assert.deepEqual(spheresOf(joints, byRows), wanted);
  const turned = [...joints].reverse();
  const reversed = new Float32Array(byColumns.length).map((_, i) => byColumns[16 * (joints.length - 1 - Math.floor(i / 16)) + (i % 16)]);
  assert.deepEqual(spheresOf(turned, reversed), wanted);
  assert.notDeepEqual(spheresOf(joints, reversed), wanted);
});

test('a palette’s scale changes depths, and no class', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody();
  const answers = palette => {
    body.setPose(palette);
    return body.penetrations({ full: true, classes: spherechain.classes })
      .map(({ part, other, kind, measures }) => ({ part, other, kind, depth: measures.depth }));
  };
  const own = answers(posed), small = answers(posed.map((value, i) => (i % 4 === 3 ? value : value / 100)));
  assert.ok(own.some(({ kind }) => kind === 'penetration'));
  assert.deepEqual(small.map(({ part, other, kind }) => [part, other, kind]), own.map(({ part, other, kind }) => [part, other, kind]));
  small.forEach(({ depth }, i) => assert.ok(Math.abs(100 * depth / own[i].depth - 1) < 0.3));
  model.dispose();
});

test('vertices lie in the spheres’ space, and triangles name them', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody();
  refuses(() => body.vertices(), /setPose/);
  body.setPose(posed);
  const { deepest, part } = body.penetrations()[0], vertices = body.vertices();
  assert.equal(model.triangle(deepest.triangle).part, part);
  assert.ok(model.triangles.every(vertex => 3 * vertex + 2 < vertices.length));
  for (const axis of [0, 1, 2]) {
    const corners = [0, 1, 2].map(k => vertices[3 * model.triangles[3 * deepest.triangle + k] + axis]);
    const place = corners.reduce((sum, value, k) => sum + value * deepest.weights[k], 0);
    assert.ok(Math.abs(place - deepest.position[axis]) < 1e-5);
  }
  model.dispose();
});

test('views are the same object while nothing grows, and lists are used again', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody();
  body.setPose(posed);
  const penetrations = body.penetrations(), [one] = penetrations, { parts } = body.contacts(), first = body.spherePairs().spheres;
  body.setPose(frames[frames.indexOf(posed) + 1]);
  assert.equal(body.spherePairs().spheres, first);
  assert.equal(body.penetrations(), penetrations);
  assert.equal(penetrations[0], one);
  assert.equal(body.contacts().parts, parts);
  for (let i = 0; i < 20 && first.length > 0; ++i) model.createBody({ maxTriangles: 1 << 18 });  // until the memory grows
  assert.equal(first.length, 0);
  assert.equal(body.spherePairs().spheres.length, 4 * model.sphereCount);
  model.dispose();
});

test('broken bytes are refused', () => {
  refuses(() => spherechain.createModel(new Uint8Array(0)), /./);
  refuses(() => spherechain.createModel(new TextEncoder().encode('{"not": "an asset", "but": "long enough to be one"}')), /asset/);
  refuses(() => spherechain.createModel(null), /\.sphc/);
  refuses(() => spherechain.createModel([...bytes]), /ArrayBuffer or a Uint8Array, not an Array of \d+$/);
  refuses(() => spherechain.createModel(new DataView(bytes.buffer)), /not a DataView/);
  refuses(() => spherechain.createModel(new SharedArrayBuffer(8)), /not a SharedArrayBuffer/);
  refuses(() => spherechain.createModel(Promise.resolve(bytes)), /not a Promise: await it/);
  refuses(() => spherechain.createModel(new Blob([bytes])), /not a Blob: await its arrayBuffer\(\)/);
  for (let part = 1; part < 32; ++part) refuses(() => spherechain.createModel(bytes.subarray(0, Math.floor((bytes.length * part) / 32))), /./);
  let refused = 0;
  for (let i = 0; i < 60; ++i) {
    const broken = bytes.slice();
    broken[(i * 7919 * 131) % broken.length] ^= 1 << i % 8;
    try {
      const model = spherechain.createModel(broken), body = model.createBody();
      body.setPose(new Float32Array(12 * model.boneCount).map((_, k) => (k % 12 % 5 === 0 ? 1 : 0)));
      body.penetrations();
      model.dispose();
    } catch (error) {
      assert.ok(error instanceof SpherechainError, `${error.stack}`);
      ++refused;
    }
  }
  assert.ok(refused > 0);
  spherechain.createModel(bytes).dispose();  // the module still works
});

test('wrong arguments are refused', () => {
  const model = spherechain.createModel(bytes, joints), body = model.createBody();
  refuses(() => body.contacts(), /setPose/);
  refuses(() => body.setPose(new Float32Array(15)), new RegExp(`15 floats: ${16 * joints.length}`));
  refuses(() => body.setPose(undefined), /no floats/);
  refuses(() => body.setPose(rest, { morphWeights: new Float32Array(3) }), /3 morph weights: the asset has 0/);
  refuses(() => spherechain.createModel(bytes, joints.slice(1)), new RegExp(`bone "${joints[0].name}"`));
  const doubled = joints.map(joint => ({ ...joint, inverseBind: joint.inverseBind.map(x => 2 * x) }));
  refuses(() => spherechain.createModel(bytes, doubled), /inverse bind/);
  model.checkRest(rest);
  refuses(() => model.checkRest(posed), /bind pose/);
  refuses(() => model.checkRest(rest.subarray(1)), /are wanted/);
  for (const value of [NaN, Infinity, -Infinity]) {
    const palette = rest.slice();
    palette[16 * 3 + 5] = value;
    refuses(() => body.setPose(palette), new RegExp(`bone "${joints[3].name}" \\(joint 3\\) is not finite`));
    refuses(() => body.contacts(), /setPose/);
  }
  body.setPose(rest.map(value => 1e38 * value));
  body.spherePairs();
  body.penetrations();
  body.vertices();
  model.dispose();
  for (const call of [() => body.spherePairs(), () => body.setPose(rest), () => body.vertices(), () => body.bounds(),
    () => model.createBody(), () => model.createIgnoredPairs(), () => model.triangle(0), () => model.checkRest(rest)]) refuses(call, /disposed/);
  model.dispose();
  body.dispose();
});

test('a skeleton that does not fit is refused, and the joint named', () => {
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
    refuses(() => spherechain.createModel(bytes, wrong), message);
  }
  const named = spherechain.createModel(bytes, [{ name: 'of no bone' }, ...joints.map(({ name: own }) => ({ name: own }))]);
  assert.equal(named.jointCount, joints.length + 1);
  named.dispose();
});

// Joints of an animation that stands still: each at its place at rest, without a turn. They hang on each other as body parts do.
function standing(model) {
  const parents = new Int32Array(model.jointCount).fill(-1), joints = new Float32Array(10 * model.jointCount), places = [];
  for (const { joint, parent } of model.parts) if (joint >= 0 && parent >= 0 && model.parts[parent].joint !== joint) parents[joint] = model.parts[parent].joint;
  model.bones.forEach(({ name, inverseBind: m }) => {
    places[model.bones.findIndex(bone => bone.name === name)] = [0, 1, 2].map(i => -(m[4 * i] * m[12] + m[4 * i + 1] * m[13] + m[4 * i + 2] * m[14]));
  });
  parents.forEach((parent, joint) => {
    const above = parent < 0 ? [0, 0, 0] : places[parent];
    joints.set([...places[joint].map((value, i) => value - above[i]), 0, 0, 0, 1, 1, 1, 1], 10 * joint);
  });
  return { parents, joints };
}

test('a response turns arms out of a body, of another one and of the ground', () => {
  const model = spherechain.createModel(bytes), body = model.createBody(), other = model.createBody();
  const { parents, joints: still } = standing(model), response = body.createResponse({ parents });
  const options = { seconds: 1 / 30 }, upperArm = model.parts.find(({ name }) => name === 'left upper arm').joint;
  const play = (own, state, turns, more = {}) => turns.map(turn => {
    const joints = still.slice();
    joints.set([0, 0, Math.sin(turn / 2), Math.cos(turn / 2)], 10 * upperArm + 3);
    const { turned, rows } = own.respond(state, joints, { ...options, ...more });
    return { joints, turned, rows: structuredClone([...rows]) };
  });
  assert.equal(response.body, body);
  const first = spherechain.createResponseState();
  assert.equal(first.length, 960);
  const [alone] = play(response, first, [0]);
  assert.deepEqual([alone.turned, alone.joints], [0, still]);

  const turns = Array.from({ length: 30 }, (_, i) => -i / 20), state = spherechain.createResponseState();
  const found = play(response, state, turns);
  const turned = found.reduce((sum, frame) => sum + frame.turned, 0);
  assert.ok(turned > 5, `${turned}`);
  const [row] = found.flatMap(({ rows }) => rows);
  assert.ok(row.body === 0 && row.part !== row.other && Math.abs(Math.hypot(...row.normal) - 1) < 1e-5 && row.allowed >= 0);
  assert.ok(state.some(word => word !== 0));
  const copy = state.slice(), again = body.createResponse({ parents: [...parents] });
  assert.deepEqual(play(again, copy, turns), play(response, state, turns));
  assert.deepEqual(copy, state);
  const sum = frames => frames.reduce((total, frame) => total + frame.turned, 0);
  const fresh = (settings, more) => sum(play(body.createResponse({ parents, ...settings }), spherechain.createResponseState(), turns, more));
  assert.equal(fresh({}), turned);
  assert.equal(fresh({ mobility: new Float32Array(parents.length) }), 0);
  assert.equal(fresh({ budget: new Float32Array(parents.length) }), 0);
  assert.equal(fresh({ partPairs: [] }), 0);
  assert.equal(fresh({}, { weakness: 1 }), 0);
  assert.ok(fresh({ rule: { touchDepth: 0.02 } }) !== turned);
  assert.ok(fresh({ hinges: new Float32Array(3 * parents.length).fill(1) }) > 0);
  assert.ok(fresh({}, { planted: [upperArm] }) !== turned);
  assert.ok(fresh({}, { ahead: still, aheadFrames: 1, rounds: 2 }) !== turned);

  other.setPose(new Float32Array(12 * model.jointCount).map((_, i) => (i % 12 % 5 === 0 ? 1 : 0)), { place: { translation: [0.9 * model.height, 0, 0] } });
  const place = { translation: [0.3 * model.height, 0, 0] }, high = { height: 0.8 * model.height };
  const sides = more => new Set(play(again, spherechain.createResponseState(), turns.slice(0, 10), more).flatMap(({ rows }) => rows.map(one => one.body)));
  assert.ok(sides({ place, others: [other] }).has(1));
  assert.ok(sides({ ground: high }).has(1));
  assert.ok(play(again, spherechain.createResponseState(), [0], { ground: high })[0].rows.some(one => one.other === -1));
  model.dispose();
});

test('wrong arguments of a response are refused', () => {
  const model = spherechain.createModel(bytes), body = model.createBody(), unposed = model.createBody();
  const { parents, joints } = standing(model), response = body.createResponse({ parents }), state = spherechain.createResponseState();
  const create = (options, message) => refuses(() => body.createResponse(options), message);
  create(undefined, /createResponse\(\): an object is wanted/);
  create({ parents, speed: 3 }, /"speed" is none of parents/);
  create({}, /parents: a number for each joint/);
  create({ parents: [0.5] }, /parents: a number for each joint/);
  create({ parents: parents.subarray(2) }, /^(joints|parents): /);
  create({ parents: [0, ...parents.subarray(1)] }, /^parents: /);
  create({ parents, mobility: [1] }, /mobility: a number for each joint is wanted, not an Array of 1/);
  create({ parents, mobility: new Float32Array(parents.length).fill(2) }, /^joints: /);
  create({ parents, budget: new Float32Array(parents.length).fill(NaN) }, /budget/);
  create({ parents, hinges: [1] }, /hinges: a number for each joint is wanted, not an Array of 1/);
  create({ parents, partPairs: [[0, 999]] }, /partPairs: \[0, 999\]/);
  create({ parents, rule: { touchDepth: NaN } }, /rule/);

  const before = joints.slice(), seconds = 1 / 30;
  const respond = (options, message, own = joints, words = state) => refuses(() => response.respond(words, own, options), message);
  respond(undefined, /respond\(\): an object is wanted/);
  respond({ seconds, rows: 3 }, /"rows" is none of seconds/);
  respond({ seconds }, /state: what createResponseState\(\) made/, joints, new Uint32Array(3));
  respond({ seconds }, /joints: a Float32Array of \d+ is wanted/, joints.subarray(1));
  respond({ seconds }, /joints: a Float32Array/, [...joints]);
  respond({ seconds }, /^transform: /, new Float32Array(joints.length));
  respond({ seconds: NaN }, /^query: /);
  respond({ seconds: Infinity }, /^query: /);
  respond({ seconds: '1' }, /seconds: a number is wanted/);
  respond({ seconds, weakness: -1 }, /^query: /);
  respond({ seconds, rounds: 17 }, /^query: /);
  respond({ seconds, planted: [0, 0, 0, 0, 0] }, /^joints: /);
  respond({ seconds, rounds: 1.5 }, /rounds: a whole number/);
  respond({ seconds, ahead: joints }, /ahead, aheadFrames: both/);
  respond({ seconds, aheadFrames: 1 }, /ahead, aheadFrames: both/);
  respond({ seconds, ahead: joints, aheadFrames: 4 }, /^query: /);
  respond({ seconds, ahead: joints.subarray(1), aheadFrames: 1 }, /ahead: a Float32Array/);
  respond({ seconds, place: { rotation: [0, 0, 1] } }, /rotation: 4 numbers/);
  respond({ seconds, morphWeights: new Float32Array(3) }, /3 morph weights/);
  respond({ seconds, others: body }, /others: a list is wanted/);
  respond({ seconds, others: [model] }, /others\[0\]: a body is wanted, not a Model/);
  respond({ seconds, others: [unposed] }, /setPose/);
  respond({ seconds, others: [body] }, /another body/);
  respond({ seconds, others: Array(9).fill(unposed) }, /at most 8/);
  respond({ seconds, ground: { up: [0, 0, 0] } }, /floor/);
  assert.deepEqual(joints, before);
  assert.ok(state.every(word => word === 0));
  response.respond(state, joints, { seconds });
  const second = body.createResponse({ parents });
  second.dispose();
  second.dispose();
  refuses(() => second.respond(state, joints, { seconds }), /disposed/);
  body.dispose();
  respond({ seconds }, /disposed/);
  refuses(() => body.createResponse({ parents }), /disposed/);
  model.dispose();
});

test('memory is given back', () => {
  const round = () => {
    const model = spherechain.createModel(bytes, joints), body = model.createBody(), ignoredPairs = model.createIgnoredPairs();
    body.createResponse({ parents: new Int32Array(joints.length).fill(-1) });
    body.setPose(posed);
    body.setPose(null, { vertices: new Float32Array(3 * model.vertexCount) });
    body.penetrations({ ignoredPairs });
    const { buffer } = body.vertices();
    model.dispose();
    return buffer.byteLength;
  };
  const first = round();
  for (let i = 0; i < 20; ++i) round();
  assert.equal(round(), first);
});
