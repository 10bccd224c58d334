// The pages under test: made by the real tool, and variants of their data that the tool may write one day.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const DATA = /(<script id="spherechain-data" type="application\/json">)([^<]*)(<\/script>)/;

export function makePages({ tool, human, poses, folder }) {
  mkdirSync(folder, { recursive: true });
  const file = (name) => join(folder, name);
  const run = (...words) => execFileSync(tool, words, { encoding: 'utf8' });
  const readJson = (name) => JSON.parse(readFileSync(file(name), 'utf8'));
  const asset = file('human.sphc');
  run('bake', human, '-o', asset, '--report', file('report.json'));
  const motions = ['arms', 'legs'].map((name) => {
    const motion = ['--source', human, '--poses', join(poses, `animation_${name}.json`), '--frames', '40'];
    run('validate', asset, ...motion.slice(0, -1), '9', '--radius', 'fit', '--spheres-alone', '--json', file('validation.json'));
    run('view', asset, ...motion, '--report', file('report.json'), '--validation', file('validation.json'), '-o', file(`${name}.html`));
    run('play', asset, ...motion, '--json', file(`${name}.json`));
    return { page: file(`${name}.html`), play: readJson(`${name}.json`).frames, validation: readJson('validation.json') };
  });
  run('view', asset, '--source', human, '--frames', '1', '-o', file('rest.html'));
  return {
    arms: motions[0],
    legs: motions[1],
    rest: file('rest.html'),
    inspect: JSON.parse(run('inspect', asset, '--json')),
    report: readJson('report.json'),
    // What `view` says to a changed file of another command.
    view(option, name, change) {
      const data = readJson(name);
      change(data);
      writeFileSync(file('changed.json'), JSON.stringify(data));
      rmSync(file('changed.html'), { force: true });
      const words = ['view', asset, '--source', human, '--frames', '1', option, file('changed.json'), '-o', file('changed.html')];
      const { status, stderr } = spawnSync(tool, words, { encoding: 'utf8' });
      return { code: status, error: stderr, written: existsSync(file('changed.html')) };
    },
    // A page with changed data.
    variant(name, change) {
      const html = readFileSync(motions[0].page, 'utf8');
      const data = JSON.parse(html.match(DATA)[2]);
      change(data);
      const text = JSON.stringify(data).replaceAll('<', '\\u003c');
      writeFileSync(file(name), html.replace(DATA, (_, open, __, close) => open + text + close));
      return file(name);
    },
  };
}

export const base64 = (array) => Buffer.from(array.buffer).toString('base64');

// A sheet of 317 x 317 vertices on one bone that turns about the character's axis, 400 frames.
export function makeHuge(data) {
  const side = 317;
  const frames = 400;
  const { origin, height } = data.frame;
  const positions = new Float32Array(3 * side * side);
  for (let v = 0; v < side * side; ++v) {
    const [i, j] = [v % side, Math.floor(v / side)];
    positions.set([origin[0] + height * (i / side - 0.5), origin[1] + (height * j) / side, origin[2]], 3 * v);
  }
  const triangles = [];
  for (let j = 0; j + 1 < side; ++j) {
    for (let i = 0; i + 1 < side; ++i) {
      const v = j * side + i;
      triangles.push(v, v + 1, v + side, v + 1, v + side + 1, v + side);
    }
  }
  const spheres = data.inspect.spheres.length;
  data.mesh = {
    positions: base64(positions),
    triangles: base64(Uint32Array.from(triangles)),
    owner: base64(Uint16Array.from({ length: triangles.length / 3 }, (_, t) => t % (spheres + 1) || 65535)),
    influences: 1,
    joints: base64(new Uint16Array(side * side)),
    weights: base64(new Uint16Array(side * side).fill(65535)),
  };
  data.bones = ['turn'];
  data.pivot_triangles = data.pivot_triangles.map(() => []);
  const bones = Array.from({ length: frames }, (_, f) => {
    const [c, s] = [Math.cos(f / 20), Math.sin(f / 20)];
    return [c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0];
  });
  const one = Buffer.from(data.frames.spheres, 'base64').subarray(0, spheres * 5 * 4);
  data.frames = {
    count: frames,
    fps: 30,
    bones: base64(Float32Array.from(bones.flat())),
    sphere_floats: 5,
    spheres: Buffer.concat(Array(frames).fill(one)).toString('base64'),
    play: Array.from({ length: frames }, (_, index) => ({ ...data.frames.play[index % 40], index, time: index / 30 })),
  };
}
