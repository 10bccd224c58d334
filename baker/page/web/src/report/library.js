import '../style.css';
import './library.css';
import { css, fitCanvas, h } from '../base/dom.js';
import { plural } from '../base/format.js';
import { characterLink, clipLink } from './links.js';
import { insideText } from '../model/contacts.js';
import { baseline, download, isAccepted, isFault, onMarks, rankOf } from './marks.js';
import { followTheme } from './theme.js';

// The library: a row a clip. A row draws its strip once it comes into sight.

const $ = (id) => document.getElementById(id);

const millimetres = (mm) => (mm < 9.95 ? mm.toFixed(1) : `${Math.round(mm)}`);

function digest(row, index) {
  const events = (row.events ?? []).filter((event) => event.state !== 'resolved');
  const open = events.filter((event) => isFault(event) && !event.rule);
  const worst = [...open].sort((a, b) => rankOf(b) - rankOf(a) || b.depth_mm - a.depth_mm)[0];
  return {
    ...row,
    index,
    open,
    worst,
    resolved: (row.events ?? []).length - events.length,
    faults: open.length,
    fresh: open.filter((event) => event.state === 'new' && !isAccepted(row, event)).length,
    accepted: open.filter((event) => isAccepted(row, event)).length,
    mm: worst?.depth_mm ?? 0,
    words: `${row.character} ${row.clip} ${open.map(({ parts }) => parts.join(' ')).join(' ')} ${row.error ?? ''}`.toLowerCase(),
  };
}

const kindText = (event) => (event.class === 'inside' ? `${insideText(event)}, ` : event.class === 'deep_fold' ? 'deep fold, ' : '');

const COLUMNS = [
  { name: '', of: null, class: 'picture' },
  { name: 'Character', of: (row) => row.character },
  { name: 'Clip', of: (row) => row.clip },
  { name: 'Frames', of: (row) => row.frames ?? -1, class: 'number' },
  { name: 'Depth over time', of: null },
  { name: 'Worst fault', of: (row) => row.worst?.text ?? '' },
  { name: 'Depth', of: (row) => (row.error ? Infinity : row.mm), class: 'number', title: 'Of the worst fault, in mm' },
  { name: 'Faults', of: (row) => row.faults, class: 'number', title: 'Parts inside others, penetrations and deep folds that no rule excuses' },
  { name: 'New', of: (row) => row.fresh, class: 'number', title: 'Neither in the baseline nor accepted here' },
  { name: 'Fit', of: (row) => row.fit ?? '', title: 'How well the spheres fit the character' },
];

const STATES = {
  All: () => true,
  Faults: (row) => row.faults > 0 || row.error,
  New: (row) => row.fresh > 0 || row.error,
  Clean: (row) => row.faults === 0 && !row.error,
};

// Half millimetres a bar; the same scale in all rows, so that rows compare.
const STRIP_MM = 60;
function drawStrip(canvas, strip) {
  const bars = Uint8Array.from(atob(strip), (c) => c.charCodeAt(0));
  const { context, width, height } = fitCanvas(canvas);
  const wide = width / bars.length;
  context.fillStyle = css('--line');
  context.fillRect(0, height - 1, width, 1);
  context.fillStyle = css('--warning');
  bars.forEach((half, i) => {
    if (half === 0) return;
    const high = Math.max(2, (Math.min(half / 2, STRIP_MM) / STRIP_MM) * (height - 1));
    context.fillRect(i * wide, height - 1 - high, Math.max(wide, 1), high);
  });
}

const ROWS = 100; // made at a time

const sight = new IntersectionObserver(
  (entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      sight.unobserve(target);
      drawStrip(target, target.dataset.strip);
    }
  },
  { root: document.querySelector('main'), rootMargin: '300px' },
);

function element(row) {
  if (row.error || !row.data) {
    const what = row.error ?? 'no clips: --motion gives it some';
    return h(
      'tr',
      { class: row.error ? 'broken' : 'idle' },
      h('td', { class: 'picture' }),
      h('th', { scope: 'row' }, row.character),
      h('td', {}, row.clip),
      h('td', { colspan: COLUMNS.length - 3 }, what),
    );
  }
  const link = clipLink(row, row.worst ? row.events.indexOf(row.worst) : null);
  const strip = h('canvas', { class: 'strip', 'data-strip': row.strip, title: `Depth over ${row.frames} frames; full height is ${STRIP_MM} mm` });
  sight.observe(strip);
  const number = (value) => h('td', { class: 'number' }, value);
  return h(
    'tr',
    { onclick: (event) => !event.target.closest('a') && (location.href = link) },
    h('td', { class: 'picture' }, h('img', { src: row.picture, loading: 'lazy', alt: '', width: 72, height: 72 })),
    h('th', { scope: 'row' }, h('a', { href: characterLink(row), title: 'Where on its skin all its faults are' }, row.character)),
    h('td', {}, h('a', { href: link }, row.clip)),
    number(row.frames.toLocaleString('en')),
    h('td', {}, strip),
    h('td', { class: row.worst ? '' : 'clean' }, row.worst ? `${row.worst.text}, ${kindText(row.worst)}frame ${row.worst.deepest}` : 'clean'),
    number(row.worst ? `${millimetres(row.mm)} mm` : ''),
    number(row.faults || ''),
    h('td', { class: `number${row.fresh > 0 ? ' warning' : ''}` }, row.fresh || (row.faults > 0 ? '0' : '')),
    h('td', { class: `fit ${row.fit}` }, row.fit),
  );
}

function summaryText({ characters, clips, frames, errors }, rows) {
  const sum = (key) => rows.reduce((total, row) => total + row[key], 0);
  const parts = [plural(characters, 'character'), plural(clips, 'clip'), plural(frames, 'frame'), plural(sum('faults'), 'fault'), `${sum('fresh')} new`];
  if (sum('accepted') > 0) parts.push(`${sum('accepted')} accepted`);
  if (sum('resolved') > 0) parts.push(`${sum('resolved')} resolved`);
  if (errors > 0) parts.push(`${errors} not checked`);
  return parts.join(' · ');
}

function start(library) {
  let rows = library.rows.map(digest);
  const state = { sort: COLUMNS.findIndex(({ name }) => name === 'Depth'), down: true, filter: '', show: 'All' };

  // Rows are made as they come near.
  let left = [];
  const drawMore = () => {
    $('rows').append(...left.splice(0, ROWS).map(element));
    end.unobserve($('end'));
    if (left.length > 0) end.observe($('end'));
  };
  const end = new IntersectionObserver((entries) => entries.at(-1).isIntersecting && drawMore(), { root: document.querySelector('main'), rootMargin: '1500px' });

  const draw = () => {
    const { of } = COLUMNS[state.sort];
    const words = state.filter.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = rows.filter((row) => STATES[state.show](row) && words.every((word) => row.words.includes(word)));
    const compare = (a, b) => (typeof a === 'string' ? a.localeCompare(b, 'en', { numeric: true }) : a - b);
    shown.sort((a, b) => (state.down ? -1 : 1) * (compare(of(a), of(b)) || 0) || a.index - b.index);
    $('rows').replaceChildren();
    left = shown;
    drawMore();
    $('none').hidden = $('rows').children.length > 0;
    [...$('heads').children].forEach((head, i) => head.setAttribute('aria-sort', i !== state.sort ? 'none' : state.down ? 'descending' : 'ascending'));
    $('summary').textContent = summaryText(library, rows);
    for (const button of $('states').children) button.setAttribute('aria-pressed', button.textContent === state.show);
  };

  $('heads').append(
    ...COLUMNS.map((column, i) =>
      h(
        'th',
        { scope: 'col', class: column.class, title: column.title },
        column.of === null
          ? column.name
          : h('button', { type: 'button', onclick: () => {
              state.down = state.sort === i ? !state.down : column.class === 'number';
              state.sort = i;
              draw();
            } }, column.name),
      ),
    ),
  );
  $('states').append(...Object.keys(STATES).map((name) => h('button', { type: 'button', onclick: () => { state.show = name; draw(); } }, name)));
  $('filter').addEventListener('input', ({ target }) => {
    state.filter = target.value;
    draw();
  });
  $('export').addEventListener('click', () => download('baseline.json', `${JSON.stringify(baseline(library.rows), null, 1)}\n`));
  onMarks(() => {
    rows = library.rows.map(digest);
    draw();
  });
  addEventListener('pageshow', ({ persisted }) => persisted && location.reload());
  followTheme($('theme'), draw);
  window.spherechainReport = Object.freeze({ rows: () => rows.length, ready: true });
}

if (spherechain.library) start(spherechain.library);
else document.body.replaceChildren(h('p', { class: 'template' }, 'This is the template of `spherechain check`: it has no library in it yet.'));
