// SPDX-License-Identifier: GPL-3.0-or-later
// usd_in_browser.mjs TOOL POSED_COLLIDERS ENGINE_COLLIDERS: TinyUSDZ, which runs in browsers only, loads what `export
// --to usd` wrote. It has no physics: prims, their names and where they are is what it tells.
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join } from 'node:path';
import { Matrix4, Quaternion, Vector3 } from 'three';
import { rebuild } from './usd.mjs';

const folder = mkdtempSync(join(tmpdir(), 'spherechain_usd_'));
execFileSync(process.argv[4], [folder, '1', 'boxes']);

const page = `<!doctype html>
<script type="importmap">{"imports": {"three": "/node_modules/three/build/three.module.js", "three/": "/node_modules/three/"}}</script>
<script type="module">
const report = (text) => fetch('/report', { method: 'POST', body: text });
const plain = (node) => ({ name: node.primName, matrix: [...node.localMatrix], children: node.children.map(plain) });
try {
  const { TinyUSDZLoader } = await import('/node_modules/tinyusdz/TinyUSDZLoader.js');
  const loader = new TinyUSDZLoader();
  await loader.init();
  report(JSON.stringify(plain((await loader.loadAsync('/usd.usda')).getDefaultRootNode())));
} catch (error) {
  report(JSON.stringify({ error: error + ' ' + (error.cause ?? '') }));
}
</script>`;

const types = { '.js': 'text/javascript', '.wasm': 'application/wasm' };
const server = createServer((request, reply) => {
  if (request.url === '/') return reply.setHeader('content-type', 'text/html').end(page);
  if (request.url === '/report') {
    let text = '';
    request.on('data', (some) => (text += some));
    return request.on('end', () => { reply.end(); server.emit('report', text); });
  }
  const file = request.url === '/usd.usda' ? join(folder, 'usd.usda') : join('.', request.url);
  try {
    return reply.setHeader('content-type', types[extname(file)] ?? 'application/octet-stream').end(readFileSync(file));
  } catch {
    return reply.writeHead(404).end();
  }
});

await new Promise((listens) => server.listen(0, '127.0.0.1', listens));
const child = spawn('chromium', ['--headless', '--no-sandbox', '--disable-gpu', `--user-data-dir=${join(folder, 'profile')}`,
  `http://127.0.0.1:${server.address().port}/`], { stdio: 'ignore' });
const answer = await new Promise((done) => {
  child.on('error', () => done('missing'));
  server.on('report', done);
  setTimeout(() => done('{"error": "the browser says nothing"}'), 60000).unref();
});
if (child.pid !== undefined) {
  const gone = new Promise((done) => child.on('exit', done));
  child.kill();  // not -9: it ends its own children, which write into the folder
  await gone;
}
server.close();
server.closeAllConnections();
if (answer === 'missing') {
  console.log('SKIPPED: export.usd_in_browser needs chromium, and it is not installed');
  process.exit(77);
}

const stage = JSON.parse(answer);
if (stage.error) throw new Error(stage.error);
const apart = ({ matrix }, position, rotation) => {
  const ours = new Matrix4().compose(new Vector3(...position), new Quaternion(...rotation), new Vector3(1, 1, 1));
  return Math.max(...ours.elements.map((value, i) => Math.abs(value - matrix[i])));
};
const { bodies } = rebuild(join(folder, 'usd.usda'));
if (stage.children.length !== bodies.length) throw new Error(`${stage.children.length} bodies instead of ${bodies.length}`);
let worst = 0;
bodies.forEach(({ rest, volumes }, i) => {
  worst = Math.max(worst, apart(stage.children[i], rest.position, rest.rotation));
  volumes.forEach(({ center }, k) => {
    const there = stage.children[i].children[k].matrix.slice(12, 15);
    worst = Math.max(worst, ...center.map((value, axis) => Math.abs(value - there[axis])));
  });
});
rmSync(folder, { recursive: true, force: true, maxRetries: 20, retryDelay: 100 });
console.log(`TinyUSDZ: ${bodies.length} bodies and their volumes within ${worst.toExponential(1)}`);
if (!(worst <= 1e-6)) throw new Error('elsewhere');
