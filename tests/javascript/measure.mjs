// SPDX-License-Identifier: MIT
// A clip through the package: for Node and for a page.
import { frameHashes } from './frame_hashes.mjs';
import { readPalettes } from '../../samples/javascript/palettes.mjs';

// What is timed, after setPalette(); and how often in a row, where a page's clock is too coarse for once.
const CALLS = {
  refit: [character => character.refit(), 20],
  detect: [character => character.detect(), 20],
  vertices: [character => character.vertices(), 5],
  contacts: [character => character.contacts(), 1],
  penetrations: [character => character.penetrations(), 1],
  thorough: [character => character.penetrations(false), 1],
};

// `asset`, `palettes`: ArrayBuffers. Lines as reference.cpp prints them; milliseconds a frame of each call; and of the very first
// calls: from load() to the first penetrations.
export async function measure(load, asset, palettes, passes, calls = ['contacts', 'penetrations']) {
  const start = performance.now();
  const opened = (await load()).open(asset);
  const { joints, frames } = readPalettes(palettes);
  const character = opened.createCharacter(joints), made = performance.now();
  character.setPalette(frames.at(-1));
  character.penetrations();
  const first = { open: made - start, frame: performance.now() - made };

  const times = Object.fromEntries(calls.map(name => [name, fastest(...CALLS[name])]));
  const lines = frames.map(palette => {
    const fresh = opened.createCharacter(joints);
    fresh.setPalette(palette);
    const line = frameHashes(fresh);
    fresh.dispose();
    return line;
  });
  opened.dispose();
  return { lines, first, ...times };

  // Each frame's fastest pass: other programs of the machine do not count.
  function fastest(ask, repeats) {
    const best = new Float64Array(frames.length).fill(Infinity);
    for (let pass = 0; pass < passes; ++pass) {
      frames.forEach((palette, frame) => {
        const before = performance.now();
        for (let i = 0; i < repeats; ++i) {
          character.setPalette(palette);
          ask(character);
        }
        best[frame] = Math.min(best[frame], (performance.now() - before) / repeats);
      });
    }
    return best.reduce((sum, time) => sum + time) / frames.length;
  }
}

// How much longer quick depths are than thorough ones, frame by frame as a clip plays: ratios, sorted; and how many classes differ.
export async function quickAgainstThorough(load, asset, palettes) {
  const opened = (await load()).open(asset);
  const { joints, frames } = readPalettes(palettes);
  const character = opened.createCharacter(joints);
  const ratios = [];
  let otherKinds = 0;
  for (const palette of frames) {
    character.setPalette(palette);
    const quick = structuredClone(character.penetrations());
    character.penetrations(false).forEach((found, i) => {
      ratios.push(quick[i].depth / found.depth);
      if (quick[i].kind !== found.kind) ++otherKinds;
    });
  }
  opened.dispose();
  return { ratios: ratios.sort((a, b) => a - b), otherKinds };
}
