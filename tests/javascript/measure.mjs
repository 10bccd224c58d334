// SPDX-License-Identifier: MIT
// A clip through the package: for Node and for a page.
import { frameHashes } from './frame_hashes.mjs';
import { readPalettes } from '../../samples/javascript/palettes.mjs';

// `asset`, `palettes`: ArrayBuffers. Lines as reference.cpp prints them; milliseconds a frame.
export async function measure(load, asset, palettes, passes) {
  const opened = (await load()).open(asset);
  const { joints, frames } = readPalettes(palettes);
  const lines = frames.map(palette => {
    const character = opened.createCharacter(joints);
    character.setPalette(palette);
    const line = frameHashes(character);
    character.dispose();
    return line;
  });
  const character = opened.createCharacter(joints);
  const contacts = fastest(found => found.contacts()), penetrations = fastest(found => found.penetrations());
  opened.dispose();
  return { lines, contacts, penetrations };

  // Each frame's fastest pass: other programs of the machine do not count.
  function fastest(ask) {
    const best = new Float64Array(frames.length).fill(Infinity);
    for (let pass = 0; pass < passes; ++pass) {
      frames.forEach((palette, frame) => {
        const start = performance.now();
        character.setPalette(palette);
        ask(character);
        best[frame] = Math.min(best[frame], performance.now() - start);
      });
    }
    return best.reduce((sum, time) => sum + time) / frames.length;
  }
}
