// SPDX-License-Identifier: MIT
// bench.mjs PACKAGE REFERENCE CHROMIUM (ASSET PALETTES)...: each clip natively, in Node and in Chromium: first the same bits, then
// milliseconds a frame.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { pathToFileURL } from 'node:url';
import { measureInChromium } from './in_chromium.mjs';
import { measure } from './measure.mjs';

const PASSES = 8;
const [packageFolder, reference, chromium, ...clips] = process.argv.slice(2);
const { load } = await import(pathToFileURL(`${packageFolder}/index.js`));
const bytes = file => new Uint8Array(readFileSync(file)).buffer;

const row = (where, contacts, penetrations) => console.log(`  ${where.padEnd(16)} ${contacts.padStart(12)} ${penetrations.padStart(16)}`);
for (; clips.length > 1; clips.splice(0, 2)) {
  const [asset, palettes] = clips;
  const native = target => execFileSync(reference, [asset, palettes, '--time'], { encoding: 'utf8', env: { ...process.env, SPHERECHAIN_TARGET: target } })
    .trim().split('\n');
  const lines = native('best'), times = lines.pop();
  console.log(`${basename(asset)}: ${lines.length} frames, ms a frame`);
  row('', 'contacts', 'and penetrations');
  const runs = [['Node', await measure(load, bytes(asset), bytes(palettes), PASSES)],
    ['Chromium', await measureInChromium(chromium, packageFolder, asset, palettes, PASSES)]];
  for (const time of [times, native('ssse3').pop()]) {
    const [target, contacts, penetrations] = time.split(' ');
    row(`native, ${target}`, contacts, penetrations);
  }
  for (const [where, measured] of runs) {
    const different = lines.filter((line, i) => line !== measured.lines[i]).length;
    if (different > 0) throw new Error(`${where}: ${different} frames differ from the native ones`);
    row(where, measured.contacts.toFixed(4), measured.penetrations.toFixed(4));
  }
}
