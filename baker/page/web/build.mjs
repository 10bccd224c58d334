// Bundles each page into one file that needs no other: node build.mjs FOLDER [RUNTIME]. RUNTIME is the runtime's JavaScript
// package, for the page of `view`; without it that page finds no contacts of its own.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const [folder, runtime] = process.argv.slice(2);
if (!folder) throw new Error('build.mjs: say which folder to write to');
const here = dirname(fileURLToPath(import.meta.url));
const read = (file) => readFileSync(join(here, file), 'utf8');

const licences = ['three', 'uplot'].map((name) => `${name}\n\n${read(`node_modules/${name}/LICENSE`)}`);

async function make(name, entry, template, withRuntime = false) {
  const { outputFiles } = await build({
    absWorkingDir: here,
    entryPoints: [entry],
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2022',
    outdir: 'out',
    write: false,
    alias: { spherechain: withRuntime ? runtime : './src/editor/no_runtime.js' },
    define: { LICENCES: JSON.stringify(licences.join('\n\n')) },
  });
  const text = (extension) => outputFiles.find(({ path }) => path.endsWith(extension)).text;
  // Nothing in a script or style may end it.
  const script = text('.js').replaceAll('</script', '<\\/script');
  const style = text('.css').replaceAll('</style', '<\\/style');
  const page = template
    .replace('<html', withRuntime ? '<html data-runtime' : '<html')
    .replace('<!-- style -->', () => `<style>${style}</style>`)
    .replace('<!-- script -->', () => `<script>${script}</script>`);
  writeFileSync(join(folder, name), page);
}

mkdirSync(folder, { recursive: true });
await make('viewer.html', 'src/main.js', read('index.html'), Boolean(runtime));
await make('report_clip.html', 'src/report/clip.js', read('index.html'));
await make('report_index.html', 'src/report/library.js', read('library.html'));
await make('report_score.html', 'src/report/score.js', read('score.html'));
