// The page of `spherechain view`, in headless Chromium: node page_test.mjs, with what the environment says (CMakeLists.txt).
import assert from 'node:assert/strict';
import { readFileSync, statSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { compare, launch, open, picture, silent } from './browser.mjs';
import { base64, makeHuge, makePages } from './pages.mjs';

const { SPHERECHAIN_TOOL: tool, SPHERECHAIN_PAGE: template, SPHERECHAIN_HUMAN: human } = process.env;
const { SPHERECHAIN_POSES: poses, SPHERECHAIN_CHROMIUM: chromium, SPHERECHAIN_OUT: folder } = process.env;

let pages;
let browser;
let arms; // opened once: most tests only look at it, and reset it first
before(async () => {
  pages = makePages({ tool, human, poses, folder });
  browser = await launch(chromium);
  arms = await open(browser, pages.arms.page);
});
after(() => browser?.close());

const listed = (page) => page.locator('.pair').evaluateAll((rows) => rows.map((row) => row.dataset.pair.split('-').map(Number)));
const scrub = (page, frame) => page.locator('#frame').fill(`${frame}`);
async function fresh() {
  const { page } = arms;
  await page.mouse.move(1270, 40);
  await page.keyboard.press('Escape');
  await page.locator('#reset').click();
  await page.locator('#tab-contacts').click();
  await scrub(page, 0);
  return page;
}

test('the page is one file of less than 6 MB', () => {
  assert.ok(statSync(pages.arms.page).size < 6e6);
  assert.doesNotMatch(readFileSync(template, 'utf8'), /<(link|script|img)[^>]+(src|href)="(?!data:)/);
});

test('the canvas shows the character', async () => {
  const page = await fresh();
  const shown = await picture(page);
  await page.keyboard.press('s');
  await page.keyboard.press('b');
  const empty = await picture(page);
  const { differing } = await compare(page, empty, shown);
  assert.ok(differing > 0.08 && differing < 0.6, `the character covers ${differing} of the picture`);
});

for (const motion of ['arms', 'legs']) {
  test(`scrubbing lists the pairs that play reports (${motion})`, async () => {
    const opened = motion === 'arms' ? arms : await open(browser, pages.legs.page);
    const { page } = opened;
    const { play } = pages[motion];
    assert.ok(play.some(({ pairs }) => pairs.length > 4));
    for (const frame of [0, 4, 8, 19, 20, 25, 33, 39]) {
      await scrub(page, frame);
      const hook = await page.evaluate(() => [spherechainViewer.frame, spherechainViewer.pairs()]);
      assert.deepEqual(hook, [frame, play[frame].pairs]);
      assert.deepEqual(await listed(page), play[frame].pairs, `frame ${frame}`);
      const depths = await page.locator('.depth').allInnerTexts();
      assert.ok(depths.every((depth) => parseFloat(depth) >= 0), `what touches is not apart: ${depths}`);
    }
    silent(opened);
    if (motion === 'legs') await opened.close();
  });
}

test('each toggle changes the picture, and back', async () => {
  const page = await fresh();
  const plain = await picture(page);
  const ids = await page
    .locator('#controls :is(input[type=checkbox], button.region, button.chip)')
    .evaluateAll((controls) => controls.map((control) => control.id));
  assert.equal(ids.length, 5 + 5 + 6 + 4 + 4);
  for (const id of ids) {
    await page.locator(`#${id}`).click();
    await page.mouse.move(1270, 40);
    const changed = await compare(page, plain, await picture(page));
    assert.ok(changed.differing > 0.001, `${id}: ${changed.differing} of the picture changed`);
    await page.locator(`#${id}`).evaluate((control) => control.click());
    await page.mouse.move(1270, 40);
    assert.equal((await compare(page, plain, await picture(page))).differing, 0, `${id} twice: as before`);
  }
  for (const id of ['slide-skinOpacity', 'slide-sphereOpacity']) {
    await page.locator(`#${id}`).fill('100');
    // At the detect radius the spheres hide most of the skin.
    assert.ok((await compare(page, plain, await picture(page))).differing > 0.004, id);
    await page.locator('#reset').click();
  }
  await page.locator('#radius-fit').click();
  assert.ok((await compare(page, plain, await picture(page))).differing > 0.01, 'radius');
});

test('contacts are marked in the picture', async () => {
  const page = await fresh();
  // The same pose with its contacts taken out of the data.
  const variant = pages.variant('no_pairs.html', (data) => data.frames.play.forEach((frame) => (frame.pairs = [])));
  const quiet = await open(browser, variant);
  await scrub(page, 19);
  await scrub(quiet.page, 19);
  const { differing } = await compare(page, await picture(quiet.page), await picture(page));
  assert.ok(differing > 0.02, `${differing} of the picture tells of contacts`);
  silent(quiet);
  await quiet.close();
});

test('a sphere under the pointer shows its figures and its surrounding region', async () => {
  const page = await fresh();
  const box = await page.locator('main').boundingBox();
  const seen = new Set();
  const rows = [0.3, 0.36, 0.45, 0.6, 0.75];
  const points = rows.flatMap((y) => [0.38, 0.42, 0.45, 0.48, 0.52, 0.55, 0.58, 0.62].map((x) => [x, y]));
  for (const [x, y] of points) {
    await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
    const id = await page.evaluate(() => spherechainViewer.hovered());
    if (id === null || seen.has(id)) continue;
    seen.add(id);
    const sphere = pages.inspect.spheres[id];
    const figure = async (key) => (await page.locator(`[data-figure="${key}"]`).innerText()).replace(/(\d),(\d)/, '$1$2').split(/[ ,]/)[0];
    const near = (text, value) => assert.ok(Math.abs(Number(text) - value) <= 6e-4 * value, `sphere ${id}: ${text} is not ${value}`);
    near(await figure('radius'), sphere.radius);
    near(await figure('fit-now'), sphere.radius);
    near(await figure('detect-now'), sphere.detect_radius);
    near(await figure('triangles'), sphere.triangles);
    assert.match(await page.locator('#sphere h2').innerText(), new RegExp(`Sphere ${id}, ${sphere.region.replace('_', ' ')}`));
    // Seen from the front, the character's left is to the right.
    const [side] = sphere.side === 'none' ? sphere.region.split('_') : [sphere.side];
    if (Math.abs(x - 0.5) > 0.03) assert.equal(side, x > 0.5 ? 'left' : 'right');
  }
  assert.ok(seen.size >= 10, `${seen.size} spheres met`);
  // PD of a limb's neighbours is what the bake aims at.
  await page.mouse.move(box.x + 0.555 * box.width, box.y + 0.7 * box.height);
  for (const share of await page.locator('.neighbours .count').allInnerTexts()) assert.ok(Math.abs(share - 0.3) < 0.05, share);
  // A click keeps it; with the spheres away, its surrounding region stands out (its name alone is a quarter of a percent).
  await page.mouse.click(box.x + 0.52 * box.width, box.y + 0.36 * box.height);
  const kept = await page.evaluate(() => spherechainViewer.hovered());
  await page.mouse.move(1270, 40);
  assert.equal(await page.evaluate(() => spherechainViewer.hovered()), kept);
  await page.keyboard.press('b');
  const marked = await picture(page);
  await page.keyboard.press('Escape');
  assert.ok((await compare(page, marked, await picture(page))).differing > 0.006);
});

test('a click on a pair flies there', async () => {
  const page = await fresh();
  await scrub(page, 20);
  const far = await picture(page);
  await page.locator('.pair').first().click();
  assert.equal(await page.locator('.pair').first().getAttribute('aria-pressed'), 'true');
  assert.ok((await compare(page, far, await picture(page))).differing > 0.1);
});

test('keys do what the help says', async () => {
  const page = await fresh();
  const frame = () => page.evaluate(() => spherechainViewer.frame);
  await page.locator('main').click({ position: { x: 5, y: 5 } }); // away from the slider, which has such keys of its own
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('ArrowLeft');
  assert.equal(await frame(), 1);
  await page.keyboard.press('End');
  assert.equal(await frame(), 39);
  await page.keyboard.press('Home');
  assert.equal(await frame(), 0);

  await page.keyboard.press(' ');
  await page.waitForFunction(() => spherechainViewer.frame > 2);
  await page.keyboard.press(' ');
  const stopped = await frame();
  await page.waitForTimeout(150);
  assert.equal(await frame(), stopped);
  await scrub(page, 0);

  let last = await picture(page);
  for (const key of ['2', '3', '4', '1']) {
    await page.keyboard.press(key);
    const next = await picture(page);
    assert.ok((await compare(page, last, next)).differing > 0.05, `key ${key}`);
    last = next;
  }
  const shown = () => page.locator('#controls input[type=checkbox]').evaluateAll((boxes) => boxes.map((box) => box.checked));
  const marked = () => page.locator('.chip.chain[aria-pressed=true]').count();
  assert.deepEqual(await shown(), [true, true, false, false, false]);
  for (const key of ['s', 'b', 'u', 'p', 'n', 'c']) await page.keyboard.press(key);
  assert.deepEqual(await shown(), [false, false, true, true, true]);
  assert.equal(await marked(), 6);
  await page.keyboard.press('0');
  assert.deepEqual(await shown(), [true, true, false, false, false]);
  assert.equal(await marked(), 0);
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  assert.equal(await theme(), 'light');
  await page.keyboard.press('t');
  assert.equal(await theme(), 'dark');
  await page.keyboard.press('t');
  await page.keyboard.press('?');
  assert.ok(await page.locator('#help').isVisible());
  assert.ok((await page.locator('#help tbody tr').count()) >= 19);
  await page.keyboard.press('Escape');
  assert.ok(!(await page.locator('#help').isVisible()));
});

test('charts show what play measured, and a click on them seeks', async () => {
  const page = await fresh();
  await page.locator('#tab-charts').click();
  await page.locator('.chart canvas').nth(2).waitFor();
  await scrub(page, 19);
  const shown = (await page.locator('.key output').allInnerTexts()).map((text) => Number(text.replace(',', '')));
  const { m1, m2 } = pages.arms.play[19];
  assert.deepEqual(shown.slice(0, 4), [m1.tests, m2.tests, m1.pairs, m2.pairs]);
  assert.ok(shown.slice(4).every((us) => us > 0));
  const over = await page.locator('.chart .u-over').nth(1).boundingBox();
  await page.mouse.click(over.x + (over.width * 10) / 39, over.y + over.height / 2);
  assert.equal(await page.evaluate(() => spherechainViewer.frame), 10);
  const drawn = await page.locator('.chart canvas').evaluateAll((canvases) =>
    canvases.map((canvas) => {
      const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
      return data.some((_, i) => i % 4 === 0 && data[i + 3] > 200 && data[i + 2] - data[i] > 60);
    }),
  );
  assert.deepEqual(drawn, [true, true, true], 'the blue line of M1 is there');
});

test('the bake panel shows report and provenance', async () => {
  const page = await fresh();
  await page.locator('#tab-bake').click();
  const text = await page.locator('#bake').innerText();
  for (const part of [pages.inspect.source.sha256, pages.inspect.writer, pages.report.counts.why, `${pages.inspect.sphere_count}`]) {
    assert.ok(text.includes(part), part);
  }
  for (const summary of await page.locator('#bake summary').all()) await summary.click();
  assert.match(await page.locator('#bake').innerText(), /stage\s+seconds/);
});

test('the worst misses lead to their frame', async () => {
  const page = await fresh();
  await page.locator('#tab-accuracy').click();
  const { validation, play } = pages.arms;
  assert.ok(validation.worst_misses.length > 1);
  assert.ok((await page.locator('#accuracy').innerText()).includes(`${(100 * validation.m2.pair_recall).toFixed(2)} %`));
  const misses = page.locator('.miss');
  assert.equal(await misses.count(), validation.worst_misses.length);
  const far = await picture(page);
  for (const i of [1, 0]) {
    await misses.nth(i).click();
    const { time, spheres } = validation.worst_misses[i];
    const frame = await page.evaluate(() => spherechainViewer.frame);
    const away = (f) => Math.abs(play[f].time - time);
    assert.ok(play.every((_, f) => away(frame) <= away(f)), `frame ${frame} is nearest to ${time} s`);
    assert.match(await misses.nth(i).getAttribute('aria-label'), new RegExp(`^frame ${frame}: ${spheres[0]} .* and ${spheres[1]} `));
  }
  assert.ok((await compare(page, far, await picture(page))).differing > 0.05, 'flies there');
});

test('of what the skin reports it is said that nothing was missed', async () => {
  const skin = { skin: true, pair_recall: 1, precision: 1, reported_per_frame: 2.5, worst_misses: [] };
  const opened = await open(browser, pages.variant('skin.html', (data) => Object.assign(data.validation, skin)));
  await opened.page.locator('#tab-accuracy').click();
  const said = await opened.page.locator('#accuracy').innerText();
  assert.match(said, /skin\s+100[.0]* %\s+100[.0]* %\s+2[.]5/);
  assert.match(said, /Nothing was missed by the skin/);
  silent(opened);
  await opened.close();
});

test('view refuses what is about another asset, or not whole, and writes no page', () => {
  for (const [option, file, change] of [
    ['--report', 'report.json', (data) => (data.source.sha256 = 'f'.repeat(64))],
    ['--report', 'report.json', (data) => delete data.counts],
    ['--validation', 'validation.json', (data) => (data.settings_sha256 = 'f'.repeat(64))],
    ['--validation', 'validation.json', (data) => (data.worst_misses = [{ spheres: [0, 99999] }])],
  ]) {
    const { code, error, written } = pages.view(option, file, change);
    assert.equal(code, 3, error);
    assert.match(error, /^spherechain: error: .*changed[.]json: .*\n$/);
    assert.ok(!written);
  }
});

for (const [width, height] of [[1280, 720], [820, 1180]]) {
  test(`all is in place at ${width} x ${height}, light and dark`, async () => {
    const light = {};
    for (const scheme of ['light', 'dark']) {
      const opened = await open(browser, pages.arms.page, { width, height, scheme });
      const { page } = opened;
      await scrub(page, 19);
      const shot = await picture(page);
      light[scheme] = (await compare(page, shot, shot)).light;
      const boxes = await page.locator('body > :is(header, aside, main, section)').evaluateAll((parts) =>
        parts.map((part) => {
          const { left, top, right, bottom } = part.getBoundingClientRect();
          return { left, top, right, bottom };
        }),
      );
      assert.equal(boxes.length, 6);
      boxes.forEach((a, i) => {
        assert.ok(a.left >= 0 && a.top >= 0 && a.right <= width && a.bottom <= height && a.right - a.left > 200 && a.bottom - a.top > 40);
        for (const b of boxes.slice(0, i)) {
          assert.ok(a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top, 'two panels overlap');
        }
      });
      for (const tab of ['charts', 'accuracy', 'bake', 'contacts']) {
        await page.locator(`#tab-${tab}`).click();
        const wide = await page
          .locator('#controls, #sphere, [role=tabpanel]:not([hidden]), header, .chip')
          .evaluateAll((parts) => parts.filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => part.id || part.className));
        assert.deepEqual(wide, [], `wider than its place, ${tab}`);
      }
      silent(opened);
      await opened.close();
    }
    assert.ok(light.light > light.dark + 0.3, JSON.stringify(light));
  });
}

test('every control has a name', async () => {
  const page = await fresh();
  const nameless = await page
    .locator('button, input, canvas:not([aria-hidden]), [role=tabpanel], aside')
    .evaluateAll((all) =>
      all
        .filter((e) => !(e.ariaLabel || e.getAttribute('aria-labelledby') || e.labels?.[0]?.textContent || (e.tagName === 'BUTTON' && e.textContent)))
        .filter((e) => !e.closest('.uplot'))
        .map((e) => e.outerHTML.slice(0, 80)),
    );
  assert.deepEqual(nameless, []);
});

test('a page without WebGL says so and still lists pairs', async () => {
  const init = () => {
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind === '2d' ? getContext.call(this, kind, ...rest) : null;
    };
  };
  const opened = await open(browser, pages.arms.page, { init });
  assert.ok(await opened.page.locator('#no-webgl').isVisible());
  await scrub(opened.page, 19);
  assert.deepEqual(await listed(opened.page), pages.arms.play[19].pairs);
  silent(opened);
  await opened.close();
});

const rest = (data) => {
  data.frames = { count: 0, fps: 30, sphere_floats: 5, play: [] };
  data.bones = [];
};
const odd = {
  'the rest pose only, without a report': () => pages.rest,
  'no frames at all': () => pages.variant('no_frames.html', rest),
  'no skin': () =>
    pages.variant('no_skin.html', (data) => Object.assign(data.mesh, { influences: 0, joints: '', weights: '' })),
  'no spheres and no chains': () =>
    pages.variant('no_spheres.html', (data) => {
      rest(data);
      Object.assign(data.inspect, { spheres: [], chains: [], sphere_count: 0 });
      Object.assign(data, { sphere_f: [], pivot_triangles: [], ignored: [], report: null });
    }),
  'skin that no sphere owns': () => pages.variant('no_owner.html', (data) => (data.mesh.owner = base64(new Uint16Array(60000).fill(65535)))),
  'a cover radius': () =>
    pages.variant('cover.html', (data) => {
      const five = Buffer.from(data.frames.spheres, 'base64');
      const count = five.length / 20;
      const six = Buffer.alloc(24 * count);
      for (let i = 0; i < count; ++i) {
        five.copy(six, 24 * i, 20 * i, 20 * i + 20);
        five.copy(six, 24 * i + 20, 20 * i + 16, 20 * i + 20);
      }
      Object.assign(data.frames, { spheres: six.toString('base64'), sphere_floats: 6 });
    }),
  'frames of vertices': () =>
    pages.variant('vertices.html', (data) => {
      const rest = Buffer.from(data.mesh.positions, 'base64');
      Object.assign(data.frames, { count: 2, vertices: Buffer.concat([rest, rest]).toString('base64') });
      data.frames.play = data.frames.play.slice(0, 2);
    }),
  '400 frames of 100,000 vertices': () => pages.variant('huge.html', makeHuge),
};
for (const [what, make] of Object.entries(odd)) {
  test(`the page lives with ${what}`, async () => {
    const opened = await open(browser, make(), { width: 1010, height: 400 });
    const { page } = opened;
    for (const tab of ['charts', 'accuracy', 'bake', 'contacts']) await page.locator(`#tab-${tab}`).click();
    for (const key of ['b', 'End', 'p', 'n', 'c', 'u', ' ', ' ', '2', '1']) await page.keyboard.press(key);
    const before = await picture(page);
    await page.keyboard.press('s');
    assert.ok((await compare(page, before, await picture(page))).differing > 0.001, 'skin is drawn');
    silent(opened);
    await opened.close();
  });
}

test('the template says that it is one', async () => {
  const opened = await open(browser, template);
  assert.match(await opened.page.locator('body').innerText(), /template/);
  silent(opened);
  await opened.close();
});

test('nothing was written to the console in all this, and nothing asked for', () => silent(arms));
