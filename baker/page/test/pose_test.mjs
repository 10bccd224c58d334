// Posing by hand in the page of `view`: drags, what touches then, and the way of a saved pose through `play`. It uses what
// page_test.mjs baked.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { before, test } from 'node:test';
import { launch, open, silent } from './browser.mjs';

const { SPHERECHAIN_TOOL: tool, SPHERECHAIN_PAGE: template, SPHERECHAIN_HUMAN: human, SPHERECHAIN_HUESITOS: huesitos } = process.env;
const { SPHERECHAIN_POSES: poses, SPHERECHAIN_CHROMIUM: chromium, SPHERECHAIN_OUT: folder } = process.env;
const hasRuntime = readFileSync(template, 'utf8').includes('data-runtime');
const withRuntime = { skip: hasRuntime ? false : 'the page is built without the runtime' };

const SIZE = { width: 1000, height: 560 }; // small: drawing by software takes most of the time
const file = (name) => join(folder, name);
const run = (...words) => execFileSync(tool, words, { encoding: 'utf8' });
const motion = ['--poses', join(poses, 'arms_crossed.json'), '--frames', '5'];
const made = (asset, source, words) => {
  const page = asset.replace('.sphc', '_posed.html');
  run('view', asset, '--source', source, ...words, '-o', page);
  return { asset, source, page };
};

let session; // one page after another
let man; // with the automatic rig
let bones; // with a skeleton of its own
before(async () => {
  man = made(file('human.sphc'), human, motion);
  run('bake', huesitos, '-o', file('huesitos.sphc'));
  bones = made(file('huesitos.sphc'), huesitos, ['--frames', '4']);
  session = await open(await launch(chromium), man.page, SIZE);
});

const shown = (page) => page.evaluate(() => spherechainViewer.contacts());
const poseOf = async (page) => (await page.evaluate(() => spherechainViewer.posing.file())).poses[0];
const handle = (page, name) => page.locator(`.handle[title="${name}"]`);
async function middle(page, name) {
  const { x, y, width, height } = await handle(page, name).boundingBox();
  return [x + width / 2, y + height / 2];
}
const drawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));
async function drag(page, from, to) {
  await page.mouse.move(...from);
  await page.mouse.down();
  for (const part of [0.5, 1]) await page.mouse.move(...from.map((x, k) => x + part * (to[k] - x)));
  await drawn(page);
  await page.mouse.up();
}
const apart = ([a, b], [c, d]) => Math.hypot(a - c, b - d);

// Begins to pose the character in the frame shown.
async function posing(page) {
  await page.keyboard.press('j');
  if (hasRuntime) await page.waitForFunction(() => spherechainViewer.posing.isLive());
  await drawn(page);
}
// Begins to pose a character that was posed before, as at the start, but for the response.
async function again(page, responds = false) {
  if (await page.locator('#handles').isVisible()) await page.locator('#pose').click();
  await page.keyboard.press('0');
  await page.evaluate(() => spherechainViewer.setFrame(0));
  await posing(page);
  await page.locator('#pose-reset').click();
  if (!responds) await page.keyboard.press('k');
  await drawn(page);
}

// Saves the pose, and plays it; what the page shows and what `play` says must be the same.
async function roundTrip(page, { asset, source }) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#pose-save').click()]);
  const saved = file(download.suggestedFilename());
  await download.saveAs(saved);
  const command = (await page.locator('#posing .command').innerText()).trim();
  const names = [asset, source, saved].map((path) => basename(path));
  assert.equal(command, `spherechain play ${names[0]} --source ${names[1]} --poses ${names[2]} --frames 1`);
  const words = command.split(/\s+/).slice(1).map((word) => [asset, source, saved][names.indexOf(word)] ?? word);
  run(...words, '--contacts', '--json', file('saved_play.json'));
  const [played] = JSON.parse(readFileSync(file('saved_play.json'), 'utf8')).frames;
  // Depths along all directions come when the pose has settled.
  await page.waitForFunction(() => spherechainViewer.posing.isSettled());
  const listed = await shown(page);
  const name = ([a, b]) => (a === b ? `${a} with itself` : `${a}, ${b}`);
  const inAnyOrder = (text) => text.split(', ').sort().join(', '); // `play` lists the parts of triangles by their numbers
  const pairs = played.skin.parts.map(({ a, b, triangle_pairs: count }) => `${inAnyOrder(name([a, b]))}: ${count}`);
  assert.deepEqual(listed.filter((contact) => contact.pairs > 0).map((contact) => `${inAnyOrder(contact.name)}: ${contact.pairs}`).sort(), pairs.sort());
  for (const { parts, depth_mm: depth, class: kind } of played.penetrations) {
    const own = listed.find((contact) => contact.name === name(parts));
    if (parts[0] === parts[1]) continue; // two triangles of one part: rounding decides which of them goes out
    assert.ok(Math.abs(own.depth - depth) < 0.01 * depth + 0.01, `${name(parts)}: ${own.depth} and ${depth} mm`);
    assert.equal(own.kind, ['rest', 'shell', 'touch', 'fold', 'deep_fold', 'penetration', 'inside'].indexOf(kind));
  }
  return { listed, saved: JSON.parse(readFileSync(saved, 'utf8')) };
}

test('a frame is taken over as it is, and given back', async () => {
  const { page } = session;
  await page.evaluate(() => spherechainViewer.setFrame(4));
  const recorded = await shown(page);
  assert.ok(recorded.length > 0);
  await page.keyboard.press('j');
  if (hasRuntime) {
    await page.waitForFunction(() => spherechainViewer.posing.isLive());
    const same = await shown(page);
    assert.deepEqual(same.map(({ name }) => name), recorded.map(({ name }) => name));
    // Where triangles only just touch, rounding decides.
    same.forEach(({ depth, pairs }, i) => assert.ok(Math.abs(pairs - recorded[i].pairs) <= 1 && Math.abs(depth - recorded[i].depth) < 0.01 * depth + 0.01));
  }
  await drawn(page);
  const taken = await poseOf(page);
  await drag(page, await middle(page, 'left hand'), [600, 200]);
  assert.notDeepEqual(await shown(page), recorded);
  await page.locator('#pose').click();
  assert.deepEqual(await shown(page), recorded);
  assert.ok(await page.locator('#handles').isHidden());
  await page.locator('#pose').click();
  assert.deepEqual(await poseOf(page), taken, 'the frame is as it was');
  await page.locator('#pose-undo').click();
  assert.notDeepEqual(await poseOf(page), taken, 'what was left is there again');
  await page.evaluate(() => spherechainViewer.setFrame(2));
  await drag(page, await middle(page, 'left hand'), [600, 200]);
  for (let i = 0; i < 5 && (await page.locator('#pose-undo').isEnabled()); ++i) await page.locator('#pose-undo').click();
  assert.ok(await page.locator('#pose-undo').isDisabled(), 'all is taken back');
  assert.equal(await page.evaluate(() => spherechainViewer.frame), 4);
  assert.deepEqual(await poseOf(page), taken);
  silent(session);
});

test('a hand goes where it is dragged, what touches then is what play finds in the saved pose', withRuntime, async () => {
  const { page } = session;
  await again(page);
  assert.deepEqual(await shown(page), []);
  const chest = await middle(page, 'chest');
  const to = [chest[0] + 10, chest[1] - 20];
  await drag(page, await middle(page, 'left hand'), to);
  assert.ok(apart(await middle(page, 'left hand'), to) < 12, 'the hand is where it was let go');
  const hip = await middle(page, 'left_hip');
  await drag(page, await middle(page, 'right hand'), [hip[0] - 30, hip[1]]);
  const { listed, saved } = await roundTrip(page, man);
  assert.ok(listed.some(({ kind }) => kind === 5), 'something penetrates');
  assert.equal(saved.rig, undefined);
  const turned = Object.keys(saved.poses[0]).sort();
  assert.deepEqual(turned, ['left_elbow', 'left_shoulder', 'right_elbow', 'right_shoulder']);
  assert.equal(await page.locator('.contact').count(), listed.length);
  await page.locator('#pose-undo').click();
  assert.deepEqual(Object.keys(await poseOf(page)).sort(), ['left_elbow', 'left_shoulder']);
  await page.keyboard.press('Control+z');
  assert.deepEqual(await poseOf(page), {});
  assert.deepEqual(await shown(page), []);
  await page.keyboard.press('Control+Shift+Z');
  assert.deepEqual(Object.keys(await poseOf(page)).sort(), ['left_elbow', 'left_shoulder']);
  await page.keyboard.press('Control+y');
  assert.deepEqual(await poseOf(page), saved.poses[0]);
  assert.ok(await page.locator('#pose-redo').isDisabled());
  silent(session);
});

test('a hand that is dragged into the body is kept out of it, unless the response is off', withRuntime, async () => {
  const { page } = session;
  await again(page, true);
  const hand = await middle(page, 'right hand'), [x, y] = await middle(page, 'left_hip');
  const faultsOf = async () => (await shown(page)).filter(({ kind }) => kind >= 4).map(({ name }) => name);
  const drags = async () => {
    await drag(page, hand, [x - 30, y]);
    return { pose: await poseOf(page), faults: await faultsOf() };
  };
  const kept = await drags();
  assert.deepEqual(kept.faults, []);
  const { saved } = await roundTrip(page, man);
  assert.deepEqual(saved.poses[0], kept.pose, 'it is saved as it is seen');
  await page.keyboard.press('Control+z');
  assert.deepEqual(await poseOf(page), {});
  const second = await drags();
  for (const [joint, turn] of Object.entries(second.pose)) turn.forEach((x, i) => assert.ok(Math.abs(x - kept.pose[joint][i]) < 0.01, 'nothing is remembered'));
  await page.keyboard.press('Control+z');
  await page.keyboard.press('k');
  assert.ok(!(await page.locator('#show-respond').isChecked()));
  const inside = await drags();
  assert.notDeepEqual(inside.faults, []);
  await page.keyboard.press('k');
  assert.deepEqual(await faultsOf(), [], 'switched on, it brings the hand out');
  await page.keyboard.press('Control+z');
  assert.deepEqual(await poseOf(page), inside.pose);
  silent(session);
});

test('an elbow turns the arm around, hips go down between the feet, the head looks aside', async () => {
  const { page } = session;
  await again(page);
  const places = () => Promise.all(['left hand', 'left elbow', 'left foot', 'right foot', 'hips', 'head'].map((name) => middle(page, name)));
  const before = await places();
  await drag(page, before[4], [before[4][0], before[4][1] + 40]);
  const low = await places();
  assert.ok(apart(low[4], [before[4][0], before[4][1] + 40]) < 3);
  for (const foot of [2, 3]) assert.ok(apart(low[foot], before[foot]) < 3, 'feet stay');
  assert.ok(apart(low[5], [before[5][0], before[5][1] + 40]) < 4);
  await page.keyboard.press('2');
  await drawn(page);
  const [hips, head] = [await middle(page, 'hips'), await middle(page, 'head')];
  await drag(page, await middle(page, 'left hand'), [(hips[0] + head[0]) / 2 + 30, (hips[1] + head[1]) / 2]);
  const bent = await places();
  await drag(page, bent[1], [bent[1][0], bent[1][1] - 80]);
  const up = await places();
  assert.ok(up[1][1] < bent[1][1] - 8, 'the elbow goes up');
  assert.ok(apart(up[0], bent[0]) < 2, 'the hand stays');
  await drag(page, up[5], [up[5][0] + 30, up[5][1] + 10]);
  const turned = await poseOf(page);
  assert.ok('neck' in turned);
  // Undo waits for the end of a drag.
  await page.mouse.move(...up[0]);
  await page.mouse.down();
  await page.mouse.move(up[0][0] + 40, up[0][1]);
  await drawn(page);
  await page.keyboard.press('Control+z');
  assert.notDeepEqual(await poseOf(page), turned);
  await page.mouse.move(up[0][0] + 50, up[0][1] + 20);
  await drawn(page);
  await page.mouse.up();
  assert.notDeepEqual(await poseOf(page), turned);
  await page.keyboard.press('Control+z');
  assert.deepEqual(await poseOf(page), turned);
  await page.locator('#pose-reset').click();
  assert.deepEqual(await poseOf(page), {});
  silent(session);
});

test('the gizmo turns the joint that is clicked, on a skeleton of its own, and play reads that pose', async () => {
  await session.show(bones.page);
  const { page } = session;
  await posing(page);
  const taken = await poseOf(page);
  const names = await page.locator('.handle:visible').evaluateAll((all) => all.map(({ title }) => title));
  const at = await Promise.all(names.map((name) => middle(page, name)));
  // The one that stands most alone, so that no other handle is in the way.
  const alone = at.map((p, i) => Math.min(...at.filter((_, k) => k !== i).map((q) => apart(p, q))));
  const chosen = names[alone.indexOf(Math.max(...alone))];
  const center = await middle(page, chosen);
  await handle(page, chosen).click();
  assert.equal(await handle(page, chosen).getAttribute('aria-pressed'), 'true');
  const said = await page.locator('#pose-joint').innerText();
  assert.ok(said.startsWith(chosen) && /\d° from rest$/.test(said), said);
  await drawn(page);
  // Along the gizmo's rings until one is caught.
  let after = taken;
  for (let radius = 20; radius < 90 && JSON.stringify(after) === JSON.stringify(taken); radius += 4) {
    await drag(page, [center[0] + radius, center[1] + 3], [center[0] + radius - 30, center[1] + 40]);
    after = await poseOf(page);
  }
  const changed = [...new Set([...Object.keys(taken), ...Object.keys(after)])].filter((joint) => JSON.stringify(taken[joint]) !== JSON.stringify(after[joint]));
  assert.deepEqual(changed, [chosen]);
  assert.notEqual(await page.locator('#pose-joint').innerText(), said);
  if (hasRuntime) {
    const { saved } = await roundTrip(page, bones);
    assert.equal(saved.rig, 'own');
  }
  await page.keyboard.press('Escape');
  assert.equal(await handle(page, chosen).getAttribute('aria-pressed'), 'false');
  // From afar, small handles that would lie on others are left out.
  await page.mouse.move(300, 250);
  await page.mouse.wheel(0, 3000);
  await drawn(page);
  const left = await page.locator('.handle:visible').evaluateAll((all) =>
    all.map((one) => {
      const { x, y, width } = one.getBoundingClientRect();
      return { isSmall: one.matches('.joint'), at: [x + width / 2, y + width / 2] };
    }),
  );
  assert.ok(left.length < names.length && left.some(({ isSmall }) => isSmall), `${left.length} of ${names.length}`);
  left.forEach((p, i) => left.slice(0, i).forEach((q) => assert.ok((!p.isSmall && !q.isSmall) || apart(p.at, q.at) > 11.5)));
  silent(session);
});

test('a page without the runtime says so, and poses all the same', async () => {
  const html = readFileSync(man.page, 'utf8').replace(/"asset":"[^"]*",/, '');
  writeFileSync(file('no_asset.html'), html);
  await session.show(file('no_asset.html'));
  const { page } = session;
  await page.keyboard.press('j');
  assert.match(await page.locator('#posing [role=status]').innerText(), /finds no contacts/);
  await drawn(page);
  await drag(page, await middle(page, 'left hand'), [360, 250]);
  assert.ok('left_elbow' in (await poseOf(page)));
  // Who leaves with a pose that is not saved is asked.
  const [dialog] = await Promise.all([page.waitForEvent('dialog'), page.close({ runBeforeUnload: true })]);
  assert.equal(dialog.type(), 'beforeunload');
  await dialog.accept();
  silent(session);
});
