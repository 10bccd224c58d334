// The runtime in the page: what touches in a pose that no frame has.
import { load } from 'spherechain';
import { isFault, keyOf } from './contacts.js';
import { decode } from './frame_lists.js';

const KINDS = ['rest', 'shell', 'touch', 'fold', 'deep_fold', 'penetration']; // the runtime's words for CLASSES of contacts.js

// Whether the page was built with it.
export const hasRuntime = load !== null;

export async function openLive(base64, { unitsPerMm }) {
  const runtime = await load();
  const asset = runtime.open(decode(base64, Uint8Array));
  const character = asset.createCharacter();
  const bones = new Float32Array(12 * character.jointCount);
  for (let b = 0; b < bones.length; b += 12) bones[b] = bones[b + 5] = bones[b + 10] = 1; // what hangs on none stays there

  const measure = (found, isQuick) => {
    const kind = KINDS.indexOf(found.kind);
    const isUnseen = isQuick && found.visible === 1 && !isFault({ kind }); // nobody looked
    return {
      parts: [found.part, found.other],
      kind,
      depth: found.depth / unitsPerMm,
      direction: [...found.direction],
      at: [...found.deepest.position],
      visible: isUnseen ? -1 : found.visible,
      volume: found.volume === null ? -1 : found.volume / (10 * unitsPerMm) ** 3,
    };
  };

  const rest = bones.slice();
  return {
    // Directions out of the next pose are looked for as if it were the first: nothing touches at rest.
    forget() {
      character.setPalette(rest);
      character.contacts('apart');
      character.penetrations(false);
    },
    // Pairs of triangles that intersect, and what their body parts' contacts measure, by key. `isQuick`: likely faults
    // alone are measured along all directions; else all are, and the directions of faults stay near those of the last pose, so
    // that arrows do not flicker.
    find(palette, morphs, isQuick) {
      const start = performance.now();
      bones.set(palette);
      character.setPalette(bones, morphs);
      const parts = character.contacts('apart');
      const { count, pairs: words } = parts.length > 0 ? character.triangleContacts() : { count: 0, pairs: [] };
      const pairs = new Uint32Array(2 * count);
      for (let i = 0; i < count; ++i) pairs.set([words[12 * i], words[12 * i + 1]], 2 * i);
      const between = performance.now();
      const measures = new Map();
      if (count > 0) for (const found of character.penetrations(isQuick)) measures.set(keyOf([found.part, found.other]), measure(found, isQuick));
      return { pairs, measures, times: { contacts: between - start, depths: performance.now() - between } };
    },
    // Of the pose that was last looked at.
    spheres: (radius) => character.refit(radius).slice(),
    touching: (radius) => character.detect(radius).slice(),
  };
}
