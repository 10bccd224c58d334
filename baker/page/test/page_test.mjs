// The page of `spherechain view`, in headless Chromium: node main.mjs, with what the environment says (CMakeLists.txt).
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import { before, test } from 'node:test';
import { compare, launch, open, picture, silent } from './browser.mjs';
import { base64, makePages, unpack } from './pages.mjs';

const { SPHERECHAIN_TOOL: tool, SPHERECHAIN_PAGE: template, SPHERECHAIN_HUMAN: human } = process.env;
const { SPHERECHAIN_HUESITOS: huesitos, SPHERECHAIN_POSES: poses, SPHERECHAIN_CHROMIUM: chromium, SPHERECHAIN_OUT: folder } = process.env;

let pages;
let browser;
let arms; // opened once: most tests only look at it, and reset it first
let other; // shows one other page after another: to open each beside takes twice as long
before(async () => {
  pages = makePages({ tool, human, huesitos, poses, folder });
  browser = await launch(chromium);
  arms = await open(browser, pages.arms);
  other = await open(browser, pages.two);
});

const TOUCHING = 8; // a frame with contacts
const frame = (page) => page.evaluate(() => spherechainViewer.frame);
const goTo = (page, number) => page.evaluate((n) => spherechainViewer.setFrame(n), number);
const contacts = (page) => page.evaluate(() => spherechainViewer.contacts());
const isFault = ({ kind }) => kind >= 4;
// `play` lists the parts of triangles by their numbers; the page names the part that goes in first.
const inAnyOrder = (name) => name.split(', ').sort().join(', ');
// For what a click does, not whether the mouse gets there: Playwright waits for two pictures before each of its clicks.
const click = (page, ...ids) =>
  page.evaluate((all) => {
    for (const id of all) document.getElementById(id).click();
    return new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  }, ids);
// For what keys do, not whether they get there: one picture for all of them.
const press = (page, ...keys) =>
  page.evaluate((all) => {
    for (const key of all) document.body.dispatchEvent(new KeyboardEvent('keydown', { key, bubbles: true }));
    return new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  }, keys);
const away = (page) => page.mouse.move(1270, 40);
// Another page, in a window of the same size or of its own.
async function shown(file, { width = 1280, height = 720 } = {}) {
  await other.page.setViewportSize({ width, height });
  await other.show(file);
  return other;
}
async function fresh() {
  const { page } = arms;
  await away(page);
  await page.keyboard.press('Escape');
  await click(page, 'reset', 'tab-contacts');
  await goTo(page, 0);
  return page;
}

test('a page of two has the contacts of each, and those between them', async () => {
  const two = other; // shows it from the start
  const count = pages.inspect.source.triangles;
  await goTo(two.page, 5);
  const listed = await contacts(two.page);
  const own = (who) => listed.filter(({ name }) => !name.includes(`${who === 'first' ? 'second' : 'first'}:`));
  const triangles = (lists) => [...new Set(lists.flat())].sort((a, b) => a - b);
  const alone = triangles(pages.play[3 * 5].skin.triangles); // a third as many frames
  assert.deepEqual(triangles(own('first').map((contact) => contact.triangles)), alone);
  assert.deepEqual(triangles(own('second').map((contact) => contact.triangles)), alone.map((t) => t + count));
  const between = listed.filter((contact) => !own('first').includes(contact) && !own('second').includes(contact));
  assert.ok(between.length > 0);
  assert.ok(between.every(({ triangles: of, depth }) => depth > 0 && of.some((t) => t < count) && of.some((t) => t >= count)));
  assert.equal(await two.page.locator('#tab-bake').count(), 0);
  silent(two);
});

test('a page of before and after opens at the deepest fault before, and lays one over the other', async () => {
  const fixed = await shown(pages.fixed);
  const { page } = fixed;
  const penetrations = (who) => contacts(page).then((list) => list.filter(({ name, kind }) => kind >= 5 && name.startsWith(who)));
  const own = await frame(page);
  const [{ depth: deepest }] = await penetrations('before');
  assert.deepEqual(await penetrations('after'), []);
  // At once: nothing is drawn.
  const all = await page.evaluate(() => Array.from({ length: 40 }, (_, i) => (spherechainViewer.setFrame(i), spherechainViewer.contacts())).flat());
  for (const { name, kind, depth } of all) assert.ok(kind < 5 || !name.startsWith('before') || depth <= deepest);
  await goTo(page, own);
  const beside = await picture(page);
  await page.keyboard.press('o');
  assert.equal(await page.locator('[data-showing=ghost]').getAttribute('aria-pressed'), 'true');
  assert.ok(compare(beside, await picture(page)) > 0.02);
  await page.locator('[data-showing=beside]').click();
  const again = compare(beside, await picture(page));
  assert.ok(again < 0.01, `${again}`);
  silent(fixed);
  // With no contact in it, all that the picture loses with the old pose's parts is the ghost.
  const quiet = await shown(pages.variant('ghost.html', (data) => (data.frames.contacts = data.frames.penetrations = { counts: '', entries: '' }), 'fixed/clip_0.html'));
  await goTo(quiet.page, own);
  await quiet.page.keyboard.press('o');
  const ghost = await picture(quiet.page);
  for (const part of await quiet.page.locator('.part').all()) if ((await part.innerText()).startsWith('before')) await part.click();
  const differing = compare(ghost, await picture(quiet.page));
  assert.ok(differing > 0.0005 && differing < 0.2, `${differing}`);
  assert.equal(await arms.page.locator('[data-showing]').count(), 0);
});

test('before and after stand apart, from whichever side they are seen', async () => {
  const { page } = await shown(pages.fixed);
  const parts = (who) => page.evaluate((start) => [...document.querySelectorAll('.part')].filter(({ innerText }) => innerText.startsWith(start)).forEach((button) => button.click()), who);
  await press(page, 'r');
  await page.locator('#show-paint').uncheck();
  for (const view of ['1', '2']) {
    await press(page, view);
    await parts('before');
    const after = await picture(page);
    await parts('after');
    const empty = await picture(page);
    await parts('before');
    const before = await picture(page);
    await parts('after');
    const isIn = (picture, i) => [0, 1, 2].some((k) => Math.abs(picture[i + k] - empty[i + k]) > 12);
    const shares = [0, 0, 0];
    for (let i = 0; i < empty.length; i += 4) [isIn(before, i), isIn(after, i), isIn(before, i) && isIn(after, i)].forEach((is, k) => (shares[k] += is ? 4 / empty.length : 0));
    assert.ok(shares[0] > 0.005 && shares[1] > 0.005 && shares[2] < 0.0005, `view ${view}: ${shares}`);
  }
});

test('an event before and after plays in a loop, is refused, and `fix --decisions` takes the file that the page saves', async () => {
  const { page } = await shown(pages.fixed);
  const [event] = pages.decide().events;
  assert.equal(await page.locator('.event').count(), 1);
  assert.match(await page.locator('.event').innerText(), new RegExp(`${event.parts.join(', ')}[^]*${event.acting.verdict.replace('changes_pose', 'changes the pose')}[^]*${event.outcome}`));
  await page.keyboard.press('n');
  assert.equal(await page.locator('[data-showing=ghost]').getAttribute('aria-pressed'), 'true');
  assert.match(await page.locator('.event-details').innerText(), new RegExp(`Moves ${Object.keys(event.acting.moves_mm)[0]}`));
  const ghost = await picture(page);
  await page.keyboard.press('c');
  const old = await picture(page);
  await page.keyboard.press('c');
  assert.equal(await page.locator('[data-showing=after]').getAttribute('aria-pressed'), 'true');
  assert.ok(compare(old, await picture(page)) > 0.005);
  assert.ok(compare(old, ghost) > 0.005);
  const numbers = await page.evaluate(async () => {
    const seen = new Set();
    document.body.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true }));
    for (const end = performance.now() + 1500; performance.now() < end; ) {
      await new Promise((done) => setTimeout(done, 20));
      seen.add(spherechainViewer.frame);
    }
    document.body.dispatchEvent(new KeyboardEvent('keydown', { key: ' ', bubbles: true }));
    return [...seen];
  });
  assert.ok(numbers.length > 2 && numbers.every((number) => number >= event.acting.from && number <= event.acting.to), `${numbers}`);
  await page.keyboard.press('r');
  assert.equal(await page.locator('.event.refused').count(), 1);
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#save-decisions').click()]);
  await download.saveAs(pages.decisions);
  const decided = pages.decide('--decisions', pages.decisions);
  assert.equal(decided.events[0].outcome, 'refused');
  assert.equal(decided.events[0].depth_mm_after, event.depth_mm_before);
  // The page of that says what was decided, and can take it back.
  const again = await shown(pages.fixed);
  assert.equal(await again.page.locator('.event.refused').count(), 1);
  await again.page.keyboard.press('n');
  await again.page.keyboard.press('a');
  assert.equal(await again.page.locator('.event.refused').count(), 0);
});

test('a page of --respond shows corrected poses and their contacts, with the pose as animated as a ghost', async () => {
  const { page: file, frames, response } = pages.responded;
  assert.ok(response.faulty_before > response.faulty_after, JSON.stringify(response));
  const [bones, animated] = ['bones', 'animated'].map((key) => unpack(readData(file).motion[key], Float32Array));
  const size = bones.length / frames.length;
  const turned = frames.map((_, i) => Math.max(...bones.subarray(i * size, (i + 1) * size).map((x, k) => Math.abs(x - animated[i * size + k]))));
  const most = turned.indexOf(Math.max(...turned));
  const opened = await shown(file);
  const { page } = opened;
  const row = (name, depth) => `${inAnyOrder(name)}: ${depth.toFixed(1)}`;
  for (const number of [0, 19, most]) {
    await goTo(page, number);
    const measured = frames[number].penetrations.map(({ parts: [a, b], depth_mm: depth }) => row(a === b ? `${a} with itself` : `${a}, ${b}`, depth));
    assert.deepEqual((await contacts(page)).map(({ name, depth }) => row(name, depth)).sort(), measured.sort());
  }
  const { frames: all, faulty_before: before, faulty_after: after } = response;
  assert.match(await page.locator('#response').innerText(), new RegExp(`${before} of ${all} frames had a fault of an arm, ${after} ha`));
  const both = await picture(page);
  await press(page, 'o');
  const differing = compare(both, await picture(page));
  assert.ok(differing > 0.0005 && differing < 0.1, `${differing}`);
  assert.ok(!(await page.locator('#show-ghost').isChecked()));
  await press(page, 'o');
  const back = compare(both, await picture(page));
  assert.ok(back < differing / 10, `${back}`);
  silent(opened);
  assert.equal(await arms.page.locator('#show-ghost').count(), 0);
});

test('the page is one file of less than 6 MB', () => {
  assert.ok(statSync(pages.arms).size < 6e6);
  assert.doesNotMatch(readFileSync(template, 'utf8'), /<(link|script|img)[^>]+(src|href)="(?!data:)/);
});

test('contacts are the triangles of the skin that play reports, with class and depth, faults first', async () => {
  const page = await fresh();
  assert.ok(pages.play[TOUCHING].skin.triangles.length > 0);
  for (const number of [0, TOUCHING, 19, 36, 39]) {
    await goTo(page, number);
    const listed = await contacts(page), crossing = listed.filter(({ pairs }) => pairs > 0);
    const triangles = (lists) => [...new Set(lists.flat())].sort((a, b) => a - b);
    assert.deepEqual(triangles(crossing.map((contact) => contact.triangles)), triangles(pages.play[number].skin.triangles));
    const { parts } = pages.play[number].skin;
    const partPair = ({ a, b }) => (a === b ? `${a} with itself` : `${a}, ${b}`);
    const row = (name, pairs) => `${name}: ${pairs}`;
    assert.deepEqual(crossing.map(({ name, pairs }) => row(inAnyOrder(name), pairs)).sort(), parts.map((part) => row(inAnyOrder(partPair(part)), part.triangle_pairs)).sort());
    const rows = await page.locator('.contact').allInnerTexts();
    assert.equal(rows.length, listed.length);
    const measured = pages.play[number].penetrations;
    listed.forEach(({ name, kind, depth }, i) => {
      const found = measured.find(({ parts: [a, b] }) => partPair({ a, b }) === name);
      assert.ok(Math.abs(depth - found.depth_mm) < 1e-3 * found.depth_mm + 1e-3, name);
      assert.ok(rows[i].includes(name) && /(as at rest|shell|hidden|touch|fold|penetration|(goes through, )?inside \d+ %), [0-9.]+ mm/.test(rows[i]), rows[i]);
      if (i > 0) assert.ok(kind < listed[i - 1].kind || (kind === listed[i - 1].kind && depth <= listed[i - 1].depth));
    });
    assert.equal(await page.locator('.readout .warning').count(), listed.some(isFault) ? 1 : 0);
  }
  // Totals of the whole clip, as `play` prints them: a fault counts the frames in which it is a fault.
  const said = new Map(await page.locator('.clip-contact').evaluateAll((all) => all.map((row) => ['.part-names', '.count'].map((part) => row.querySelector(part).textContent))).then((rows) => rows.map(([name, count]) => [inAnyOrder(name), count])));
  const { contacts: played } = pages.clip;
  assert.equal(said.size, played.length);
  for (const { a, b, class: kind, frames, fault_frames: faults, frame_of_depth_max: deepest } of played) {
    const runs = (faults.length > 0 ? faults : frames).map(([from, to]) => (from === to ? `${from}` : `${from}–${to}`)).join(', ');
    assert.match(said.get(inAnyOrder(`${a}, ${b}`)), new RegExp(`^(goes through, )?${kind.replace('_', ' ')}(| \\d+ %), [0-9.]+ mm at ${deepest}; frames? ${runs}$`));
  }
  assert.ok(played.some(({ frames, fault_frames: faults }) => faults.length > 0 && `${frames}` !== `${faults}`));
});

test('D goes to the deepest frame of the clip', async () => {
  const page = await fresh();
  await page.keyboard.press('d');
  const rank = ({ class: kind }) => ['deep_fold', 'penetration', 'inside'].indexOf(kind);
  const deepest = pages.play.map(({ penetrations }) => Math.max(0, ...penetrations.filter((one) => rank(one) >= 0).map((one) => 1e6 * rank(one) + one.depth_mm)));
  assert.equal(await frame(page), deepest.indexOf(Math.max(...deepest)));
});

test('contacts are marked in the picture, and nothing else is red', async () => {
  const page = await fresh();
  const quiet = await shown(pages.variant('quiet.html', (data) => (data.frames.contacts = data.frames.penetrations = { counts: '', entries: '' })));
  for (const [number, least, most] of [[0, 0, 0], [TOUCHING, 0.0005, 0.02]]) {
    await goTo(page, number);
    await goTo(quiet.page, number);
    const differing = compare(await picture(quiet.page), await picture(page));
    assert.ok(differing >= least && differing <= most, `${differing} of the picture tells of contacts in frame ${number}`);
  }
  silent(quiet);
});

test('a click on a contact flies to where it is seen', async () => {
  const page = await fresh();
  await goTo(page, TOUCHING);
  const far = await picture(page);
  await page.locator('.contact').first().click();
  assert.equal(await page.locator('.contact').first().getAttribute('aria-pressed'), 'true');
  const near = await picture(page);
  assert.ok(compare(far, near) > 0.1);
  const change = async () => compare(near, await picture(page));
  await page.keyboard.press('h');
  assert.ok((await change()) > 0.01, 'what is behind the skin goes');
  await page.keyboard.press('h');
  assert.ok((await change()) < 0.006);
  await page.locator('#reset').click();
  const entry = page.locator('.clip-contact').first();
  await entry.click();
  assert.equal(await frame(page), Number(await entry.getAttribute('data-frame')));
});

test('spheres are a layer, off at first, with their false alarms in another colour', async () => {
  const page = await fresh();
  await goTo(page, TOUCHING);
  const skin = await picture(page);
  const screen = () => page.locator('main').screenshot();
  const skinOnScreen = await screen();
  assert.ok(!(await page.locator('#show-spheres').isChecked()));
  await page.keyboard.press('b');
  assert.ok(compare(skin, await picture(page)) > 0.05);
  assert.notDeepEqual(await screen(), skinOnScreen, 'what the canvas holds is on the screen');
  await page.keyboard.press('m');
  await page.locator('#tab-spheres').click();
  const owner = unpack(readData(pages.arms).mesh.spheres, Uint16Array);
  const real = new Set(pages.play[TOUCHING].skin.triangles.map((pair) => pair.map((t) => owner[t]).sort((a, b) => a - b).join('-')));
  const counts = {};
  for (const radius of ['detect', 'fit']) {
    await page.locator(`#radius-${radius}`).click();
    const listed = await page.locator('#sphere-pairs .pair').evaluateAll((rows) =>
      rows.map((row) => [row.dataset.pair, row.classList.contains('false-alarm'), parseFloat(row.querySelector('.depth').textContent)]),
    );
    if (radius === 'detect') assert.deepEqual(listed.map(([pair]) => pair).sort(), pages.play[TOUCHING].pairs.map((p) => p.join('-')).sort());
    for (const [i, [pair, isFalse, depth]] of listed.entries()) {
      assert.equal(isFalse, !real.has(pair), pair);
      assert.ok(i === 0 || isFalse !== listed[i - 1][1] || depth <= listed[i - 1][2], 'the deepest first');
    }
    counts[radius] = listed.length;
  }
  assert.ok(counts.detect > counts.fit, JSON.stringify(counts));
});

const readData = (file) => JSON.parse(readFileSync(file, 'utf8').match(/id="spherechain-data" type="application\/json">([^<]*)</)[1]);

test('nobody meets the words of the method before asking for it', async () => {
  const page = await fresh();
  const words = /zeta|ζ|\bphi|M1|M2|chain|level|pivot|radius|\bfit\b|detect/i;
  const seen = async () => (await page.locator('body').innerText()).replace(/human\.sphc|spherechain [\d.]+/g, '');
  await page.locator('#tab-bake').click();
  assert.doesNotMatch(await seen(), words);
  await page.keyboard.press('m');
  assert.match(await seen(), words);
  for (const tab of ['spheres', 'charts', 'accuracy', 'bake']) await click(page, `tab-${tab}`);
  await page.keyboard.press('m');
  assert.doesNotMatch(await seen(), words);
});

test('each control changes the picture, and back', async () => {
  const page = await fresh();
  await page.keyboard.press('m');
  await goTo(page, TOUCHING);
  await away(page);
  const still = ['show-method', 'show-follow', 'show-spheres', 'show-hiddenContacts']; // the last: of it too little is seen from here
  const all = await page
    .locator('#controls :is(input[type=checkbox], button.part, button.chip)')
    .evaluateAll((controls, others) => controls.filter((one) => !one.matches('.part') || one.textContent === 'head').map(({ id }) => id).filter((id) => !others.includes(id)), still);
  // Sets of spheres need spheres, which take longest to draw.
  const ofSpheres = (id) => /^set-(?!zeta)/.test(id);
  const groups = [all.filter((id) => !ofSpheres(id)), all.filter(ofSpheres)];
  assert.ok(groups.every(({ length }) => length > 5));
  for (const ids of groups) {
    const states = () => page.evaluate((names) => names.map((id) => document.getElementById(id)).map((one) => one.checked ?? one.ariaPressed), ids);
    const plain = await picture(page);
    const before = await states();
    for (const [i, id] of ids.entries()) {
      await click(page, ...ids.slice(Math.max(i - 1, 0), i), id); // the last one is as before again
      const differing = compare(plain, await picture(page));
      assert.ok(differing > 0.0012, `${id}: ${differing} of the picture changed`);
    }
    await click(page, ...ids.slice(-1));
    assert.deepEqual(await states(), before);
    // The last bits of the eye's place decide what is seen of triangles that lie in one another.
    const differing = compare(plain, await picture(page));
    assert.ok(differing < 0.001, `${differing} of the picture is not as before`);
    if (ids === groups[0]) await page.keyboard.press('b');
  }
});

test('the space key plays and pauses wherever the focus is, and switches no box', async () => {
  const page = await fresh();
  for (const control of ['#show-skin', '[data-view=side]', '#frame']) {
    await page.locator(control).click();
    const was = await page.locator('#show-skin').isChecked();
    await page.keyboard.press(' ');
    await page.waitForFunction((from) => spherechainViewer.frame !== from, await frame(page));
    await page.keyboard.press(' ');
    const stopped = await frame(page);
    await page.waitForTimeout(150);
    assert.equal(await frame(page), stopped);
    assert.equal(await page.locator('#show-skin').isChecked(), was);
  }
  await page.locator('#show-skin').focus();
  const was = await page.locator('#show-skin').isChecked();
  await page.keyboard.press('Enter');
  assert.equal(await page.locator('#show-skin').isChecked(), !was);
});

test('keys step through frames, and the help lists them', async () => {
  const page = await fresh();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await frame(page), 1);
  await page.keyboard.press('End');
  assert.equal(await frame(page), 39);
  await page.keyboard.press('?');
  assert.ok((await page.locator('#help tbody tr').count()) >= 19);
  assert.match(await page.locator('#help tbody').innerText(), /Ctrl Z\s+Pose: undo/);
  await page.keyboard.press('Escape');
  assert.ok(!(await page.locator('#help').isVisible()));
});

// From a frame on the character is turned by 180 degrees.
function turnAround(data, first) {
  const bones = unpack(data.motion.bones, Float32Array);
  const { up } = data.axes;
  const turn = up.map((_, row) => up.map((_, column) => 2 * up[row] * up[column] - (row === column ? 1 : 0)));
  for (let at = (first * bones.length) / data.frames.count; at < bones.length; at += 12) {
    const bone = bones.slice(at, at + 12);
    for (let i = 0; i < 12; ++i) bones[at + i] = turn[Math.floor(i / 4)].reduce((sum, x, k) => sum + x * bone[4 * k + (i % 4)], 0);
  }
  data.motion.bones = base64(bones);
}
// All contacts are shells, the first of a frame is out of sight.
function hide({ frames: { penetrations } }) {
  const entries = unpack(penetrations.entries, Float32Array);
  const counts = unpack(penetrations.counts, Uint32Array), width = entries.length / counts.reduce((sum, count) => sum + count);
  let at = 0;
  for (const count of counts) {
    for (let i = 0; i < count; ++i, at += width) [entries[at + 2], entries[at + 10]] = [1, i === 0 ? 0.1 : 0.5];
  }
  penetrations.entries = base64(entries);
}

test('several clips: a list, a header that follows, frames of the clip, playing within it', async () => {
  const clips = [{ name: 'MyArmature|Walk', first: 0, count: 15, own_count: 15 }, { name: 'MyArmature|Run', first: 15, count: 25, own_count: 25 }];
  const opened = await shown(pages.variant('clips.html', (data) => {
    data.clips = clips;
    data.frames.numbers = base64(Float32Array.from({ length: 40 }, (_, i) => (i < 15 ? i : i - 15)));
    turnAround(data, 15);
    hide(data);
  }));
  const { page } = opened;
  const from = async () => {
    const { back } = await page.evaluate(() => spherechainViewer.camera());
    const { left, forward } = pages.inspect.frame;
    return [left, forward].map((axis) => Math.round(axis.reduce((sum, x, k) => sum + x * back[k], 0)) + 0);
  };
  assert.deepEqual(await from(), [0, 1]);
  await goTo(page, TOUCHING);
  const rows = await page.locator('.contact').allInnerTexts();
  assert.equal(rows.filter((text) => /hidden, /.test(text)).length, 1);
  assert.equal(rows.filter((text) => /shell, /.test(text)).length, rows.length - 1);
  assert.match(await page.locator('.contact', { hasText: 'hidden' }).getAttribute('title'), /cannot be seen from outside/);
  await page.locator('#clips').selectOption('1');
  assert.equal(await frame(page), 15);
  // The second clip's character has turned its back to where it stood.
  assert.deepEqual(await from(), [0, -1]);
  await page.keyboard.press('2');
  assert.deepEqual(await from(), [-1, 0]);
  await page.keyboard.press('f');
  await page.keyboard.press('3');
  assert.deepEqual(await from(), [0, 1]);
  assert.match(await page.locator('.readout').innerText(), /frame 0 \/ 24/);
  await page.keyboard.press('Escape');
  await goTo(page, 14);
  assert.match(await page.locator('#clips option:checked').innerText(), /^Walk · skin touches in \d+ of 15 frames/);
  assert.match(await page.locator('.readout').innerText(), /frame 14 \/ 14/);
  await page.locator('main').click({ position: { x: 5, y: 5 } });
  await page.keyboard.press(' ');
  await page.waitForFunction(() => spherechainViewer.frame < 5);
  await page.keyboard.press(' ');
  await page.locator('#one-clip').click();
  assert.equal(await page.locator('#frame').getAttribute('max'), '14');
  silent(opened);
  const link = (words) => page.evaluate((hash) => ((location.hash = hash), new Promise((done) => setTimeout(() => done(spherechainViewer.frame)))), words);
  assert.equal(await link(new URLSearchParams({ clip: 'MyArmature|Run', frame: '3' }).toString()), 18);
  assert.equal(await link('frame=7'), 7);
  assert.equal(await link('clip=none&frame=3'), 7);
});

test('morph targets move the skin', async () => {
  const moved = pages.variant('morphs.html', (data) => {
    const count = unpack(data.mesh.positions, Float32Array).length / 3;
    const deltas = new Float32Array(3 * count).map(() => data.axes.height / 4);
    const weights = Float32Array.from({ length: 40 }, (_, i) => i / 39);
    data.motion.morphs = [
      { name: 'away', vertices: base64(Uint32Array.from({ length: count }, (_, v) => v)), deltas: base64(deltas), weights: base64(weights) },
    ];
  });
  const opened = await shown(moved);
  const plain = await fresh();
  for (const [number, changes] of [[0, false], [39, true]]) {
    await goTo(plain, number);
    await goTo(opened.page, number);
    const differing = compare(await picture(plain), await picture(opened.page));
    assert.equal(differing > 0.02, changes, `frame ${number}: ${differing}`);
  }
  silent(opened);
});

test('a sphere under the pointer shows its figures', async () => {
  const page = await fresh();
  await page.keyboard.press('b');
  await page.keyboard.press('m');
  const box = await page.locator('main').boundingBox();
  const seen = new Set();
  for (const y of [0.3, 0.45, 0.6, 0.75]) {
    for (const x of [0.42, 0.46, 0.48, 0.52, 0.54, 0.58]) {
      if (seen.size >= 8) break; // each is a picture of all spheres
      await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
      const id = await page.evaluate(() => spherechainViewer.hovered());
      if (id === null || seen.has(id)) continue;
      seen.add(id);
      const text = await page.locator('[data-figure=radius]').innerText();
      const { radius, region } = pages.inspect.spheres[id];
      assert.ok(Math.abs(parseFloat(text) - radius) <= 6e-4 * radius, `sphere ${id}: ${text} is not ${radius}`);
      assert.ok((await page.locator('#sphere h2').innerText()).startsWith(`Sphere ${id}, ${region.replace('_', ' ')}`));
    }
  }
  assert.ok(seen.size >= 5, `${seen.size} spheres met`);
});

test('charts show what play measured, and a click on them seeks', async () => {
  const page = await fresh();
  await page.keyboard.press('m');
  await page.locator('#tab-charts').click();
  await page.locator('.chart canvas').waitFor();
  await goTo(page, 19);
  const shown = (await page.locator('.key output').allInnerTexts()).map((text) => Number(text.replace(',', '')));
  assert.equal(shown[1], pages.play[19].pairs.length);
  assert.ok(shown.every((value) => value > 0));
  const over = await page.locator('.chart .u-over').boundingBox();
  await page.mouse.click(over.x + (over.width * 10) / 39, over.y + over.height / 2);
  assert.equal(await frame(page), 10);
});

test('the worst misses lead to their frame, and the bake is shown whole', async () => {
  const page = await fresh();
  await page.keyboard.press('m');
  await page.locator('#tab-accuracy').click();
  const { validation } = pages;
  assert.ok((await page.locator('#accuracy').innerText()).includes(`${(100 * validation.all_pairs.pair_recall).toFixed(2)} %`));
  assert.equal(await page.locator('.miss').count(), validation.worst_misses.length);
  await page.locator('.miss').first().click();
  const distance = (number) => Math.abs(pages.play[number].time - validation.worst_misses[0].time);
  const shown = await frame(page);
  assert.ok(pages.play.every((_, number) => distance(shown) <= distance(number)));
  await page.locator('#tab-bake').click();
  const text = await page.locator('#bake').innerText();
  for (const part of [pages.inspect.source.sha256, pages.inspect.writer, pages.report.counts.why]) assert.ok(text.includes(part), part);
  const settings = await page.locator('#bake th[scope=row]').allTextContents();
  assert.ok(settings.includes('penetration depth'));
  for (const name of ['rays', 'delta', 'limb step', 'spheres per level']) assert.ok(!settings.includes(name), name);
});

test('view refuses what is about another asset, or not whole, and writes no page', () => {
  for (const [option, file, change] of [
    ['--report', 'report.json', (data) => (data.source.sha256 = 'f'.repeat(64))],
    ['--validation', 'validation.json', (data) => (data.worst_misses = [{ spheres: [0, 99999] }])],
  ]) {
    const { code, error, written } = pages.view(option, file, change);
    assert.equal(code, 3, error);
    assert.match(error, /^spherechain: error: .*changed[.]json: .*\n$/);
    assert.ok(!written);
  }
});

// Opened on a telephone, in a window that then grows.
const SIZES = [[390, 844], [800, 600], [820, 1180], [1440, 900]];
let sized = null;
for (const [width, height] of SIZES) {
  test(`all is in place at ${width} x ${height}`, async () => {
    sized ??= await open(browser, pages.arms, { width, height });
    const { page } = sized;
    await page.setViewportSize({ width, height });
    await page.emulateMedia({ colorScheme: width === 800 ? 'dark' : 'light' });
    await page.locator('#reset').click();
    await goTo(page, TOUCHING);
    const isDrawer = width < 1100 && width > 640;
    if (isDrawer) await page.locator('#show').click();
    await page.locator('#show-method').click();
    for (const tab of ['contacts', 'spheres', 'charts', 'accuracy', 'bake']) {
      await page.locator(`#tab-${tab}`).click();
      const parts = page.locator('body, header, main, #timeline, #results, #controls, [role=tabpanel]:not([hidden]), [role=tablist], .chip, .pair');
      const wide = () =>
        parts.evaluateAll((all) => all.filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => part.id || part.className));
      // Charts fit themselves to a new size in the frame after it.
      for (let wait = 0; wait < 20 && (await wide()).length > 0; ++wait) await page.waitForTimeout(50);
      assert.deepEqual(await wide(), [], `wider than its place, ${tab}`);
    }
    const main = await page.locator('main').boundingBox();
    const results = await page.locator('#results').boundingBox();
    assert.ok(main.y < 60 && main.height >= 0.5 * height && main.width >= Math.min(380, width), 'the picture comes first');
    assert.ok(results.y >= main.y + main.height || results.x >= main.x + main.width);
    for (const button of await page.locator('#views button').all()) {
      const box = await button.boundingBox();
      assert.ok(box.x >= main.x && box.x + box.width <= main.x + main.width, 'no view is cut off');
    }
    if (isDrawer) await page.locator('#show').click();
    silent(sized);
  });
}

test('every control has a name', async () => {
  const page = await fresh();
  const nameless = await page
    .locator('button, input, select, canvas:not([aria-hidden]), [role=tabpanel], aside')
    .evaluateAll((all) =>
      all
        .filter((e) => !(e.ariaLabel || e.getAttribute('aria-labelledby') || e.labels?.[0]?.textContent || (e.tagName === 'BUTTON' && e.textContent)))
        .filter((e) => !e.closest('.uplot'))
        .map((e) => e.outerHTML.slice(0, 80)),
    );
  assert.deepEqual(nameless, []);
});

test('a page without WebGL says so and still lists contacts', async () => {
  const init = () => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind === '2d' ? getContext.call(this, kind, ...rest) : null;
    };
  };
  const opened = await open(browser, pages.arms, { init });
  assert.ok(await opened.page.locator('#no-webgl').isVisible());
  await goTo(opened.page, TOUCHING);
  assert.ok((await opened.page.locator('.contact').count()) > 0);
  silent(opened);
  await opened.close();
});

test('the page of a mask has layers in colours, a switch for hidden triangles, and their number', async () => {
  const all = pages.inspect.source.triangles;
  const hidden = Math.floor(all / 3);
  const layers = Uint8Array.from({ length: all }, (_, t) => (t < hidden ? 2 : t < 2 * hidden ? 1 : 0));
  const opened = await shown(pages.variant('mask.html', (data) => {
    delete data.spheres;
    Object.assign(data.inspect, { spheres: [], chains: [], regions: [] });
    Object.assign(data, { report: null, edits: null, rig: null });
    data.frames = { count: 0, fps: 30 };
    data.mask = { hidden, hidden_percent: 33.3, area_percent: 25.26, layers: base64(layers) };
  }, 'rest.html'));
  const { page } = opened;
  assert.equal(
    await page.locator('#mask-summary').innerText(),
    `${hidden.toLocaleString('en')} hidden triangles of ${all.toLocaleString('en')} (33.3 %), 25.3 % of the area`,
  );
  const coloured = await picture(page);
  await click(page, 'show-masked');
  assert.ok(compare(coloured, await picture(page)) > 0.001, 'hidden triangles are gone');
  await press(page, 'k');
  assert.equal(compare(coloured, await picture(page)), 0);
  await click(page, 'show-layers');
  assert.ok(compare(coloured, await picture(page)) > 0.01, 'the layers have no colours');
  await press(page, '0');
  const row = page.locator('[data-mesh]').first();
  await row.click();
  assert.equal(await row.getAttribute('aria-pressed'), 'true');
  assert.equal(await page.locator('.part[aria-pressed=true]').count(), 1);
  silent(opened);
});

const still = (data) => {
  data.frames = { count: 0, fps: 30 };
  data.motion = {};
  data.clips = [];
};
const odd = {
  'the rest pose only, without a report': () => pages.rest,
  'no frames at all': () => pages.variant('no_frames.html', still),
  'no skin weights': () => pages.variant('no_skin.html', (data) => Object.assign(data.mesh, { influences: 0, joints: '', weights: '' })),
  'no spheres, no chains and no parts': () =>
    pages.variant('no_spheres.html', (data) => {
      still(data);
      Object.assign(data.inspect, { spheres: [], chains: [], sphere_count: 0 });
      Object.assign(data, { spheres: [], report: null, parts: [] });
    }),
  'frames of vertices': () =>
    pages.variant('vertices.html', (data) => {
      const rest = Buffer.from(data.mesh.positions, 'base64');
      data.motion.vertices = Buffer.concat(Array(4).fill(rest)).toString('base64');
      data.frames.count = 4;
      data.clips = [{ ...data.clips[0], count: 4, own_count: 4 }];
    }),
};
for (const [what, make] of Object.entries(odd)) {
  test(`the page lives with ${what}`, async () => {
    const opened = await shown(make(), { width: 1010, height: 400 });
    const { page } = opened;
    await page.keyboard.press('m');
    for (const tab of ['spheres', 'charts', 'accuracy', 'bake', 'contacts']) await click(page, `tab-${tab}`);
    for (const keys of [['b', 'End', 'p', 'n', 'c', 'u'], [' '], [' ', '2'], ['1', 'b']]) await press(page, ...keys);
    const before = await picture(page);
    await page.keyboard.press('s');
    assert.ok(compare(before, await picture(page)) > 0.001, 'skin is drawn');
    silent(opened);
  });
}

test('the template says that it is one', async () => {
  const opened = await shown(template);
  assert.match(await opened.page.locator('body').innerText(), /template/);
  silent(opened);
});

test('nothing was written to the console in all this, and nothing asked for', () => silent(arms));
