// SPDX-License-Identifier: MIT
// A clip through the package: for Node and for a page.
import { ignoredPairsOf, frameHashes } from './frame_hashes.mjs';
import { readPalettes } from '../../samples/javascript/palettes.mjs';

// The calls that are timed, after setPose(); and how often in a row, where a page's clock is too coarse for once.
const CALLS = {
  spherePairs: [body => body.spherePairs(), 20],
  vertices: [body => body.vertices(), 5],
  contacts: [body => body.contacts(), 1],
  penetrations: [body => body.penetrations(), 1],
  full: [(body, classes) => body.penetrations({ full: true, classes }), 1],
};

// `asset`, `palettes`: ArrayBuffers. Lines as reference.cpp prints them; milliseconds a frame of each call; and of the very first
// calls: from load() to the first penetrations.
export async function measure(load, asset, palettes, passes, calls = ['contacts', 'penetrations']) {
  const start = performance.now();
  const spherechain = await load(), { joints, frames } = readPalettes(palettes);
  const model = spherechain.createModel(asset, joints), body = model.createBody({ findsSteps: true }), made = performance.now();
  body.setPose(frames.at(-1));
  body.penetrations();
  const first = { open: made - start, frame: performance.now() - made };

  const times = Object.fromEntries(calls.map(name => [name, fastest(...CALLS[name])]));
  const ignoredPairs = ignoredPairsOf(model);
  const lines = frames.map((_, frame) => frameHashes(body, ignoredPairs, frames, frame));
  model.dispose();
  return { lines, first, ...times };

  // Each frame's fastest pass: other programs of the machine do not count.
  function fastest(ask, repeats) {
    const best = new Float64Array(frames.length).fill(Infinity);
    for (let pass = 0; pass < passes; ++pass) {
      frames.forEach((palette, frame) => {
        const before = performance.now();
        for (let i = 0; i < repeats; ++i) {
          body.setPose(palette);
          ask(body, spherechain.classes);
        }
        best[frame] = Math.min(best[frame], (performance.now() - before) / repeats);
      });
    }
    return best.reduce((sum, time) => sum + time) / frames.length;
  }
}

// How much longer quick depths are than full ones, frame by frame as a clip plays: ratios, sorted; and how many classes differ, and
// how many faults.
export async function quickAgainstFull(load, asset, palettes) {
  const spherechain = await load(), { joints, frames } = readPalettes(palettes);
  const model = spherechain.createModel(asset, joints), body = model.createBody(), { classes } = spherechain;
  const ratios = [];
  let otherClasses = 0, otherFaults = 0;
  const isFault = ({ kind }) => ['deep_fold', 'penetration', 'inside'].includes(kind);
  for (const palette of frames) {
    body.setPose(palette);
    const quick = new Map(structuredClone(body.penetrations({ classes })).map(found => [`${found.part} ${found.other}`, found]));
    for (const found of body.penetrations({ classes, full: true })) {
      const same = quick.get(`${found.part} ${found.other}`);
      ratios.push(same.measures.depth / found.measures.depth);
      if (same.kind !== found.kind) ++otherClasses;
      if (isFault(same) !== isFault(found)) ++otherFaults;
    }
  }
  model.dispose();
  return { ratios: ratios.sort((a, b) => a - b), otherClasses, otherFaults };
}
