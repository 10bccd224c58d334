// SPDX-License-Identifier: MIT
// Pages in headless Chromium, over its pipe of the DevTools protocol; and a server of a folder, for pages that import modules.
import { spawn } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';

// A page that is isolated has a clock of 5 microseconds, else of 100.
const ISOLATED = { 'cross-origin-opener-policy': 'same-origin', 'cross-origin-embedder-policy': 'require-corp' };
const TYPES = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript' };

export async function serve(folder) {
  const server = createServer((request, response) => {
    const file = join(folder, normalize(decodeURIComponent(new URL(request.url, 'http://local').pathname)));
    try {
      const bytes = readFileSync(file);
      response.writeHead(200, { 'content-type': TYPES[extname(file)] ?? 'application/octet-stream', ...ISOLATED }).end(bytes);
    } catch {
      response.writeHead(file.endsWith('favicon.ico') ? 204 : 404).end();
    }
  });
  await new Promise(done => server.listen(0, '127.0.0.1', done));
  return { url: `http://127.0.0.1:${server.address().port}`, close: () => server.close() };
}

// A page, to evaluate expressions in; `noise` has what it wrote to the console, and its exceptions.
export async function visit(chromium, url) {
  const profile = mkdtempSync(join(tmpdir(), 'spherechain-'));
  const browser = spawn(chromium, ['--headless=new', '--no-sandbox', '--remote-debugging-pipe', `--user-data-dir=${profile}`,
    '--window-size=1000,800', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'], { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
  const [, , , input, output] = browser.stdio;
  const waiting = new Map(), noise = [];
  let text = '', next = 0, sessionId;
  const gone = new Promise((_, fail) => browser.once('exit', code => fail(new Error(`chromium ended with ${code}`))));
  gone.catch(() => {});
  output.setEncoding('utf8').on('data', data => {
    const messages = (text + data).split('\0');
    text = messages.pop();
    for (const { id, method, params, result, error } of messages.map(message => JSON.parse(message))) {
      if (method === 'Runtime.exceptionThrown') noise.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
      if (method === 'Runtime.consoleAPICalled') noise.push(params.args.map(value => value.value ?? value.description).join(' '));
      if (method === 'Log.entryAdded') noise.push(params.entry.text);
      if (error) waiting.get(id).fail(new Error(error.message));
      else waiting.get(id)?.done(result);
      waiting.delete(id);
    }
  });
  const send = (method, params = {}) => Promise.race([gone, new Promise((done, fail) => {
    waiting.set(++next, { done, fail });
    input.write(`${JSON.stringify({ id: next, method, params, sessionId })}\0`);
  })]);
  const { targetId } = await send('Target.createTarget', { url: 'about:blank' });
  ({ sessionId } = await send('Target.attachToTarget', { targetId, flatten: true }));
  for (const domain of ['Runtime', 'Log', 'Page']) await send(`${domain}.enable`);
  await send('Page.navigate', { url });
  const evaluate = async expression => {
    const { result, exceptionDetails } = await send('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  return {
    noise,
    evaluate,
    // The value of the expression, once it is true. Drawing by software takes long where other tests run beside.
    async wait(expression, seconds = 120) {
      for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
        const value = await evaluate(expression).catch(() => null);  // the page may not be there yet
        if (value) return value;
        await new Promise(done => setTimeout(done, 50));
      }
      throw new Error(`never true: ${expression}\n${noise.join('\n')}`);
    },
    async picture() {
      return Buffer.from((await send('Page.captureScreenshot')).data, 'base64');
    },
    async close() {
      const end = new Promise(done => browser.once('exit', done));
      sessionId = undefined;
      send('Browser.close').catch(() => {});
      await end;
      rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
    },
  };
}
