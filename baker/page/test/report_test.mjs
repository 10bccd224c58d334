// The pages of a `spherechain check` report, in headless Chromium: two recordings on the MakeHuman body.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { before, test } from 'node:test';
import { compare, isOfBrowser, keepDrawings, launch, picture, SCALE } from './browser.mjs';

const { SPHERECHAIN_TOOL: tool, SPHERECHAIN_HUMAN: human, SPHERECHAIN_CHROMIUM: chromium, SPHERECHAIN_OUT: out } = process.env;
const folder = join(out, 'report');
const cache = join(out, 'check_cache');
const models = dirname(dirname(human));

function check(...more) {
  const words = ['check', human, '--motion', join(out, 'recordings'), '--fps', '4', '-o', folder, '--cache', cache];
  const { status, stderr } = spawnSync(tool, [...words, '--json', join(out, 'check.json'), ...more], { encoding: 'utf8' });
  assert.ok(status === 0 || status === 6, stderr);
  return JSON.parse(readFileSync(join(out, 'check.json'), 'utf8'));
}

let page;
let json;
const noise = [];
const url = (name) => pathToFileURL(join(folder, name)).href;
before(async () => {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(join(out, 'recordings'), { recursive: true });
  for (const name of ['Boxing_Toes', '01_03']) copyFileSync(join(models, `BVH/${name}.bvh`), join(out, `recordings/${name}.bvh`));
  json = check();
  const browser = await launch(chromium);
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, deviceScaleFactor: SCALE, reducedMotion: 'reduce', acceptDownloads: true });
  page = await context.newPage();
  await page.addInitScript(keepDrawings);
  page.on('console', (message) => isOfBrowser(message.text()) || noise.push(message.text()));
  page.on('pageerror', (error) => noise.push(error.message));
  page.on('request', (request) => /^(file|data|blob):/.test(request.url()) || noise.push(request.url()));
});

const open = async (address = url('index.html')) => {
  await page.goto(address);
  await page.waitForFunction(() => window.spherechainReport?.ready);
};
const rows = () => page.locator('#rows tr').allInnerTexts();
const rank = (event) => ['deep_fold', 'penetration', 'inside'].indexOf(event.class); // the worst last
const faults = (clip) => clip.events.filter((event) => rank(event) >= 0);
const boxing = () => json.clips.find(({ clip }) => clip === 'Boxing_Toes.bvh');
const clipReady = () => page.waitForFunction(() => window.spherechainViewer?.ready);
const chosen = () => page.locator('.event[aria-pressed=true]').innerText();

test('the library is a list of tickets, the worst first, each with its other events below it', async () => {
  await open();
  const tickets = json.tickets;
  assert.ok(tickets.length > 1 && tickets.some(({ events }) => events.length > 1));
  assert.equal(await page.locator('#rows tr:not(.below)').count(), tickets.length);
  assert.ok((await rows())[0].includes(tickets[0].parts.join(' in ')));
  await page.waitForFunction(() => [...document.querySelectorAll('#rows img')].every(({ naturalWidth }) => naturalWidth > 0));
  const first = tickets.findIndex(({ events }) => events.length > 1);
  assert.equal(await page.locator('.below:visible').count(), 0);
  await page.locator('.more').first().click();
  assert.equal(await page.locator('.below:visible').count(), tickets[first].events.length - 1);
  await page.locator('#rows tr a').nth(1).click();
  await clipReady();
  assert.equal(await page.evaluate(() => spherechainViewer.frame), tickets[0].worst.frame);
});

test('by clips it is a table that sorts and filters', async () => {
  await open();
  await page.getByRole('link', { name: 'Clips' }).click();
  assert.match((await rows())[0], /Boxing_Toes\.bvh/); // the deepest first
  await page.getByRole('button', { name: 'Clip', exact: true }).click();
  assert.match((await rows())[0], /01_03\.bvh/);
  await page.locator('#filter').fill('boxing');
  assert.equal((await rows()).length, 1);
  await page.locator('#filter').fill('no such part');
  assert.ok(await page.locator('#none').isVisible());
  await page.locator('#filter').fill('');
  await page.waitForFunction(() => {
    const strip = document.querySelector('[data-strip]');
    const blank = Object.assign(document.createElement('canvas'), { width: strip.width, height: strip.height });
    return document.querySelector('#rows img').naturalWidth > 0 && strip.toDataURL() !== blank.toDataURL();
  });
});

test('a click opens a clip at its worst event, in 3D', async () => {
  await open(`${url('index.html')}#clips`);
  await page.getByRole('link', { name: 'Boxing_Toes.bvh' }).click();
  await clipReady();
  const list = faults(boxing());
  assert.equal(await page.locator('.event').count(), list.length);
  const badness = (event) => 1e6 * rank(event) + event.depth_mm;
  const worst = list.reduce((a, b) => (badness(b) > badness(a) ? b : a));
  assert.equal(await page.evaluate(() => spherechainViewer.frame), worst.deepest);
  assert.match(await chosen(), new RegExp(`${Math.round(worst.depth_mm)} mm`));
  const shown = await page.evaluate(() => spherechainViewer.contacts()[0]);
  assert.ok(Math.abs(shown.depth - worst.depth_mm) < 0.1 && shown.triangles.length > 0);
  const camera = await page.evaluate(() => spherechainViewer.camera());
  const apart = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
  assert.ok(apart(camera.back, worst.camera.back) < 1e-3);
  assert.ok(apart(camera.target, worst.camera.target) < 1e-3 * apart(camera.target, [0, 0, 0]));
});

test('an event in 3D has the base colours of the file, and the spheres with their verdict', async () => {
  const coloured = await picture(page);
  const change = async () => compare(coloured, await picture(page));
  await page.keyboard.press('x');
  assert.ok((await change()) > 0.03);
  await page.keyboard.press('x');
  assert.ok((await change()) < 0.01);
  assert.match(await page.locator('#verdict').innerText(), /fit: (good|fair|poor)/);
  await page.keyboard.press('b');
  assert.ok((await change()) > 0.1);
  await page.keyboard.press('b');
  assert.ok((await change()) < 0.01);
  await page.locator('#spheres-button').click();
  assert.match(await page.locator('#spheres-button').innerText(), /Hide/);
});

test('the skin moves with the recording', async () => {
  await page.keyboard.press('r'); // without paint on contacts
  await page.getByLabel('Hold the character in place').uncheck(); // else the camera goes with it
  const atEvent = await picture(page);
  await page.evaluate(() => spherechainViewer.setFrame(0));
  assert.ok(compare(atEvent, await picture(page)) > 0.02);
});

test('N and P go through the events, over clips, and the address is a link', async () => {
  const events = json.clips.flatMap((clip) => faults(clip).map((event, i) => ({ clip: clip.clip, event, i })));
  await page.goto('about:blank');
  await page.goto(`${url('clip.html')}#${new URLSearchParams({ character: 'human.zae', clip: events[0].clip, event: '0' })}`);
  await clipReady();
  for (const { clip, event } of events.slice(1, 5)) {
    await page.keyboard.press('n');
    await page.waitForFunction((frame) => window.spherechainViewer?.ready && spherechainViewer.frame === frame, event.deepest);
    assert.equal(new URLSearchParams(new URL(page.url()).hash.slice(1)).get('clip'), clip);
  }
  await page.keyboard.press('p');
  await page.waitForFunction((frame) => window.spherechainViewer?.ready && spherechainViewer.frame === frame, events[3].event.deepest);
});

test('what is accepted in the page is accepted by the next check', async () => {
  await page.goto('about:blank');
  await page.goto(`${url('clip.html')}#${new URLSearchParams({ character: 'human.zae', clip: 'Boxing_Toes.bvh', event: '1' })}`);
  await clipReady();
  await page.keyboard.press('a');
  assert.match(await chosen(), /accepted/);
  await open();
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#export').click()]);
  await download.saveAs(join(out, 'baseline.json'));
  const again = check('--baseline', join(out, 'baseline.json'), '--fail-on', 'new');
  const states = again.clips.flatMap((clip) => faults(clip).map(({ state }) => state));
  assert.equal(states.filter((state) => state === 'accepted').length, 1);
  assert.equal(states.filter((state) => state === 'known').length, states.length - 1);
  assert.equal(again.summary.fails, false);
});

test("a character's heat map shows where its faults are", async () => {
  await open();
  await page.getByRole('link', { name: 'human.zae' }).first().click();
  await clipReady();
  const deep = await picture(page);
  await page.getByRole('button', { name: 'How often' }).click();
  assert.ok(compare(deep, await picture(page)) > 0);
  assert.match(await page.locator('#events').innerText(), /% of frames/);
});

test('a thousand clips open within two seconds', async () => {
  const text = readFileSync(join(folder, 'library.js'), 'utf8');
  const library = JSON.parse(text.slice(text.indexOf('{'), text.lastIndexOf('}') + 1));
  library.rows = Array.from({ length: 1000 }, (_, i) => ({ ...library.rows[i % 2], clip: `clip ${i}` }));
  mkdirSync(join(folder, 'data/many'), { recursive: true });
  writeFileSync(join(folder, 'data/many/library.js'), `spherechain.library = ${JSON.stringify(library)};`);
  const html = readFileSync(join(folder, 'index.html'), 'utf8').replace('src="library.js"', 'src="data/many/library.js"');
  writeFileSync(join(folder, 'many.html'), html);
  const start = performance.now();
  await open(`${url('many.html')}#clips`);
  await page.locator('#rows img').first().waitFor();
  const seconds = (performance.now() - start) / 1000;
  const end = performance.now() + 20000;
  while ((await page.locator('#rows tr').count()) < 1000 && performance.now() < end) {
    await page.evaluate(() => document.querySelector('main').scrollTo(0, 1e6));
    await page.waitForTimeout(20);
  }
  assert.equal(await page.locator('#rows tr').count(), 1000);
  assert.ok(seconds < 2, `${seconds} s`);
  console.log(`1,000 clips: ${seconds.toFixed(2)} s`);
});

test('a page says what is missing, and all others write nothing to the console', async () => {
  assert.deepEqual(noise, []);
  await page.goto('about:blank');
  await page.goto(`${url('clip.html')}#clip=nowhere`);
  await page.getByText('This report has no such clip.').waitFor();
});
