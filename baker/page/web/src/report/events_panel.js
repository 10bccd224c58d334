import { h } from '../base/dom.js';
import { insideText, millimetres } from '../model/contacts.js';
import { decode } from '../model/frame_lists.js';
import { clipLink, readLink } from './links.js';
import { isAccepted, isFault, onMarks, percent, toggleAccepted } from './marks.js';

// The clip's events. One is chosen: the page is at its deepest frame, and the camera where it is seen.

const timecode = (frame, fps) => {
  const seconds = Math.floor(frame / fps);
  const two = (value) => `${value}`.padStart(2, '0');
  return `${two(Math.floor(seconds / 60))}:${two(seconds % 60)}:${two(Math.floor(frame - seconds * fps))}`;
};

// Skin in one colour, the piece that it shows through in another, and what shows in a third: linear, of 255, and as the
// legend has them.
const SKIN = [225, 130, 75, 170];
const CLOTH = [35, 90, 200, 170];
const SHOWS = [222, 198, 14, 255];
const LEGEND = [['#f0e442', 'what shows'], ['#f1bd93', 'the skin'], ['#67a0e5', 'what it shows through']];

function paintPoke(skinLayer, { pieces, triangles }) {
  const shows = new Set(decode(triangles, Uint32Array));
  const isIn = (t, [first, count]) => t >= first && t < first + count;
  skinLayer.paint((t) => (shows.has(t) ? SHOWS : isIn(t, pieces[0]) ? SKIN : isIn(t, pieces[1]) ? CLOTH : null));
}

const sizeText = (event) =>
  event.class === 'poke'
    ? `${event.area_cm2} cm²`
    : `${millimetres(event.depth_mm)}${event.depth_percent === undefined ? '' : `, ${percent(event.depth_percent)}`}`;
const classText = (event) =>
  event.class === 'poke' ? `poke-through, ${millimetres(event.height_mm)} high, a warning` : (event.class === 'inside' ? insideText(event) : event.class.replace('_', ' '));

// The bake's spheres, with the verdict on them: the skin's contacts do not depend on it.
export function spheresSection(store, fit) {
  const button = h('button', { type: 'button', id: 'spheres-button', class: 'accept', onclick: () => store.showSpheres(!store.state.spheres) });
  store.watch(['spheres'], ({ spheres }) => {
    button.textContent = spheres ? 'Hide (B)' : 'Show (B)';
    button.setAttribute('aria-pressed', spheres);
  });
  return h('div', { id: 'verdict' }, h('span', {}, `Spheres, ${fit}`), button);
}

// For the list of all keys.
export const eventKeys = [
  ['N', 'Next event, in the next clip too'],
  ['P', 'Previous event, in the previous clip too'],
  ['A', 'Accept the event, or take that back'],
];

export function fillEvents(panel, { rows, row, fit, model, pokes, store, flyToContact, flyToTriangles, skinLayer, redraw }) {
  const events = row.events;
  const names = model.parts.map(({ name }) => name);
  const partOf = (name) => model.parts[names.indexOf(name)]?.part;
  let chosen = readLink().event;

  const go = (index) => {
    const event = events[index];
    if (!event || event.state === 'resolved') return;
    chosen = index;
    history.replaceState(null, '', clipLink(row, index));
    const isPoke = event.class === 'poke';
    const key = isPoke ? null : event.parts.map(partOf).sort((a, b) => a - b).join('-');
    store.set({ frame: event.place, playing: false, contact: key });
    if (isPoke) {
      paintPoke(skinLayer, pokes[event.poke]);
      flyToTriangles(decode(pokes[event.poke].triangles, Uint32Array), event.camera);
    } else {
      skinLayer.paint(() => null);
      flyToContact(key, event.camera);
    }
    redraw();
    draw();
  };

  const state = (event) => {
    if (event.state === 'resolved') return 'resolved';
    if (event.rule) return event.rule;
    if (isAccepted(row, event)) return 'accepted';
    return event.before ? `worse than ${millimetres(event.before)}` : event.state;
  };

  const item = (event, index) => {
    const gone = event.state === 'resolved';
    const frames = event.from === event.to ? `frame ${event.from}` : `frames ${event.from}–${event.to}${event.from > event.to ? ' over the loop' : ''}`;
    return h(
      'li',
      { class: index === chosen ? 'chosen' : '' },
      h(
        'button',
        { type: 'button', class: 'pair event', 'aria-pressed': `${index === chosen}`, disabled: gone, onclick: () => go(index) },
        h('span', { class: 'part-names' }, event.text),
        h('span', { class: 'count' }, sizeText(event)),
        h('span', { class: 'when' }, `${frames}${event.from === event.to ? '' : `, worst at ${event.deepest}`} (${timecode(event.deepest, row.fps)})`),
        h('span', { class: `when ${event.fails && !isAccepted(row, event) ? 'warning' : ''}` }, `${classText(event)}${event.class === 'poke' ? '' : `, ${state(event)}`}${event.volume_ml === undefined ? '' : `, ${event.volume_ml} ml`}`),
      ),
      index === chosen && event.class === 'poke' &&
        h('div', { class: 'poke-legend' }, ...LEGEND.map(([colour, what]) => h('span', { class: 'legend' }, h('span', { class: 'swatch', style: `background: ${colour}` }), what))),
      index === chosen && isFault(event) && !event.rule && event.state !== 'accepted' &&
        h('button', { type: 'button', class: 'accept', onclick: () => { toggleAccepted(row, event); draw(); } }, isAccepted(row, event) ? 'Accepted: take back (A)' : 'Accept (A)'),
    );
  };

  const list = h('ol', { class: 'pairs', id: 'clip-events' });
  const summary = h('p', { class: 'summary', role: 'status' });
  const note = h('p', { class: 'note' }, 'N and P: next and previous event, in the next clip too. Accepted events go into the baseline that the library page exports.');
  panel.append(spheresSection(store, fit), summary, list, note);

  function draw() {
    const excused = events.filter(({ rule }) => rule).length;
    const faults = events.filter((event) => isFault(event) && !event.rule && event.state !== 'resolved').length;
    summary.textContent = (faults === 0 ? 'No fault in this clip' : `${faults} ${faults === 1 ? 'fault' : 'faults'}`) + (pokes.length > 0 ? `, skin shows through clothes ${pokes.length} times` : '') + (excused > 0 ? `, ${excused} more excused by rules` : '');
    list.replaceChildren(...events.map(item));
    list.querySelector('.chosen')?.scrollIntoView({ block: 'nearest' });
  }

  // The next event with a fault, here or in the rows that follow.
  const step = (by) => {
    const stops = rows.flatMap((other) => (other.data ? other.events.map((event, index) => ({ other, event, index })) : []));
    const shown = stops.filter(({ event }) => event.state !== 'resolved');
    const before = ({ other, index }) => rows.indexOf(other) < rows.indexOf(row) || (other === row && index < (chosen ?? (by > 0 ? 0 : -1)));
    const here = shown.findIndex(({ other, index }) => other === row && index === chosen);
    const next = here >= 0 ? shown[here + by] : by > 0 ? shown.find((stop) => !before(stop)) : shown.filter(before).at(-1);
    if (!next) return;
    if (next.other === row) go(next.index);
    else location.href = clipLink(next.other, next.index); // hashchange loads it
  };
  const accept = () => {
    const event = events[chosen];
    if (!event || !isFault(event) || event.rule || event.state === 'accepted') return;
    toggleAccepted(row, event);
    draw();
  };
  const keys = { n: () => step(1), p: () => step(-1), a: accept };
  document.addEventListener(
    'keydown',
    (event) => {
      const action = keys[event.key.toLowerCase()];
      if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      action();
    },
    true,
  );
  onMarks(draw);
  draw();
  if (chosen !== null) go(chosen);
}
