// How long `spherechain check` takes for a library: node check_library.mjs TOOL FOLDER [CLIPS] [FRAMES]
//
// The character is the MakeHuman body of Debian's assimp-testmodels; the clips are cut out of three recordings beside it,
// each from another frame on. Prints the time of a first run, of one with nothing changed, and of one process alone for a
// tenth of the clips, from which the parallel efficiency follows.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { join } from 'node:path';

const [tool, folder, clips = '1000', frames = '300'] = process.argv.slice(2);
if (!folder) throw new Error('node check_library.mjs TOOL FOLDER [CLIPS] [FRAMES]');
const models = '/usr/share/assimp/models';
const human = join(models, 'Collada/human.zae');

// A recording from some frame on.
function cut(lines, first, count) {
  const start = lines.findIndex((line) => line.trim() === 'MOTION');
  const body = lines.slice(start + 3).filter((line) => line.trim() !== '');
  return [...lines.slice(0, start + 1), `Frames: ${count}`, lines[start + 2], ...body.slice(first, first + count), ''].join('\n');
}

function makeClips(into, count) {
  mkdirSync(into, { recursive: true });
  const recordings = ['Boxing_Toes', '01_01', '01_03'].map((name) => readFileSync(join(models, `BVH/${name}.bvh`), 'utf8').split(/\r?\n/));
  for (let i = 0; i < count; ++i) {
    const lines = recordings[i % recordings.length];
    const last = Number(lines.find((line) => line.startsWith('Frames:')).split(':')[1]) - Number(frames);
    const first = (Math.floor(i / recordings.length) * 7) % last;
    writeFileSync(join(into, `clip_${String(i).padStart(4, '0')}.bvh`), cut(lines, first, Number(frames)));
  }
}

function run(name, motion, more) {
  const words = ['check', human, '--motion', motion, '-o', join(folder, `report_${name}`), '--fail-on', 'none', ...more];
  const start = performance.now();
  const { status, stdout, stderr } = spawnSync('/usr/bin/time', ['-f', '%M %U %S', tool, ...words], { encoding: 'utf8', maxBuffer: 1 << 28 });
  const seconds = (performance.now() - start) / 1000;
  if (status !== 0) throw new Error(stderr);
  const summary = stdout.split('\n').find((line) => /^\d+ characters?, /.test(line));
  const [kilobytes, user, system] = stderr.trim().split(' ').map(Number);
  const cpu = user + system;
  console.log(`${name.padEnd(10)} ${seconds.toFixed(1).padStart(7)} s, ${cpu.toFixed(1).padStart(7)} s of all cores, ${(kilobytes / 1024).toFixed(0)} MB a process at most: ${summary}`);
  return { seconds, cpu };
}

rmSync(folder, { recursive: true, force: true });
makeClips(join(folder, 'clips'), Number(clips));
const few = Math.max(Math.round(Number(clips) / 10), 1);
makeClips(join(folder, 'few'), few);
const baked = ['--cache', join(folder, 'baked')];
makeClips(join(folder, 'one'), 1);
run('bake', join(folder, 'one'), baked);
const all = run('first', join(folder, 'clips'), ['--cache', join(folder, 'cache')]);
run('unchanged', join(folder, 'clips'), ['--cache', join(folder, 'cache')]);
execFileSync('cp', ['-r', join(folder, 'baked'), join(folder, 'baked2')]);
const alone = run('alone', join(folder, 'few'), [...baked, '--jobs', '1']);
const together = run('together', join(folder, 'few'), ['--cache', join(folder, 'baked2')]);
const cores = availableParallelism();
const perFrame = (seconds) => ((1000 * seconds) / (Number(clips) * Number(frames))).toFixed(2);
console.log(`${perFrame(all.seconds)} ms a frame on ${cores} cores, ${perFrame(all.cpu)} ms of a core, bake and report included`);
console.log(`parallel efficiency ${(alone.seconds / together.seconds / cores).toFixed(2)}`);
console.log(execFileSync('du', ['-sh', join(folder, 'report_first')], { encoding: 'utf8' }).trim());
