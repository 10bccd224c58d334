// Are `spherechain check`'s events those of CGAL's intersections, and how much faster does it find them?
//   node check_against_cgal.mjs TOOL FILE[+MOTION]...
//
// For each clip: events join the frames in which `play` finds the two body parts in contact, and `validate` finds no
// contact of any frame missing or extra by CGAL. Shallow: faults that are less than .8 as deep as the deepest fault that `play`
// measures of those parts in those frames (it measures each in full, and keeps a direction that is up to 1.25 as long). The ratio is of times of the same frames, one after another on one core:
// check with its report and without the bake, over the search by CGAL and its comparison with ours.
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';

const [tool, ...files] = process.argv.slice(2);
if (files.length === 0) throw new Error('node check_against_cgal.mjs TOOL FILE[+MOTION]...');
const folder = mkdtempSync(join(tmpdir(), 'check-'));
const kGap = 3, faults = ['inside', 'penetration', 'deep_fold'];
const rate = ['--fps', '30'];

function run(...words) {
  const start = performance.now();
  const { status, stderr } = spawnSync(tool, words, { encoding: 'utf8', maxBuffer: 1 << 28 });
  if (status !== 0) throw new Error(`${words.join(' ')}: ${stderr}`);
  return (performance.now() - start) / 1000;
}
const json = (name) => JSON.parse(readFileSync(join(folder, name), 'utf8'));
const to = (name) => ['--json', join(folder, name)];

// Runs of frames, over gaps, and over the seam of a loop: `a/b: from-to`.
function spans(frames, loops) {
  const met = new Map();
  frames.forEach((frame, i) => {
    for (const { a, b } of frame.skin.parts) met.set(`${a}/${b}`, [...(met.get(`${a}/${b}`) ?? []), i]);
  });
  const out = [];
  for (const [parts, list] of met) {
    const runs = [];
    for (const i of list) {
      if (runs.length > 0 && i - runs.at(-1)[1] - 1 <= kGap) runs.at(-1)[1] = i;
      else runs.push([i, i]);
    }
    if (loops && runs.length > 1 && runs[0][0] + frames.length - 1 - runs.at(-1)[1] - 1 <= kGap) runs[0][0] = runs.pop()[0];
    for (const [from, last] of runs) out.push(`${parts}: ${from}-${last}`);
  }
  return new Set(out);
}
// Events whose depth is below that share of the depth in the deepest frame.
function shallow(events, frames, share) {
  return events.filter(({ parts: [a, b], class: kind, from, to, depth_mm: depth }) => {
    if (!faults.includes(kind)) return false;
    const here = frames.filter((_, i) => (from <= to ? i >= from && i <= to : i >= from || i <= to));
    const found = here.flatMap((f) => f.penetrations).filter((p) => p.parts[0] === a && p.parts[1] === b && faults.includes(p.class));
    return depth < share * Math.max(...found.map((p) => p.depth_mm));
  }).length;
}
const sizeOfOnly = (a, b) => [...a].filter((x) => !b.has(x)).length;

const total = { clips: 0, frames: 0, events: 0, missed: 0, invented: 0, faults: 0, shallow: 0, missing: 0, extra: 0, check: 0, cgal: 0 };
const columns = Object.keys(total);
const line = (name, row) => {
  const cells = columns.map((c) => (['check', 'cgal'].includes(c) ? ((1000 * row[c]) / row.frames).toFixed(2) : `${row[c]}`).padStart(9));
  console.log(`${name.padEnd(32)}${cells.join('')}${(row.cgal / row.check).toFixed(0).padStart(7)} x`);
};
console.log(`${'character'.padEnd(32)}${columns.map((c) => c.padStart(9)).join('')}   (check, cgal: ms a frame)`);
for (const file of files) {
  const [character, motion] = file.split('+');
  const carried = motion ? ['--motion', motion] : [];
  const asset = join(folder, 'asset.sphc'), cache = ['--cache', join(folder, basename(file))];
  const report = ['-o', join(folder, 'report'), '--fail-on', 'none', '--jobs', '1'];
  run('bake', character, '-o', asset);
  run('check', character, ...carried, ...report, ...cache, '--fps', '1');  // bakes into the cache
  const row = Object.fromEntries(columns.map((c) => [c, 0]));
  row.check = run('check', character, ...carried, ...report, ...cache, ...rate, '--folds', ...to('check.json'));
  for (const clip of json('check.json').clips) {
    const which = motion ? carried : ['--clip', clip.clip];
    run('play', asset, '--source', character, ...which, ...rate, ...to('play.json'));
    const events = new Set(clip.events.map(({ parts: [a, b], from, to }) => `${a}/${b}: ${from}-${to}`));
    const { frames } = json('play.json');
    const expected = spans(frames, clip.loops);
    row.cgal += run('validate', asset, '--source', character, ...which, ...rate, '--contacts', ...to('truth.json'));
    const truth = json('truth.json');
    if (truth.frames !== clip.frames) throw new Error(`${file}: ${clip.clip}: ${truth.frames} frames, not ${clip.frames}`);
    row.clips += 1;
    row.frames += clip.frames;
    row.events += clip.events.length;
    row.missed += sizeOfOnly(expected, events);
    row.invented += sizeOfOnly(events, expected);
    row.faults += shallow(clip.events, frames, Infinity);
    row.shallow += shallow(clip.events, frames, 0.8);
    row.missing += truth.contacts_missing + truth.contacts_from_bones.missing + truth.neighbour_contacts.missing;
    row.extra += truth.contacts_extra + truth.contacts_from_bones.extra + truth.neighbour_contacts.extra;
  }
  line(basename(character) + (motion ? ` + ${basename(motion)}` : ''), row);
  for (const c of columns) total[c] += row[c];
}
line('all', total);
rmSync(folder, { recursive: true });
