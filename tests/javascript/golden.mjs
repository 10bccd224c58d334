// SPDX-License-Identifier: MIT
// golden.mjs PACKAGE FOLDER CLIP: the golden hashes of tests/golden that come from bone matrices, by the package.
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { addPenetration } from './frame_hashes.mjs';

const [packageFolder, folder, clip] = process.argv.slice(2);
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
const asset = (await load()).open(readFileSync(`${folder}/doll.sphc`));
const character = asset.createCharacter();
const bytes = readFileSync(clip);
const all = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
const floats = 12 * asset.bones.length, frames = all.length / floats;

const hashes = new Map();
const hash = name => hashes.get(name) ?? hashes.set(name, new Hash()).get(name);

for (let frame = 0; frame < frames; ++frame) {
  character.setPalette(all.subarray(floats * frame, floats * (frame + 1)));
  for (const radius of ['fit', 'detect']) {
    const spheres = hash(`spheres bones ${radius}`), pairs = hash(`all_pairs bones ${radius}`);
    spheres.floats(character.refit(radius));
    spheres.count += asset.spheres.length;
    const found = character.detect(radius);
    pairs.words(found);
    pairs.word(END);
    pairs.count += found.length / 2;
  }
  const skinned = hash('skinned vertices'), positions = character.vertices();
  for (let i = 0; i < positions.length; i += 3) skinned.floats([positions[i], positions[i + 1], positions[i + 2], 0]);
  skinned.count += positions.length / 3;

  const parts = hash('part contacts bones');
  for (const contact of character.contacts()) {
    parts.words([contact.partA, contact.partB, contact.trianglePairs]);
    parts.floats([...contact.low, ...contact.high]);
    ++parts.count;
  }
  parts.word(END);

  const { count, pairs, segments } = character.triangleContacts();
  const triangles = hash('triangle contacts bones'), crossings = hash('crossing segments bones');
  for (let i = 0; i < 12 * count; i += 12) {
    triangles.words(pairs.subarray(i, i + 2));
    crossings.floats(segments.subarray(i + 6, i + 12));
  }
  triangles.word(END);
  triangles.count += count;
  crossings.word(END);
  crossings.count += 2 * count;

  if (frame % 4 === 0) {
    const measured = hash('penetrations bones');
    for (const found of character.penetrations(false)) {
      addPenetration(measured, found);
      ++measured.count;
    }
    measured.word(END);
  }
}

const wanted = new Set(readFileSync(`${folder}/hashes.txt`, 'utf8').split('\n'));
let wrong = 0;
for (const [name, made] of hashes) {
  if (wanted.has(made.line(name))) continue;
  console.error(`found    ${made.line(name)}`);
  ++wrong;
}
console.log(`${hashes.size - wrong} of ${hashes.size} hashes over ${frames} frames are those of ${folder}/hashes.txt`);
process.exitCode = wrong === 0 && frames === 256 ? 0 : 1;
