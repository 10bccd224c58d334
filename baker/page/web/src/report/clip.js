import 'uplot/dist/uPlot.min.css';
import '../style.css';
import './clip.css';
import { h } from '../dom.js';
import { readModel } from '../model.js';
import { start } from '../viewer.js';
import { fillEvents } from './events_panel.js';
import { readLink } from './links.js';

// A clip of a report: the viewer, with the clip's events. Pages from disk may not fetch: data are scripts.

const load = (file) =>
  new Promise((done, failed) => {
    const script = h('script', { src: file });
    script.addEventListener('load', done);
    script.addEventListener('error', () => failed(new Error(`${file} is not in the report's folder`)));
    document.head.append(script);
  });

const say = (text) =>
  document.body.replaceChildren(h('p', { class: 'template' }, text, ' ', h('a', { href: 'index.html' }, 'To the library')));

function addEventsTab() {
  const tabs = document.querySelector('[role=tablist]');
  const tab = h('button', { type: 'button', role: 'tab', id: 'tab-events', 'aria-controls': 'events', 'aria-selected': 'true' }, 'Events');
  const panel = h('div', { role: 'tabpanel', id: 'events', 'aria-labelledby': 'tab-events' });
  for (const other of tabs.children) Object.assign(other, { tabIndex: -1 }).setAttribute('aria-selected', false);
  tabs.prepend(tab);
  tabs.after(panel);
  document.getElementById('contacts').hidden = true;
  document.getElementById('tab-contacts').textContent = 'This frame';
  document.getElementById('tab-bake').remove();
  document.getElementById('title').before(h('a', { href: 'index.html', class: 'back', title: 'All clips of the library' }, '← Library'));
  return panel;
}

async function main() {
  globalThis.spherechain = {};
  await load('library.js');
  const { rows } = spherechain.library;
  const link = readLink();
  const row = rows.find(({ character, clip, data }) => data && character === link.character && clip === link.clip);
  if (!row) return say('This report has no such clip.');
  await Promise.all([load(`${row.body}.js`), load(`${row.data}.js`)]);
  const { character, clip } = spherechain;
  const model = readModel({
    ...character,
    ...clip,
    title: row.character,
    radius: 'detect',
    report: null,
    clips: [{ name: row.clip, first: 0, count: clip.frames.count, own_count: clip.frames.count }],
  });
  const panel = addEventsTab();
  const viewer = start(model);
  document.title = `${row.character} ${row.clip} · spherechain`;
  fillEvents(panel, { rows, row, model, ...viewer });
}

main().catch((error) => say(`The report is not whole: ${error.message}.`));
// Another event of this clip needs no new data; another clip does.
addEventListener('hashchange', () => location.reload());
