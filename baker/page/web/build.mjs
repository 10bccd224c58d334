// Bundles the page into one file that needs no other: node build.mjs OUT.html
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const out = process.argv[2];
if (!out) throw new Error('build.mjs: say which file to write');
const here = dirname(fileURLToPath(import.meta.url));
const read = (file) => readFileSync(join(here, file), 'utf8');

const licences = ['three', 'uplot'].map((name) => `${name}\n\n${read(`node_modules/${name}/LICENSE`)}`);
const { outputFiles } = await build({
  absWorkingDir: here,
  entryPoints: ['src/main.js'],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  outdir: 'out',
  write: false,
  define: { LICENCES: JSON.stringify(licences.join('\n\n')) },
});
const text = (extension) => outputFiles.find(({ path }) => path.endsWith(extension)).text;

// Nothing in a script or style may end it.
const script = text('.js').replaceAll('</script', '<\\/script');
const style = text('.css').replaceAll('</style', '<\\/style');
const page = read('index.html')
  .replace('<!-- style -->', () => `<style>${style}</style>`)
  .replace('<!-- script -->', () => `<script>${script}</script>`);
mkdirSync(dirname(out), { recursive: true });
writeFileSync(out, page);
