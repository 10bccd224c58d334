// SPDX-License-Identifier: MIT
// The lines that reference.cpp prints, by the package: for Node and for a page.
const KINDS = ['rest', 'shell', 'touch', 'fold', 'deep_fold', 'penetration', 'inside'];
const RELATIONS = ['apart', 'near', 'siblings', 'joined', 'two_bodies'];

class Hash {
  value = 2166136261;
  words(array) {
    for (const word of array) this.value = Math.imul(this.value ^ word, 16777619);
  }
  floats(array) {
    this.words(new Uint32Array(Float32Array.from(array).buffer));
  }
  penetrations(list) {
    for (const found of list) addPenetration(this, found);
    this.words([list.total]);
  }
  contacts({ parts, spheres, sphereTotal, triangles, triangleTotal }) {
    for (const contact of parts) addPartContact(this, contact);
    this.words([parts.total, ...spheres, sphereTotal]);
    this.words(triangles);
    this.words([triangleTotal]);
  }
  spherePairs({ spheres, pairs, total }) {
    this.floats(spheres);
    this.words([spheres.length / 4, ...pairs, total]);
  }
  steps(list) {
    for (const found of list) {
      this.words([found.partA, found.partB, found.atStart ? 1 : 0, found.atEnd ? 1 : 0]);
      this.floats([found.begin, found.end]);
      this.words([found.triangleA, found.triangleB]);
      this.floats(found.at);
    }
    this.words([list.total]);
  }
}

// The words of an sc_part_contact, and of an sc_penetration. `hash` has words() and floats().
export function addPartContact(hash, contact) {
  hash.words([contact.partA, contact.partB, contact.trianglePairs]);
  hash.floats([...contact.low, ...contact.high]);
}
export function addPenetration(hash, { part, other, joint, kind, direction, faultDepth, distance, centre, low, high, deepest, deepestOther, measures }) {
  hash.words([part, other, joint, KINDS.indexOf(kind)]);
  hash.floats([...direction, faultDepth, distance, ...centre, ...low, ...high]);
  for (const point of [deepest, deepestOther]) {
    hash.floats(point.position);
    hash.words([point.triangle]);
    hash.floats(point.weights);
  }
  hash.floats([measures.depth, measures.volume ?? -1, measures.contourLength, measures.visible, measures.touching, measures.facing]);
  hash.floats([measures.restDistance, measures.thickness ?? -1, measures.extent ?? -1, measures.height, measures.metre]);
  hash.words([RELATIONS.indexOf(measures.relation), measures.isOnePiece ? 1 : 0]);
  hash.floats([measures.swallowed]);
  hash.words([measures.through ? 1 : 0]);
}

// A line of hashes: each of what its function adds.
const line = answers => answers.map(answer => {
  const hash = new Hash();
  answer(hash);
  return (hash.value >>> 0).toString(16).padStart(8, '0');
}).join(' ');

// A body of a model with `findsSteps`, and `ignoredPairs` of ignoredPairsOf().
export function frameHashes(body, ignoredPairs, frames, frame) {
  body.setPose(frames[Math.max(frame - 1, 0)]);
  const previous = body.penetrations();
  body.setPose(frames[frame]);
  return line([
    hash => hash.penetrations(body.penetrations({ previous })),
    hash => { for (const radius of ['detect', 'fit']) hash.spherePairs(body.spherePairs({ radius })); },
    hash => {
      hash.contacts(body.contacts({ full: true }));
      hash.contacts(body.contacts());
    },
    hash => hash.penetrations(body.penetrations()),
    hash => hash.penetrations(body.penetrations({ classes: KINDS })),
    hash => hash.penetrations(body.penetrations({ full: true, classes: KINDS })),
    hash => hash.penetrations(body.penetrations({ classes: ['touch', 'penetration'], rule: { touchDepth: 0.0625 }, limit: 1 })),
    hash => {
      hash.penetrations(body.penetrations({ classes: KINDS, ignoredPairs }));
      hash.spherePairs(body.spherePairs({ ignoredPairs }));
    },
    hash => {
      const { low, high } = body.bounds(), height = Math.fround(low[1] + 0.0625 * body.model.height);
      for (const corner of [low, high]) {
        hash.floats(corner);
        hash.words([0]);
      }
      hash.penetrations(body.below({ up: [0, 1, 0], height }, { classes: KINDS }));
    },
    hash => hash.steps(body.steps()),
  ]);
}

export function ignoredPairsOf(model) {
  const ignoredPairs = model.createIgnoredPairs();
  ignoredPairs.ignoreParts(0, 1);
  ignoredPairs.ignorePair(0, 1, false);
  return ignoredPairs;
}

// The line of --pair.
export function pairHashes(a, b, frames, frame) {
  for (const palette of frames.slice(frame, frame + 2)) {
    a.setPose(palette);
    b.setPose(palette, { place: { translation: [0.3, 0, 0.3] } });
  }
  const ignored = { classes: KINDS, ignoredParts: Array.from({ length: 16 }, (_, i) => 2 * i), ignoredPartsOfOther: [1, 2] };
  return `${a.contacts(b).parts.length} ${line([
    hash => hash.contacts(a.contacts(b, { full: true })),
    hash => hash.penetrations(a.penetrations(b)),
    hash => hash.penetrations(a.penetrations(b, { full: true, classes: KINDS })),
    hash => hash.penetrations(a.penetrations(b, ignored)),
    hash => hash.steps(a.steps(b)),
  ])}`;
}
