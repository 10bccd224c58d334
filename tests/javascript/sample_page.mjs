// SPDX-License-Identifier: MIT
// sample_page.mjs CHROMIUM PACKAGE REFERENCE ASSET PALETTES, in a folder with the sample and human.sphc: the page shows and lists
// what the arm is in; contacts of a human take less than half a millisecond; the module works inside a page from disk.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { serve, visit } from './chromium.mjs';
import { measureInChromium } from './in_chromium.mjs';

const [chromium, packageFolder, reference, asset, palettes] = process.argv.slice(2);
const server = await serve('.');
const page = await visit(chromium, `${server.url}/index.html`);
const lines = await page.wait("document.querySelector('.fault') && [...document.querySelectorAll('.fault')].map(line => line.textContent)");
assert.ok(lines.includes('left forearm in abdomen: 80 mm, inside'), lines.join('\n'));
// The picture has the skin and red triangles on it.
const count = `(() => {
  const source = document.querySelector('canvas'), copy = new OffscreenCanvas(source.width, source.height).getContext('2d');
  document.getElementById('left').dispatchEvent(new Event('input'));  // draws, in this task
  copy.drawImage(source, 0, 0);
  const { data } = copy.getImageData(0, 0, source.width, source.height);
  let skin = 0, red = 0;
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] > 2 * data[i + 1] && data[i] > 60) ++red;
    else if (data[i] < 235) ++skin;
  }
  return { skin, red };
})()`;
const { skin, red } = await page.evaluate(count);
assert.ok(skin > 20000 && red > 50 && red < skin / 10, `${skin} pixels of skin, ${red} red`);
await page.evaluate("(() => { for (const id of ['left', 'right']) { const arm = document.getElementById(id); arm.value = 0; arm.dispatchEvent(new Event('input')); } })()");
assert.equal(await page.evaluate("document.querySelectorAll('.fault').length"), 0);
assert.equal((await page.evaluate(count)).red, 0);
assert.deepEqual(page.noise, []);
await page.close();
server.close();

const measured = await measureInChromium(chromium, packageFolder, asset, palettes, 3);
assert.deepEqual(measured.lines, execFileSync(reference, [asset, palettes], { encoding: 'utf8' }).trim().split('\n'));
assert.ok(measured.contacts < 0.5, `${measured.contacts} ms a frame`);
console.log(`contacts ${measured.contacts.toFixed(3)} ms, with penetrations ${measured.penetrations.toFixed(3)} ms a frame`);

writeFileSync('disk.html', `<script type="module">${readFileSync(`${packageFolder}/index.js`, 'utf8')}
  window.version = (await load()).version;
</script>`);
const disk = await visit(chromium, pathToFileURL('disk.html').href);
assert.match(await disk.wait('window.version'), /^\d/);
assert.deepEqual(disk.noise, []);
await disk.close();
