// SPDX-License-Identifier: MIT
// golden.mjs PACKAGE FOLDER CLIP JOINTS: the golden hashes of tests/golden that come from bone matrices and from joints, by the package.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { addPartContact, addPenetration } from './frame_hashes.mjs';

const [packageFolder, folder, clip, jointsFile] = process.argv.slice(2);
const { load } = await import(pathToFileURL(`${packageFolder}/index.js`));

// FNV-1a of 64 bits over words of 32, low byte first: tests/golden/hashes.cpp.
class Hash {
  low = 0x84222325;
  high = 0xcbf29ce4;
  count = 0;

  word(word) {
    for (let shift = 0; shift < 32; shift += 8) {
      const low = (this.low ^ ((word >>> shift) & 0xff)) >>> 0;
      // times 2^40 + 0x1b3
      const product = low * 0x1b3;
      this.high = (Math.imul(this.high, 0x1b3) + Math.floor(product / 2 ** 32) + (low << 8)) >>> 0;
      this.low = product >>> 0;
    }
  }
  words(array) {
    for (const word of array) this.word(word);
  }
  floats(array) {
    this.words(new Uint32Array(new Float32Array(array).buffer));
  }
  line(name) {
    const hex = part => part.toString(16).padStart(8, '0');
    return `${name.padEnd(28)} ${String(this.count).padStart(8)} ${hex(this.high)}${hex(this.low)}`;
  }
}

const END = 0xffffffff;
const spherechain = await load();
const model = spherechain.createModel(readFileSync(`${folder}/doll.sphc`)), body = model.createBody();
const bytes = readFileSync(clip);
const all = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
const floats = 12 * model.boneCount, frames = all.length / floats;

let previous = [];
// The hashes have penetrations by the two parts, the lesser number first.
const lesser = ({ part, other }) => 1000 * Math.min(part, other) + Math.max(part, other);
const hashes = new Map();
const hash = name => hashes.get(name) ?? hashes.set(name, new Hash()).get(name);

for (let frame = 0; frame < frames; ++frame) {
  body.setPose(all.subarray(floats * frame, floats * (frame + 1)));
  for (const radius of ['fit', 'detect']) {
    const spheres = hash(`spheres bones ${radius}`), pairs = hash(`all_pairs bones ${radius}`);
    const found = body.spherePairs({ radius });
    spheres.floats(found.spheres);
    spheres.count += model.sphereCount;
    pairs.words(found.pairs);
    pairs.word(END);
    pairs.count += found.total;
  }
  const skinned = hash('skinned vertices'), positions = body.vertices();
  for (let i = 0; i < positions.length; i += 3) skinned.floats([positions[i], positions[i + 1], positions[i + 2], 0]);
  skinned.count += positions.length / 3;

  const contacts = body.contacts({ full: true }), parts = hash('part contacts bones');
  for (const contact of contacts.parts) addPartContact(parts, contact);
  parts.count += contacts.parts.length;
  parts.word(END);

  const triangles = hash('triangle contacts bones'), crossings = hash('crossing segments bones');
  for (let i = 0; i < contacts.triangles.length; i += 12) {
    triangles.words(contacts.triangles.subarray(i, i + 2));
    crossings.floats(contacts.segments.subarray(i + 6, i + 12));
  }
  triangles.word(END);
  triangles.count += contacts.triangleTotal;
  crossings.word(END);
  crossings.count += 2 * contacts.triangleTotal;

  if (frame % 4 === 0) {
    const measured = hash('penetrations bones');
    previous = body.penetrations({ full: true, classes: spherechain.classes, previous });
    for (const found of [...previous].sort((l, r) => lesser(l) - lesser(r))) addPenetration(measured, found);
    measured.count += previous.total;
    measured.word(END);
  }
}

const joints = readFileSync(jointsFile), jointWords = new Uint32Array(joints.buffer, joints.byteOffset, joints.length / 4);
const jointCount = jointWords[0], parents = jointWords.slice(1, 1 + jointCount), state = spherechain.createResponseState();
const transforms = new Float32Array(joints.buffer, joints.byteOffset).subarray(1 + jointCount);
const response = body.createResponse({ parents }), turns = hash('response');
for (let at = 0; at < transforms.length; at += 10 * jointCount) {
  const own = transforms.slice(at, at + 10 * jointCount);
  response.respond(state, own, { seconds: 1 / 32 });
  for (let joint = 0; joint < jointCount; ++joint) turns.floats(own.subarray(10 * joint + 3, 10 * joint + 7));
  turns.count += jointCount;
}

const wanted = new Set(readFileSync(`${folder}/hashes.txt`, 'utf8').split('\n'));
let wrong = 0;
for (const [name, made] of hashes) {
  if (wanted.has(made.line(name))) continue;
  console.error(`found    ${made.line(name)}`);
  ++wrong;
}
console.log(`${hashes.size - wrong} of ${hashes.size} hashes over ${frames} frames are those of ${folder}/hashes.txt`);
process.exitCode = wrong === 0 && frames === 300 ? 0 : 1;
