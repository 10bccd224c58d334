import { css, fitCanvas, h } from '../base/dom.js';
import { millimetres } from '../model/contacts.js';
import { characterLink, clipLink } from './links.js';
import { isAccepted, isFault, kindText, percent, rankOf } from './marks.js';

// The library by clips: a row each. A row draws its strip once it comes into sight.

export function digest(row, index) {
  const events = (row.events ?? []).filter((event) => event.state !== 'resolved');
  const open = events.filter((event) => isFault(event) && !event.rule);
  const pokes = events.filter((event) => event.class === 'poke').sort((a, b) => b.area_cm2 - a.area_cm2);
  const worst = [...open].sort((a, b) => rankOf(b) - rankOf(a) || b.depth_mm - a.depth_mm)[0];
  return {
    ...row,
    index,
    open,
    worst,
    pokes,
    resolved: (row.events ?? []).length - events.length,
    faults: open.length,
    fresh: open.filter((event) => event.state === 'new' && !isAccepted(row, event)).length,
    accepted: open.filter((event) => isAccepted(row, event)).length,
    mm: worst?.depth_mm ?? 0,
    percent: worst?.depth_percent ?? 0,
    words: `${row.character} ${row.clip} ${open.map(({ parts }) => parts.join(' ')).join(' ')} ${row.error ?? ''}`.toLowerCase(),
  };
}

export const COLUMNS = [
  { name: '', of: null, class: 'picture' },
  { name: 'Character', of: (row) => row.character },
  { name: 'Clip', of: (row) => row.clip },
  { name: 'Frames', of: (row) => row.frames ?? -1, class: 'number' },
  { name: 'Depth over time', of: null },
  { name: 'Worst fault', of: (row) => row.worst?.text ?? '' },
  { name: 'Depth', of: (row) => (row.error ? Infinity : row.mm), class: 'number', title: 'Of the worst fault, in mm', isFirst: true },
  { name: '%', of: (row) => (row.error ? Infinity : row.percent), class: 'number', title: 'Of the worst fault, in percent of the height' },
  { name: 'Faults', of: (row) => row.faults, class: 'number', title: 'Parts inside others, penetrations and deep folds that no rule excuses' },
  { name: 'New', of: (row) => row.fresh, class: 'number', title: 'Neither in the baseline nor accepted here' },
  { name: 'Poke-through', of: (row) => row.pokes.length, class: 'number', title: 'Spots where skin shows through clothes, a warning; the link leads to the largest' },
  { name: 'Fit', of: (row) => row.fit ?? '', title: 'How well the spheres fit the character' },
];

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

export function elements(row) {
  if (row.error || !row.data) {
    const what = row.error ?? 'no clips: --motion gives it some';
    return [
      h(
        'tr',
        { class: row.error ? 'broken' : 'idle' },
        h('td', { class: 'picture' }),
        h('th', { scope: 'row' }, row.character),
        h('td', {}, row.clip),
        h('td', { colspan: COLUMNS.length - 3 }, what),
      ),
    ];
  }
  const link = clipLink(row, row.worst ? row.events.indexOf(row.worst) : null);
  const strip = h('canvas', { class: 'strip', 'data-strip': row.strip, title: `Depth over ${row.frames} frames; full height is ${STRIP_MM} mm` });
  sight.observe(strip);
  const number = (value) => h('td', { class: 'number' }, value);
  return [
    h(
      'tr',
      { onclick: (event) => !event.target.closest('a') && (location.href = link) },
      h('td', { class: 'picture' }, h('img', { src: row.picture, loading: 'lazy', alt: '', width: 72, height: 72 })),
      h('th', { scope: 'row' }, h('a', { href: characterLink(row), title: 'Where on its skin all its faults are' }, row.character)),
      h('td', {}, h('a', { href: link }, row.clip)),
      number(row.frames.toLocaleString('en')),
      h('td', {}, strip),
      h('td', { class: row.worst ? '' : 'clean' }, row.worst ? `${row.worst.text}, ${kindText(row.worst)}frame ${row.worst.deepest}` : 'clean'),
      number(row.worst ? millimetres(row.mm) : ''),
      number(row.worst ? percent(row.percent) : ''),
      number(row.faults || ''),
      h('td', { class: `number${row.fresh > 0 ? ' warning' : ''}` }, row.fresh || (row.faults > 0 ? '0' : '')),
      h('td', { class: 'number' }, row.pokes.length > 0 && h('a', { href: clipLink(row, row.events.indexOf(row.pokes[0])) }, `${row.pokes.length}, ${row.pokes[0].area_cm2} cm²`)),
      h('td', { class: `fit ${row.fit}` }, row.fit),
    ),
  ];
}
