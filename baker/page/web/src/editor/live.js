// The runtime in the page: what touches in a pose that no frame has.
import { load } from 'spherechain';
import { ArmResponse } from './arm_response.js';
import { isFault, keyOf } from '../model/contacts.js';
import { decode } from '../model/frame_lists.js';

const KINDS = ['rest', 'shell', 'touch', 'fold', 'deep_fold', 'penetration', 'inside']; // the runtime's words for CLASSES of contacts.js

const TURNING_MOST = 16; // joints of a response

// Whether the page was built with it.
export const hasRuntime = load !== null;

export async function openLive(base64, { unitsPerMm }) {
  const runtime = await load();
  const model = runtime.createModel(decode(base64, Uint8Array));
  const { partCount, triangleCount } = model;
  const body = model.createBody({ maxTriangles: triangleCount, maxPenetrations: (partCount * (partCount + 1)) / 2 });
  const bones = new Float32Array(12 * model.jointCount);
  for (let b = 0; b < bones.length; b += 12) bones[b] = bones[b + 5] = bones[b + 10] = 1; // what hangs on none stays there

  const measure = (found, isQuick) => {
    const kind = KINDS.indexOf(found.kind);
    const { depth, visible, volume, swallowed, through } = found.measures;
    const isUnseen = isQuick && visible === 1 && !isFault({ kind }); // nobody looked
    return {
      parts: [found.part, found.other],
      kind,
      depth: depth / unitsPerMm,
      direction: [...found.direction],
      at: [...found.deepest.position],
      visible: isUnseen ? -1 : visible,
      volume: volume === null ? -1 : volume / (10 * unitsPerMm) ** 3,
      swallowed,
      through,
    };
  };

  let previous = []; // of the last pose that was measured in full
  const arms = model.parts.filter(({ name }) => / (upper arm|forearm|hand)$/.test(name));
  return {
    // Null where it has no arms to turn, or too many.
    responseOf: (poser) => (arms.length > 0 && arms.length <= TURNING_MOST ? new ArmResponse(runtime, body, poser) : null),
    // Directions out of the next pose are looked for as if it were the first.
    forget() {
      previous = [];
    },
    // Pairs of triangles that intersect, and what their body parts' contacts measure, by key. `isQuick`: likely faults
    // alone are measured along all directions; else all are, and the directions of faults stay near those of the last pose, so
    // that arrows do not flicker.
    find(palette, morphs, isQuick) {
      const start = performance.now();
      bones.set(palette);
      body.setPose(bones, { morphWeights: morphs });
      const words = body.contacts({ full: true }).triangles;
      const count = words.length / 12, pairs = new Uint32Array(2 * count);
      for (let i = 0; i < count; ++i) pairs.set([words[12 * i], words[12 * i + 1]], 2 * i);
      const between = performance.now();
      const measures = new Map();
      const { classes } = runtime;
      const found = body.penetrations(isQuick ? { classes } : { classes, full: true, previous });
      for (const one of found) measures.set(keyOf([one.part, one.other]), measure(one, isQuick));
      if (!isQuick) previous = structuredClone([...found]);
      return { pairs, measures, times: { contacts: between - start, depths: performance.now() - between } };
    },
    // Spheres of the pose that was evaluated last.
    spheres: (radius) => body.spherePairs({ radius }).spheres.slice(),
    touching: (radius) => body.spherePairs({ radius }).pairs.slice(),
  };
}
