import 'uplot/dist/uPlot.min.css';
import '../style.css';
import './clip.css';
import { h } from '../base/dom.js';
import { readModel } from '../model/model.js';
import { decodePictures } from '../model/pictures.js';
import { addTab } from '../panels/tabs.js';
import { start } from '../viewer.js';
import { eventKeys, fillEvents } from './events_panel.js';
import { fillHeat } from './heat_panel.js';
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

function addReportTab(name) {
  document.getElementById('title').before(h('a', { href: 'index.html', class: 'back', title: 'All clips of the library' }, '← Library'));
  return addTab(name);
}

// All that a character's clips do to its skin, on the character at rest.
async function showCharacter(row, { rows, fits }) {
  await Promise.all([load(`${row.body}.js`), load(`${row.body}_heat.js`)]);
  const { character, heat } = spherechain;
  const model = readModel({ ...character, title: row.character, radius: 'detect', report: null, clips: [{ name: 'all clips', first: 0, count: 1, own_count: 1 }] });
  await decodePictures(model);
  const panel = addReportTab('Heat');
  document.getElementById('tab-contacts').remove();
  document.body.classList.add('heat');
  const viewer = start(model);
  viewer.store.set({ look: false }); // the heat's colours alone
  fillHeat(panel, { rows: rows.filter((other) => other.data && other.character === row.character), fit: fits[row.body], heat, ...viewer });
}

async function main() {
  globalThis.spherechain = {};
  await load('library.js');
  const { rows, fits } = spherechain.library;
  const link = readLink();
  const row = rows.find(({ character, clip, data }) => data && character === link.character && (link.clip ?? clip) === clip);
  if (!row) return say('This report has no such clip.');
  if (link.clip === null) return showCharacter(row, spherechain.library);
  await Promise.all([load(`${row.body}.js`), load(`${row.data}.js`)]);
  const { character, clip } = spherechain;
  const model = readModel({
    ...character,
    ...clip,
    title: row.character,
    radius: 'detect',
    report: null,
    clips: [{ name: row.clip, first: 0, count: clip.frames.count, own_count: row.frames }],
  });
  await decodePictures(model);
  const panel = addReportTab('Events');
  const viewer = start(model, eventKeys);
  document.title = `${row.character} ${row.clip} · spherechain`;
  fillEvents(panel, { rows, row, fit: fits[row.body], model, pokes: clip.pokes, ...viewer });
}

main().catch((error) => say(`The report is not whole: ${error.message}.`));
// Another event of this clip needs no new data; another clip does.
addEventListener('hashchange', () => location.reload());
