// SPDX-License-Identifier: MIT
// page.mjs DOCUMENT CHROMIUM: the programs of docs/javascript.md, word for word, in this folder: human.sphc, node_modules. And the package
// from CommonJS.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { serve, visit } from './chromium.mjs';

const [document, chromium] = process.argv.slice(2);
const text = readFileSync(document, 'utf8');
const block = pattern => pattern.exec(text)?.[1] ?? assert.fail(`the page has no ${pattern}`);

writeFileSync('first.mjs', block(/```js\n(.*?)```/s));
assert.equal(execFileSync(process.execPath, ['first.mjs'], { encoding: 'utf8' }), block(/It prints:\n\n```\n(.*?)```/s));

const commonJs = "console.log(require('spherechain/package.json').name); import('spherechain').then(({ load }) => load()).then(() => console.log('loaded'))";
assert.equal(execFileSync(process.execPath, ['-e', commonJs], { encoding: 'utf8' }), 'spherechain\nloaded\n');

writeFileSync('index.html', block(/```html\n(.*?)```/s));
const server = await serve('.');
const page = await visit(chromium, `${server.url}/index.html`);
await page.wait("document.querySelector('pre').textContent.includes('left forearm in abdomen')");
assert.deepEqual(page.noise, []);
await page.close();
server.close();
