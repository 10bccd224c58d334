// SPDX-License-Identifier: MIT
// bench.mjs PACKAGE REFERENCE CHROMIUM (ASSET PALETTES)...: each clip natively, in Node and in Chromium: first the same bits, then
// milliseconds a frame of each call with its setPose(); what the first frame costs; how far quick depths are from full ones.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { pathToFileURL } from 'node:url';
import { measureInChromium } from './in_chromium.mjs';
import { measure, quickAgainstFull } from './measure.mjs';

const PASSES = 8;
const CALLS = ['spherePairs', 'vertices', 'contacts', 'penetrations', 'full'];
const [packageFolder, reference, chromium, ...clips] = process.argv.slice(2);
const { load } = await import(pathToFileURL(`${packageFolder}/index.js`));
const bytes = file => new Uint8Array(readFileSync(file)).buffer;
const row = (where, cells) => console.log(`  ${where.padEnd(16)}${cells.map(cell => String(cell ?? '').padStart(14)).join('')}`);

for (; clips.length > 1; clips.splice(0, 2)) {
  const [asset, palettes] = clips;
  const native = target => {
    const lines = execFileSync(reference, [asset, palettes, '--time'], { encoding: 'utf8', env: { ...process.env, SPHERECHAIN_TARGET: target } })
      .trim().split('\n');
    const [name, contacts, penetrations] = lines.pop().split(' ');
    return { name: `native, ${name}`, lines, contacts: Number(contacts), penetrations: Number(penetrations) };
  };
  const runs = [native('best'), native('ssse3'),
    { name: 'Node', ...await measure(load, bytes(asset), bytes(palettes), PASSES, CALLS) },
    { name: 'Chromium', ...await measureInChromium(chromium, packageFolder, asset, palettes, PASSES, CALLS) }];
  const { lines } = runs[0];
  console.log(`${basename(asset)}: ${lines.length} frames, ms a frame`);
  row('', [...CALLS, 'first: open', 'first frame']);
  for (const run of runs) {
    const different = lines.filter((line, i) => line !== run.lines[i]).length;
    if (different > 0) throw new Error(`${run.name}: ${different} frames differ from the native ones`);
    row(run.name, [...CALLS.map(call => run[call]?.toFixed(4)), run.first?.open.toFixed(0), run.first?.frame.toFixed(1)]);
  }
  const { ratios, otherClasses, otherFaults } = await quickAgainstFull(load, bytes(asset), bytes(palettes));
  const at = share => `${(100 * (ratios[Math.floor(share * (ratios.length - 1))] - 1)).toFixed(1)} %`;
  console.log(`  quick depths are longer than full ones by ${at(0.5)} in the median, ${at(0.9)} in one case of ten, ${at(0.99)} in one of a hundred; of ` +
    `${ratios.length}, ${ratios.filter(ratio => ratio < 0.999).length} are shorter, ${otherClasses} have another class, ${otherFaults} are a fault in one form alone`);
}
