// SPDX-License-Identifier: MIT
// three.mjs CHROMIUM DOCUMENT HELLO, in a folder with the sample, hero.glb, hero.sphc and node_modules: the document's program with
// three.js in Node, and the sample's page. HELLO is what samples/hello prints of the clip.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { serve, visit } from './chromium.mjs';

const [chromium, document, helloFile] = process.argv.slice(2);
const programs = [...readFileSync(document, 'utf8').matchAll(/```js\n(.*?)```/gs)].map(([, program]) => program);
writeFileSync('three.mjs', programs.find(program => program.includes('GLTFLoader')));
// The clip has a key each second. Between keys three.js blends rotations otherwise than the samples' reader does.
const hello = readFileSync(helloFile, 'utf8');
const atKeys = text => text.split('\n').map(line => line.split(';')[0]).filter(line => /^frame (30|60|90|120|150):/.test(line)).sort();
const wanted = atKeys(hello);
assert.ok(wanted.length > 3);
assert.deepEqual(atKeys(execFileSync(process.execPath, ['three.mjs'], { encoding: 'utf8' })), wanted);

const server = await serve('.');
const page = await visit(chromium, `${server.url}/three.html`);
try {
  await page.wait("document.querySelector('li')");
  // A frame with faults, and how much of the picture is skin, and red. In one task with the drawing: the canvas is cleared after it.
  const { lines, skin, red } = await page.wait(`new Promise(done => requestAnimationFrame(() => {
    const source = document.querySelector('canvas'), copy = new OffscreenCanvas(source.width, source.height).getContext('2d');
    copy.drawImage(source, 0, 0);
    const { data } = copy.getImageData(0, 0, source.width, source.height);
    let skin = 0, red = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (data[i] > 150 && data[i] > 3 * data[i + 1]) ++red;
      else if (data[i] !== data[0]) ++skin;
    }
    const lines = [...document.querySelectorAll('li')].map(line => line.textContent);
    done(lines.length > 0 && red > 0 && { lines, skin, red });
  }))`);
  assert.ok(skin > 2000 && red < skin / 10, `${skin} pixels of skin, ${red} red`);
  for (const line of lines) {
    const [, parts] = /^(.+ in .+): \d+ mm, (?:inside|penetration|deep_fold)$/.exec(line) ?? assert.fail(line);
    assert.ok(hello.includes(`: ${parts},`), `${line}: not in this clip`);
  }
  assert.deepEqual(page.noise, []);
} finally {
  await page.close();
  server.close();
}
