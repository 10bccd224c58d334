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
  const asset = spherechain.open(readFileSync(assetFile));
  const { joints, rest, frames } = readPalettes(new Uint8Array(readFileSync(palettesFile)).buffer);
  const character = asset.createCharacter(joints);  // allocates here, not in a frame
  character.setPalette(rest);
  character.checkRest();

  frames.forEach((palette, frame) => {
    character.setPalette(palette);  // what your skinning shader gets
    for (const found of character.penetrations()) {
      if (found.kind !== 'penetration') continue;  // folds at joints, touches ...
      const out = Array.from(found.direction, x => x.toFixed(2)).join(', ');  // the way that the part must go
      console.log(`frame ${frame}: ${asset.parts[found.part].name} in ${asset.parts[found.other].name}, ` +
        `${(1000 * asset.metresPerUnit * found.depth).toFixed(0)} mm; out along (${out})`);
    }
  });
  asset.dispose();
} catch (error) {
  console.error(`which_parts: error: ${error.message}`);
  process.exit(3);
}
