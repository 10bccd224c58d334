// Editing in the page of `view`, from the mouse to a bake that applies what was saved. It uses what page_test.mjs baked.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { hold, launch, open, silent } from './browser.mjs';

const { SPHERECHAIN_TOOL: tool, SPHERECHAIN_HUMAN: human, SPHERECHAIN_CHROMIUM: chromium, SPHERECHAIN_OUT: folder } = process.env;
const run = (...words) => execFileSync(tool, words, { encoding: 'utf8' });
const file = (name) => join(folder, name);
const edits = (page) => page.evaluate(() => spherechainViewer.edits());
const sorted = (list) => list.map((entry) => JSON.stringify(entry, Object.keys(entry).sort())).sort();
const canonical = ({ spheres, ignored_parts: parts }) => [
  sorted(spheres.map(({ region, from = {}, to = {} }) => ({ region, ...Object.fromEntries([...Object.entries(from).map(([k, v]) => [`from ${k}`, `${v}`]), ...Object.entries(to).map(([k, v]) => [`to ${k}`, `${v}`])]) }))),
  parts,
];
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

let rest; // opened once: a narrow window first
before(async () => (rest = await open(await launch(chromium), file('rest.html'), { width: 800, height: 600 })));

// Clicks around until a sphere is picked that was not before; where that was.
async function pickAnother(page, already) {
  const box = await page.locator('main').boundingBox();
  for (const y of [0.45, 0.6, 0.7, 0.3, 0.4]) {
    for (const x of [0.5, 0.46, 0.54, 0.43, 0.57]) {
      const at = { x: box.x + x * box.width, y: box.y + y * box.height };
      await page.keyboard.press('Escape');
      await page.mouse.click(at.x, at.y);
      const { picked } = await edits(page);
      if (picked !== null && !already.includes(picked)) return { at, id: picked };
    }
  }
  assert.fail('no sphere is picked');
}
const sphere = async (page, id) => (await edits(page)).spheres.find((one) => one.id === id);

test('the editor fits where the window is narrow, and every control has a name', async () => {
  for (const [width, height] of [[800, 600], [390, 844]]) {
    const { page } = rest;
    await page.setViewportSize({ width, height });
    await page.locator('#tab-edit').click();
    const wide = await page
      .locator('body, #results, [role=tablist], #edit, #edit button, .edit-parts, .edit-buttons')
      .evaluateAll((parts) => parts.filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => part.id || part.className));
    assert.deepEqual(wide, [], `at ${width} x ${height}`);
    const nameless = await page.locator('#edit :is(button, input, select)').evaluateAll((all) => all.filter((e) => !(e.ariaLabel || e.labels?.[0]?.textContent || e.textContent)).length);
    assert.equal(nameless, 0);
    silent(rest);
    await page.locator('#tab-contacts').click();
  }
});

test('spheres are moved, resized, added and deleted, parts ignored; undone and redone; and a bake applies what was saved', async () => {
  const inspect = JSON.parse(run('inspect', file('human.sphc'), '--json'));
  const mm = 1e-3 / inspect.source.metres_per_unit;
  const { page } = rest;
  await page.setViewportSize({ width: 1280, height: 560 });
  await page.keyboard.press('e');
  assert.ok(await page.locator('#edit').isVisible());
  assert.deepEqual((await edits(page)).file, { spherechain_edits: 1, spheres: [], ignored_parts: [] });
  assert.ok(await page.locator('#edit-save').isDisabled());

  // Dragged, it stays in the plane of the screen.
  const first = await pickAnother(page, []);
  const from = await sphere(page, first.id);
  assert.ok(distance(from.center, inspect.spheres[first.id].center) < 1e-5);
  await page.mouse.move(first.at.x, first.at.y);
  await page.mouse.down();
  await page.mouse.move(first.at.x + 12, first.at.y - 8, { steps: 3 });
  await page.mouse.up();
  const dragged = await sphere(page, first.id);
  const { left, up, forward } = inspect.frame;
  const along = (axis) => dragged.center.reduce((sum, x, k) => sum + (x - from.center[k]) * axis[k], 0);
  assert.ok(along(left) > 10 * mm && along(up) > 5 * mm && Math.abs(along(forward)) < along(up), `${along(left)} ${along(up)} ${along(forward)}`);

  await hold(page, true);
  await page.keyboard.press('ArrowLeft');
  const nudged = await sphere(page, first.id);
  assert.ok(Math.abs(distance(nudged.center, dragged.center) - 2 * mm) < 0.01 * mm);
  await page.keyboard.press('+');
  assert.ok(Math.abs((await sphere(page, first.id)).radius / nudged.radius - 1.03) < 1e-5);
  await page.locator('#edit-size').fill('50');
  await page.keyboard.press('Enter');
  const { detect_radius: detect, radius } = inspect.spheres[first.id];
  assert.ok(Math.abs((await sphere(page, first.id)).radius - (50 * mm * radius) / detect) < 0.01 * mm, 'both radii keep their proportion');
  const changed = (await edits(page)).file;
  assert.equal(changed.spheres.length, 1);
  assert.match(await page.locator('[data-edit]').innerText(), /moved \d+ mm, \d+ % (larger|smaller)/);
  for (const refused of ['5000', '0', '-20', '1e9']) {
    await page.locator('#edit-size').fill(refused);
    await page.keyboard.press('Enter');
    assert.equal(await page.locator('#edit-size').inputValue(), '50.0');
    assert.match(await page.locator('#edit-limit').innerText(), /^A radius here is [\d.]+ to [\d,]+ mm[.]$/);
  }
  assert.deepEqual((await edits(page)).file, changed);
  await hold(page, false);

  // A reset keeps the spheres in sight. Where they are not, none is picked and none can be deleted.
  await page.locator('#reset').click();
  assert.ok(await page.locator('#show-spheres').isChecked());
  assert.equal((await edits(page)).picked, first.id);
  await page.locator('#show-spheres').uncheck();
  await page.mouse.click(first.at.x, first.at.y);
  await page.keyboard.press('Delete');
  assert.equal((await edits(page)).picked, null);
  assert.deepEqual((await edits(page)).file, changed);
  await page.locator('#show-spheres').check();

  // A key that comes in a drag does nothing.
  const second = await pickAnother(page, [first.id]);
  await page.mouse.down();
  await page.mouse.move(second.at.x + 20, second.at.y, { steps: 2 });
  for (const key of ['Delete', 'Control+z']) await page.keyboard.press(key);
  await page.mouse.move(second.at.x + 30, second.at.y);
  await page.mouse.up();
  assert.equal((await edits(page)).file.spheres.length, 2);
  await page.keyboard.press('Control+z');
  assert.deepEqual((await edits(page)).file, changed);
  await page.locator('#edit-delete').click();
  assert.equal((await edits(page)).picked, null);
  const third = await pickAnother(page, [first.id, second.id]);
  await hold(page, true);
  await page.keyboard.press('a');
  const { picked: added } = await edits(page);
  assert.ok(added >= inspect.sphere_count && added !== third.id);
  await page.keyboard.press('Shift+ArrowDown');
  await page.locator('#edit-part-a').selectOption('left hand');
  assert.ok(await page.locator('#edit-ignore').isDisabled());
  await page.locator('#edit-part-b').selectOption('head');
  await page.locator('#edit-ignore').click();
  const all = (await edits(page)).file;
  assert.deepEqual(all.spheres.map(({ from: a, to: b }) => [Boolean(a), Boolean(b)]).sort(), [[false, true], [true, false], [true, true]]);
  assert.deepEqual(all.ignored_parts, [['left hand', 'head']]);
  assert.equal(await page.locator('#edit-list li').count(), 4);

  const steps = ['z', 'z', 'z', 'z'];
  for (const key of steps) await page.keyboard.press(`Control+${key}`);
  assert.deepEqual((await edits(page)).file, changed);
  for (const key of steps) await page.keyboard.press(`Control+Shift+${key}`);
  assert.deepEqual((await edits(page)).file, all);
  await page.locator('#edit-list .link').first().click();
  assert.equal((await edits(page)).file.spheres.length, 2);
  await page.locator('#edit-undo').click();

  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#edit-save').click()]);
  assert.equal(download.suggestedFilename(), 'human_edits.json');
  await download.saveAs(file('human_edits.json'));
  assert.deepEqual(JSON.parse(readFileSync(file('human_edits.json'), 'utf8')), all);
  const wanted = (await edits(page)).spheres;
  assert.ok(await page.locator('#edit-save').isDisabled(), 'all is saved');
  const [save, list] = await Promise.all(['#edit-save', '#edit-list'].map((id) => page.locator(id).boundingBox()));
  assert.ok(save.y < list.y);

  // Frames go on where they were.
  await hold(page, false);
  await page.locator('#tab-contacts').click();
  assert.match(await page.locator('#contacts').innerText(), /spheres as baked/);
  assert.ok(!(await page.evaluate(() => document.body.classList.contains('editing'))));
  silent(rest);

  const said = run('bake', human, '--edits', file('human_edits.json'), '-o', file('edited.sphc'));
  assert.match(said, /4 of 4 edits applied/);
  const baked = JSON.parse(run('inspect', file('edited.sphc'), '--json')).spheres;
  assert.equal(baked.length, wanted.length);
  for (const { id, center, radius: r } of wanted) {
    const found = baked.find((one) => distance(one.center, center) < 0.05 * mm);
    assert.ok(found && Math.abs(found.radius - r) < 0.05 * mm, `sphere ${id}`);
  }
  run('view', file('edited.sphc'), '--source', human, '-o', file('edited.html'));
  await rest.show(file('edited.html'));
  await page.locator('#tab-edit').click();
  assert.equal(await page.locator('#edit-list li').count(), 4);
  assert.ok(await page.locator('#edit-save').isDisabled(), 'nothing is new');
  assert.ok(await page.locator('#stale').isHidden());
  assert.deepEqual(canonical((await edits(page)).file), canonical(all));
  // After undo, there is no edit of a sphere left, and the one that was deleted is there again.
  for (let i = 0; i < 3; ++i) await page.locator('#edit-list .link').first().click();
  const back = await edits(page);
  assert.deepEqual(back.file.spheres, []);
  for (const { center } of inspect.spheres) assert.ok(back.spheres.some((one) => distance(one.center, center) < 0.05 * mm));
  silent(rest);
});
