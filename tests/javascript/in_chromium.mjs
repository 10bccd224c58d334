// SPDX-License-Identifier: MIT
// measure() in a page that imports the package as an ES module.
import { cpSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { serve, visit } from './chromium.mjs';

export async function measureInChromium(chromium, packageFolder, asset, palettes, passes, calls) {
  const folder = mkdtempSync(join(tmpdir(), 'spherechain-'));
  const root = fileURLToPath(new URL('../..', import.meta.url));
  for (const source of ['tests/javascript', 'samples/javascript']) {
    mkdirSync(join(folder, source), { recursive: true });
    cpSync(join(root, source), join(folder, source), { recursive: true });
  }
  cpSync(packageFolder, join(folder, 'package'), { recursive: true, dereference: true });
  cpSync(asset, join(folder, 'asset'));
  cpSync(palettes, join(folder, 'palettes'));
  writeFileSync(join(folder, 'index.html'), `<!doctype html><script type="module">
    import { load } from './package/index.js';
    import { measure } from './tests/javascript/measure.mjs';
    const bytes = async name => (await fetch(name)).arrayBuffer();
    window.measured = await measure(load, await bytes('asset'), await bytes('palettes'), ${passes}, ${JSON.stringify(calls)});
  </script>`);
  const server = await serve(folder);
  const page = await visit(chromium, `${server.url}/index.html`);
  try {
    const measured = await page.wait('window.measured', 300);
    if (page.noise.length > 0) throw new Error(page.noise.join('\n'));
    return measured;
  } finally {
    await page.close();
    server.close();
    rmSync(folder, { recursive: true });
  }
}
