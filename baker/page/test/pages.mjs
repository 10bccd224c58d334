// The pages under test: made by the real tool, and variants of their data.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';

const DATA = /(<script id="spherechain-data" type="application\/json">)([^<]*)(<\/script>)/;

export function makePages({ tool, human, huesitos, poses, folder }) {
  mkdirSync(folder, { recursive: true });
  const file = (name) => join(folder, name);
  const run = (...words) => execFileSync(tool, words, { encoding: 'utf8' });
  const readJson = (name) => JSON.parse(readFileSync(file(name), 'utf8'));
  const asset = file('human.sphc');
  run('bake', human, '-o', asset, '--report', file('report.json'));
  const motion = ['--source', human, '--poses', join(poses, 'animation_arms.json'), '--frames'];
  const validate = ['--radius', 'fit', '--spheres-alone', '--json', file('validation.json')];
  run('validate', asset, ...motion, '9', ...validate);
  const given = ['--report', file('report.json'), '--validation', file('validation.json')];
  run('view', asset, ...motion, '40', ...given, '-o', file('arms.html'));
  run('play', asset, ...motion, '40', '--contacts', '--json', file('arms.json'));
  run('view', asset, '--source', human, '-o', file('rest.html'));
  const boxing = ['--source', human, '--motion', join(dirname(human), '../BVH/Boxing_Toes.bvh'), '--frames', '40'];
  run('view', asset, ...boxing, '--respond', '-o', file('responded.html'));
  run('play', asset, ...boxing, '--respond', '--json', file('responded.json'));
  const second = ['--with', asset, '--with-poses', join(poses, 'animation_arms.json'), '--at', '0,0.2,180'];
  run('view', asset, ...motion, '14', ...second, '-o', file('two.html'));
  run('fix', huesitos, '-o', file('fixed.glb'), '--report', file('fixed'), '--force');
  return {
    // Fixes once more, with these options. Returns what it says about the clip.
    decide(...options) {
      run('fix', huesitos, '-o', file('fixed.glb'), '--report', file('fixed'), '--force', ...options);
      return readJson('fixed/fix.json').clips[0];
    },
    decisions: file('decisions.json'),
    fixed: file('fixed/clip_0.html'),
    arms: file('arms.html'),
    rest: file('rest.html'),
    two: file('two.html'),
    play: readJson('arms.json').frames,
    responded: { page: file('responded.html'), ...readJson('responded.json') },
    clip: readJson('arms.json').clips[0],
    inspect: JSON.parse(run('inspect', asset, '--json')),
    report: readJson('report.json'),
    validation: readJson('validation.json'),
    // The message of `view` for a changed file of another command.
    view(option, name, change) {
      const data = readJson(name);
      change(data);
      writeFileSync(file('changed.json'), JSON.stringify(data));
      rmSync(file('changed.html'), { force: true });
      const words = ['view', asset, '--source', human, '--frames', '1', option, file('changed.json'), '-o', file('changed.html')];
      const { status, stderr } = spawnSync(tool, words, { encoding: 'utf8' });
      return { code: status, error: stderr, written: existsSync(file('changed.html')) };
    },
    // The page of the arms, or another, with changed data.
    variant(name, change, of = 'arms.html') {
      const html = readFileSync(file(of), 'utf8');
      const data = JSON.parse(html.match(DATA)[2]);
      change(data);
      const text = JSON.stringify(data).replaceAll('<', '\\u003c');
      writeFileSync(file(name), html.replace(DATA, (_, open, __, close) => open + text + close));
      return file(name);
    },
  };
}

export const base64 = (array) => Buffer.from(array.buffer).toString('base64');
export const unpack = (text, Type) => new Type(new Uint8Array(Buffer.from(text, 'base64')).buffer);
