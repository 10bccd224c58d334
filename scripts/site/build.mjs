// SPDX-License-Identifier: MIT
// The pages of a site that opens from disk: `node build.mjs ROOT DEMO.html OUT`. They are README.md and every file of ROOT that its
// links lead to. Markdown becomes a page, other text a page of its lines, pictures are copied. The same files give the same bytes.
import { copyFileSync, existsSync, mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, extname, join, posix } from 'node:path';
import { fileURLToPath } from 'node:url';
import hljs from 'highlight.js';
import MarkdownIt from 'markdown-it';

const [root, demo, out] = process.argv.slice(2);
if (!out) throw new Error('usage: build.mjs ROOT DEMO.html OUT');
const here = dirname(fileURLToPath(import.meta.url));
const PICTURES = ['.png', '.jpg', '.svg', '.webp'];
const DEMO = 'demo/index.html';

const escape = (text) => text.replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);
const highlight = (code, language) =>
  hljs.getLanguage(language) ? hljs.highlight(code, { language, ignoreIllegals: true }).value : escape(code);
const md = new MarkdownIt({ html: true, highlight });

// Where a file of the tree lies in the site.
function placeOf(file) {
  if (PICTURES.includes(extname(file))) return file;
  if (!file.endsWith('.md')) return `${file}.html`;
  return file.replace(/README\.md$/, 'index.md').replace(/md$/, 'html');
}
const relative = (from, to) => posix.relative(posix.dirname(from), to) || posix.basename(to);

// As GitHub makes them.
function anchorOf(text, taken) {
  const plain = text.toLowerCase().replace(/[^\p{L}\p{N}\p{M} _-]/gu, '').replaceAll(' ', '-');
  let anchor = plain;
  for (let number = 1; taken.has(anchor); ++number) anchor = `${plain}-${number}`;
  taken.add(anchor);
  return anchor;
}
const textOf = (inline) => inline.children.map(({ type, content }) => (type === 'softbreak' ? ' ' : type.match(/text|code/) ? content : '')).join('');

const queue = ['README.md'];
const found = new Map([['README.md', null]]); // from a file to its page
function take(file, by) {
  if (found.has(file)) return;
  if (!existsSync(join(root, file)) || !statSync(join(root, file)).isFile()) throw new Error(`${by}: ${file}: there is no such file`);
  found.set(file, null);
  queue.push(file);
}

function target(link, file) {
  if (/^[a-z]+:/.test(link)) return link;
  const [path, anchor] = link.split('#');
  if (path === '') return link;
  const to = posix.normalize(posix.join(posix.dirname(file), decodeURIComponent(path)));
  take(to, file);
  return relative(placeOf(file), placeOf(to)) + (anchor ? `#${anchor}` : '');
}

// A page's HTML, its headings, and its text by sections, for the search.
function readPage(file) {
  const tokens = md.parse(readFileSync(join(root, file), 'utf8'), {});
  const page = { file, place: placeOf(file), title: file, headings: [], sections: [] };
  const taken = new Set();
  let section = null;
  tokens.forEach((token, i) => {
    if (token.type === 'heading_open') {
      const text = textOf(tokens[i + 1]);
      const anchor = anchorOf(text, taken);
      token.attrSet('id', anchor);
      if (token.tag === 'h1') page.title = text;
      page.headings.push({ level: Number(token.tag[1]), text, anchor });
      page.sections.push((section = { heading: token.tag === 'h1' ? '' : text, anchor: token.tag === 'h1' ? '' : anchor, text: '' }));
    } else if (token.type === 'inline' && tokens[i - 1].type !== 'heading_open') {
      if (section) section.text += ` ${textOf(token)}`;
    } else if (token.type === 'fence' && section) section.text += ` ${token.content}`;
    for (const child of token.children ?? []) {
      if (child.type === 'link_open') {
        const href = child.attrGet('href');
        child.attrSet('href', target(href, file));
      } else if (child.type === 'image') child.attrSet('src', target(child.attrGet('src'), file));
    }
  });
  page.html = md.renderer
    .render(tokens, md.options, {})
    .replace(/<table>/g, '<div class="wide"><table>')
    .replace(/<\/table>/g, '</table></div>')
    .replace(/<h([2-4]) id="([^"]+)">(.*)<\/h\1>/g, '<h$1 id="$2">$3 <a class="anchor" href="#$2" aria-label="Link to this section">#</a></h$1>');
  return page;
}

function readSource(file) {
  const text = readFileSync(join(root, file), 'utf8');
  const language = { h: 'cpp', hpp: 'cpp', mjs: 'js', cjs: 'js', fbs: 'protobuf' }[extname(file).slice(1)] ?? extname(file).slice(1);
  return { file, place: placeOf(file), title: file, headings: [], sections: [], kind: 'broad', html: `<h1>${escape(file)}</h1><pre><code>${highlight(text, language)}</code></pre>` };
}

while (queue.length > 0) {
  const file = queue.shift();
  if (PICTURES.includes(extname(file))) {
    mkdirSync(join(out, dirname(file)), { recursive: true });
    copyFileSync(join(root, file), join(out, file));
  } else found.set(file, file.endsWith('.md') ? readPage(file) : readSource(file));
}

// The menu: a group for each row of README's table, then all other documents.
const readme = found.get('README.md');
const rows = readFileSync(join(root, 'README.md'), 'utf8').split(/^## /m).find((part) => part.startsWith('Five questions'));
if (!rows) throw new Error('README.md: there is no heading "Five questions"');
const menu = rows
  .split('\n')
  .filter((line) => line.startsWith('| ') && line.includes(']('))
  .map((line) => {
    const [, question, links] = line.split('|').map((cell) => cell.trim());
    return { question, links: [...links.matchAll(/\[([^\]]+)\]\(([^)#]+)\)/g)].map(([, text, file]) => ({ text, place: placeOf(file) })) };
  });
if (menu.length !== 5) throw new Error(`README.md: ${menu.length} questions, not five`);
const listed = new Set(menu.flatMap(({ links }) => links.map(({ place }) => place)));
const others = [...found.values()]
  .filter((page) => page?.file.endsWith('.md') && !listed.has(page.place) && page !== readme)
  .sort((a, b) => (a.title < b.title ? -1 : 1))
  .map(({ title, place }) => ({ text: title, place }));

const version = readFileSync(join(root, 'CMakeLists.txt'), 'utf8').match(/VERSION (\d+\.\d+\.\d+)/)[1];
const template = readFileSync(join(here, 'page.html'), 'utf8');
function write(page) {
  const to = (place) => relative(page.place, place);
  const item = ({ text, place }) => `<li><a href="${to(place)}"${place === page.place ? ' aria-current="page"' : ''}>${escape(text[0].toUpperCase() + text.slice(1))}</a></li>`;
  const group = ({ question, links }, open) =>
    `<details${open || links.some(({ place }) => place === page.place) ? ' open' : ''}><summary>${escape(question)}</summary><ul>${links.map(item).join('')}</ul></details>`;
  const contents = page.headings.filter(({ level }) => level === 2);
  const values = {
    title: page === readme ? 'spherechain: where an animated character penetrates itself' : `${page.title} - spherechain`,
    up: to('site').slice(0, -4),
    home: to('index.html'),
    demo: to(DEMO),
    here: page.place === DEMO ? ' aria-current="page"' : '',
    menu: menu.map((row) => group(row, true)).join('') + group({ question: 'All other pages', links: others }, false),
    kind: page.kind ?? (page === readme ? 'home' : ''),
    contents: contents.length < 3 ? '' : `<nav class="contents" aria-label="On this page"><p>On this page</p><ul>${contents.map(({ text, anchor }) => `<li><a href="#${anchor}">${escape(text)}</a></li>`).join('')}</ul></nav>`,
    content: page.html,
    foot: `spherechain ${version}. This page is ${page.file} of the repository.`,
  };
  mkdirSync(join(out, dirname(page.place)), { recursive: true });
  writeFileSync(join(out, page.place), template.replace(/\{\{(\w+)\}\}/g, (_, name) => values[name]));
}
for (const page of found.values()) if (page) write(page);
write({ file: 'scripts/site/demo.html', place: DEMO, title: 'Live demo', headings: [], kind: 'broad', html: readFileSync(join(here, 'demo.html'), 'utf8') });
copyFileSync(demo, join(out, 'demo/human.html'));

// A page from disk may not fetch an index, so that the index is a script.
const sections = [...found.values()].flatMap((page) =>
  (page?.sections ?? []).map(({ heading, anchor, text }) => [page.place + (anchor ? `#${anchor}` : ''), page.title, heading, text.replace(/\s+/g, ' ').trim()]),
);
const folder = createRequire(import.meta.url).resolve('minisearch').replace(/dist.*/, '');
const minisearch = readFileSync(join(folder, 'dist/umd/index.js'), 'utf8');
const licence = readFileSync(join(folder, 'LICENSE.txt'), 'utf8');
writeFileSync(join(out, 'search.js'), `/* MiniSearch\n${licence}*/\n${minisearch.replace(/\n\/\/# sourceMappingURL.*/, '')}\nwindow.SECTIONS = ${JSON.stringify(sections)};\n`);
for (const name of ['site.css', 'site.js']) copyFileSync(join(here, name), join(out, name));
console.log(`${[...found.values()].filter(Boolean).length + 1} pages, ${sections.length} sections to search`);
