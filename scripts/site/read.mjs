// SPDX-License-Identifier: MIT
// Reads a site from disk in headless Chromium, as a stranger does: `node read.mjs FOLDER`. It follows every link, searches, poses the
// character of the demo, and looks for what does not fit a phone.
import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

const folder = process.argv[2];
const home = pathToFileURL(join(folder, 'index.html')).href;
const top = home.slice(0, -'index.html'.length);
const browser = await chromium.launch({ executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'] });
const noise = [];
async function open(width, colorScheme = 'light') {
  const page = await (await browser.newContext({ viewport: { width, height: 844 }, colorScheme, hasTouch: width < 500 })).newPage();
  page.on('console', (message) => message.text().includes('ReadPixels') || noise.push(`${page.url()}: ${message.text()}`));
  page.on('pageerror', (error) => noise.push(`${page.url()}: ${error.message}`));
  page.on('requestfailed', (request) => noise.push(`${page.url()}: ${request.url()} is missing`));
  page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || noise.push(`${page.url()}: asks for ${request.url()}`));
  return page;
}

// Every page that links lead to, with its anchors and links; on a phone, where a page that is too wide shows.
const page = await open(390);
const pages = new Map();
const queue = [home];
while (queue.length > 0) {
  const url = queue.pop();
  if (pages.has(url)) continue;
  await page.goto(url);
  const read = await page.evaluate(() => ({
    ids: [...document.querySelectorAll('[id]')].map(({ id }) => id),
    links: [...document.querySelectorAll('a[href]')].map(({ href }) => href),
    broken: [...document.images].filter(({ naturalWidth }) => naturalWidth === 0).map(({ src }) => src),
    excess: document.documentElement.scrollWidth - innerWidth,
  }));
  pages.set(url, read);
  assert.deepEqual(read.broken, [], `${url}: pictures are missing`);
  assert.ok(read.excess <= 0, `${url}: ${read.excess} pixels too wide for a phone`);
  for (const link of read.links) {
    if (link.startsWith('file:')) queue.push(link.split('#')[0]);
    else assert.match(link, /^https:/, `${url}: ${link}`);
  }
}
let links = 0;
for (const [url, read] of pages) {
  for (const link of read.links.filter((href) => href.startsWith('file:'))) {
    const [target, anchor] = link.split('#');
    ++links;
    assert.ok(target.startsWith(top), `${url}: ${link} leads out of the site`);
    // The page of `view` takes a link to a frame.
    if (anchor && !target.endsWith('demo/human.html')) assert.ok(pages.get(target).ids.includes(decodeURIComponent(anchor)), `${url}: ${link}: there is no such heading`);
  }
}
const written = readdirSync(folder, { recursive: true }).filter((name) => name.endsWith('.html')).map((name) => top + name);
assert.deepEqual(written.filter((url) => !pages.has(url)), [], 'pages that no link leads to');

// A table of sentences and long commands fits a laptop.
const desk = await open(1280, 'dark');
await desk.goto(`${top}docs/how-we-know.html`);
assert.ok(await desk.evaluate(() => [...document.querySelectorAll('.wide')].every(({ scrollWidth, clientWidth }) => scrollWidth <= clientWidth)), 'a table runs off');

// The search: by words, by a key with an underscore, with a slip of the pen, from a page two folders down. A word that is there finds
// no similar words.
await desk.goto(`${top}docs/cli/bake.html`);
async function search(words, title) {
  await desk.keyboard.press('Escape');
  await desk.locator('main').click({ position: { x: 2, y: 2 } });
  await desk.keyboard.press('/');
  await desk.keyboard.press('Control+A');
  await desk.keyboard.type(words);
  await desk.locator('#results a', { hasText: title }).first().waitFor({ timeout: 10000 });
}
await search('detect_quantile', 'detect_quantile');
await search('unity colliders', 'Colliders');
await search('collizion response', 'Collision response');
for (const word of ['severity', 'retarget']) {
  await search(word, word);
  const marked = await desk.locator('#results mark').allTextContents();
  assert.deepEqual(marked.filter((text) => !text.toLowerCase().startsWith(word)), [], `found for ${word}`);
}
await search('exit codes', 'Exit codes');
await desk.keyboard.press('Enter');
await desk.waitForURL(/docs\/cli\/index\.html#exit-codes$/);
await desk.locator('#search').fill('xyzzyx');
await desk.getByText('Nothing is found.').waitFor();
const paper = () => desk.evaluate(() => getComputedStyle(document.body).backgroundColor);
const dark = await paper();
await desk.locator('#theme').click();
assert.notEqual(await paper(), dark);

// The demo: contacts of the frame it opens at, then those of a hand that is dragged.
await desk.getByRole('link', { name: 'Live demo' }).click();
await desk.waitForURL(/demo\/index\.html$/);
const frame = await (await desk.locator('iframe').elementHandle()).contentFrame();
await frame.waitForFunction(() => window.spherechainViewer?.ready, null, { timeout: 60000 });
const contacts = () => frame.evaluate(() => spherechainViewer.contacts().map(({ name }) => name).sort().join());
assert.equal(await contacts(), 'right hand, left hand');
await frame.getByRole('button', { name: 'Pose' }).click();
await frame.waitForFunction(() => spherechainViewer.posing.isLive(), null, { timeout: 60000 });
const { x, y, width, height } = await frame.locator('.handle[title="left hand"]').boundingBox();
await desk.mouse.move(x + width / 2, y + height / 2);
await desk.mouse.down();
await desk.mouse.move(x + 100, y - 60, { steps: 3 });
await desk.mouse.up();
await frame.waitForFunction(() => !spherechainViewer.contacts().some(({ name }) => name === 'right hand, left hand'), null, { timeout: 20000 });

assert.deepEqual(noise, []);
console.log(`${pages.size} pages, ${links} links, search and demo: as they should be`);
await browser.close();
