import '../style.css';
import './library.css';
import { h } from '../base/dom.js';
import { plural } from '../base/format.js';
import * as clipRows from './clip_rows.js';
import { baseline, download, onMarks } from './marks.js';
import { followTheme } from './theme.js';
import * as ticketRows from './ticket_rows.js';

// The library: by tickets, the worst first, or by clips (library.html#clips).

const $ = (id) => document.getElementById(id);

const STATES = {
  All: () => true,
  Faults: (row) => row.faults > 0 || row.error,
  New: (row) => row.fresh > 0 || row.error,
  Clean: (row) => row.faults === 0 && !row.error,
};

const ROWS = 100; // made at a time

function summaryText({ characters, clips, frames, errors, tickets }, rows) {
  const sum = (key) => rows.reduce((total, row) => total + row[key], 0);
  const parts = [plural(characters, 'character'), plural(clips, 'clip'), plural(frames, 'frame'), `${plural(sum('faults'), 'fault')} in ${plural(tickets.length, 'ticket')}`, `${sum('fresh')} new`];
  if (sum('accepted') > 0) parts.push(`${sum('accepted')} accepted`);
  if (sum('resolved') > 0) parts.push(`${sum('resolved')} resolved`);
  const pokes = rows.reduce((total, row) => total + row.pokes.length, 0);
  if (pokes > 0) parts.push(`${plural(pokes, 'spot')} of poke-through, by clips`);
  if (errors > 0) parts.push(`${errors} not checked`);
  return parts.join(' · ');
}

function start(library) {
  let clips, tickets;
  const read = () => {
    clips = library.rows.map(clipRows.digest);
    tickets = library.tickets.map((ticket, i) => ticketRows.digest(ticket, i, library.rows));
  };
  read();
  const state = { sort: 0, down: true, filter: '', show: 'All' };
  const view = () => (location.hash === '#clips' ? clipRows : ticketRows);

  // Rows are made as they come near.
  let left = [];
  const drawMore = () => {
    $('rows').append(...left.splice(0, ROWS).flatMap(view().elements));
    end.unobserve($('end'));
    if (left.length > 0) end.observe($('end'));
  };
  const end = new IntersectionObserver((entries) => entries.at(-1).isIntersecting && drawMore(), { root: document.querySelector('main'), rootMargin: '1500px' });

  const draw = () => {
    const { of } = view().COLUMNS[state.sort];
    const words = state.filter.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = (view() === clipRows ? clips : tickets).filter((row) => STATES[state.show](row) && words.every((word) => row.words.includes(word)));
    const compare = (a, b) => (typeof a === 'string' ? a.localeCompare(b, 'en', { numeric: true }) : a - b);
    shown.sort((a, b) => (state.down ? -1 : 1) * (compare(of(a), of(b)) || 0) || a.index - b.index);
    $('rows').replaceChildren();
    left = shown;
    drawMore();
    $('none').hidden = $('rows').children.length > 0;
    [...$('heads').children].forEach((head, i) => head.setAttribute('aria-sort', i !== state.sort ? 'none' : state.down ? 'descending' : 'ascending'));
    $('summary').textContent = summaryText(library, clips);
    for (const button of $('states').children) button.setAttribute('aria-pressed', button.textContent === state.show);
  };

  // The heads of the view, sorted by its first order.
  const drawView = () => {
    const { COLUMNS } = view();
    state.sort = COLUMNS.findIndex(({ isFirst }) => isFirst);
    state.down = true;
    const sortBy = (column, i) => {
      state.down = state.sort === i ? !state.down : column.class === 'number';
      state.sort = i;
      draw();
    };
    $('heads').replaceChildren(
      ...COLUMNS.map((column, i) =>
        h('th', { scope: 'col', class: column.class, title: column.title }, column.of === null ? column.name : h('button', { type: 'button', onclick: () => sortBy(column, i) }, column.name)),
      ),
    );
    for (const link of $('lists').children) link.setAttribute('aria-current', link.hash === '#clips' ? view() === clipRows : view() === ticketRows);
    draw();
  };

  $('states').append(...Object.keys(STATES).map((name) => h('button', { type: 'button', onclick: () => { state.show = name; draw(); } }, name)));
  $('filter').addEventListener('input', ({ target }) => {
    state.filter = target.value;
    draw();
  });
  $('export').addEventListener('click', () => download('baseline.json', `${JSON.stringify(baseline(library.rows), null, 1)}\n`));
  onMarks(() => {
    read();
    draw();
  });
  addEventListener('pageshow', ({ persisted }) => persisted && location.reload());
  addEventListener('hashchange', drawView);
  drawView();
  followTheme($('theme'), draw);
  window.spherechainReport = Object.freeze({ ready: true });
}

if (spherechain.library) start(spherechain.library);
else document.body.replaceChildren(h('p', { class: 'template' }, 'This is the template of `spherechain check`: it has no library in it yet.'));
