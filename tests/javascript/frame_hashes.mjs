// SPDX-License-Identifier: MIT
// The line that reference.cpp prints of a frame, by the package: for Node and for a page.
const KINDS = ['rest', 'shell', 'touch', 'fold', 'deep_fold', 'penetration'];
const RELATIONS = ['apart', 'near', 'siblings', 'joined', 'two_bodies'];

class Hash {
  value = 2166136261;
  words(array) {
    for (const word of array) this.value = Math.imul(this.value ^ word, 16777619);
  }
  floats(array) {
    this.words(new Uint32Array(Float32Array.from(array).buffer));
  }
  get hex() {
    return (this.value >>> 0).toString(16).padStart(8, '0');
  }
}

// The words of an sc_penetration. `hash` has words() and floats().
export function addPenetration(hash, found) {
  hash.words([found.part, found.other, found.bone, KINDS.indexOf(found.kind)]);
  hash.floats([...found.direction, found.distance, ...found.centre, ...found.low, ...found.high]);
  for (const point of [found.deepest, found.deepestOther]) {
    hash.floats(point.position);
    hash.words([point.triangle]);
    hash.floats(point.weights);
  }
  hash.floats([found.depth, found.volume ?? -1, found.contourLength, found.visible, found.touching, found.facing]);
  hash.floats([found.restDistance, found.thickness ?? -1, found.swallowed ?? -1, found.height, found.metre]);
  hash.words([RELATIONS.indexOf(found.relation), found.isOnePiece ? 1 : 0]);
}

function hashPenetrations(list) {
  const hash = new Hash();
  for (const found of list) addPenetration(hash, found);
  return hash;
}

function hashContacts(list) {
  const hash = new Hash();
  for (const contact of list) {
    hash.words([contact.partA, contact.partB, contact.trianglePairs]);
    hash.floats([...contact.low, ...contact.high]);
  }
  return hash;
}

// The line of --pair.
export function pairHashes(a, b) {
  const contacts = a.contactsWith(b);
  const hashes = [hashContacts(contacts), hashPenetrations(a.penetrationsWith(b)), hashPenetrations(a.penetrationsWith(b, false))];
  return `${contacts.length} ${hashes.map(hash => hash.hex).join(' ')}`;
}

// Of the palette that was set. A new character for each frame: the thorough measure keeps the frame before.
export function frameHashes(character) {
  const spheres = new Hash(), pairs = new Hash(), triangles = new Hash();
  for (const radius of ['detect', 'fit']) {
    spheres.floats(character.refit(radius));
    pairs.words(character.detect(radius));
  }
  const parts = hashContacts(character.contacts());
  triangles.words(character.triangleContacts().pairs);
  const quick = hashPenetrations(character.penetrations()), thorough = hashPenetrations(character.penetrations(false));
  return [spheres, pairs, parts, triangles, quick, thorough].map(hash => hash.hex).join(' ');
}
