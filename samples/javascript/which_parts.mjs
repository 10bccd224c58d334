// SPDX-License-Identifier: MIT
// node which_parts.mjs ASSET PALETTES: which body parts penetrate each other in a clip, frame by frame, as samples/hello prints it.
import { readFileSync } from 'node:fs';
import { load } from 'spherechain';
import { readPalettes } from './palettes.mjs';

const [assetFile, palettesFile] = process.argv.slice(2);
if (!palettesFile) {
  console.error('usage: node which_parts.mjs ASSET PALETTES');
  process.exit(2);
}
try {
  const spherechain = await load();
  const { joints, rest, frames } = readPalettes(new Uint8Array(readFileSync(palettesFile)).buffer);
  const model = spherechain.createModel(readFileSync(assetFile), joints);
  model.checkRest(rest);
  const body = model.createBody();  // allocates here, not in a frame

  frames.forEach((palette, frame) => {
    body.setPose(palette);  // what your skinning shader gets
    for (const { part, other, joint, direction, distance, measures } of body.penetrations()) {  // faults alone, the worst first
      const way = Array.from(direction, x => (distance * x).toFixed(3)).join(', ');  // moved so far, the part is free
      console.log(`frame ${frame}: ${model.parts[part].name} in ${model.parts[other].name}, ` +
        `${model.millimetres(measures.depth).toFixed(0)} mm; move ${joints[joint]?.name ?? 'nothing'} by (${way})`);
    }
  });
  model.dispose();
} catch (error) {
  console.error(`which_parts: error: ${error.message}`);
  process.exit(3);
}
