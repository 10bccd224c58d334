// SPDX-License-Identifier: MIT
// node build.mjs WASM VERSION FOLDER: the npm package, in FOLDER: one ES module with the WebAssembly inside.
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';

const [wasm, version, folder] = process.argv.slice(2);
const source = name => new URL(name, import.meta.url);
const filled = (name, from, to) => {
  const text = readFileSync(source(name), 'utf8');
  if (!text.includes(from)) throw new Error(`${name} has no ${from}`);
  return text.replaceAll(from, () => to);
};

mkdirSync(folder, { recursive: true });
writeFileSync(`${folder}/index.js`, filled('src/spherechain.js', '@WASM@', readFileSync(wasm, 'base64')));
writeFileSync(`${folder}/package.json`, filled('package.json', '@VERSION@', version));
for (const name of ['index.d.ts', 'README.md', 'src/tool.js', '../LICENSE']) copyFileSync(source(name), `${folder}/${name.split('/').pop()}`);
