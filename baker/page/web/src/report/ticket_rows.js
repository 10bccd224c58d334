import { h } from '../base/dom.js';
import { plural } from '../base/format.js';
import { millimetres } from '../model/contacts.js';
import { characterLink, clipLink } from './links.js';
import { isAccepted, kindText, percent } from './marks.js';

// The library by tickets: a row each, with its worst event. A button opens its other events below it.

const opened = new Set(); // ids

export function digest(ticket, index, rows) {
  const events = ticket.events.map(([row, event]) => ({ row: rows[row], event: rows[row].events[event], index: event }));
  const [{ row, event }] = events;
  const clips = [...new Set(events.map((shown) => shown.row.clip))];
  return {
    ...ticket,
    index,
    events,
    character: row.character,
    clips,
    text: event.text,
    mm: event.depth_mm,
    percent: event.depth_percent,
    faults: events.length,
    fresh: events.filter((shown) => shown.event.state === 'new' && !isAccepted(shown.row, shown.event)).length,
    words: `${row.character} ${clips.join(' ')} ${events.map((shown) => shown.event.parts.join(' ')).join(' ')} ${ticket.id}`.toLowerCase(),
  };
}

export const COLUMNS = [
  { name: '', of: null, class: 'picture' },
  { name: 'Character', of: (ticket) => ticket.character },
  { name: 'Clip', of: (ticket) => ticket.clips[0] },
  { name: 'Worst fault', of: (ticket) => ticket.text },
  { name: 'Severity', of: (ticket) => ticket.severity, class: 'number', title: 'Depth in percent of the height, more where a part is inside another, by its time; less where no eye sees it', isFirst: true },
  { name: 'Depth', of: (ticket) => ticket.mm, class: 'number', title: 'Of the worst fault, in mm' },
  { name: '%', of: (ticket) => ticket.percent, class: 'number', title: 'Of the worst fault, in percent of the height' },
  { name: 'Faults', of: (ticket) => ticket.faults, class: 'number', title: 'Parts inside others, penetrations and deep folds of one cause' },
  { name: 'New', of: (ticket) => ticket.fresh, class: 'number', title: 'Neither in the baseline nor accepted here' },
];

const frames = ({ from, to, deepest }) => (from === to ? `frame ${from}` : `frames ${from}–${to}, worst at ${deepest}`);
const number = (value, more = '') => h('td', { class: `number${more}` }, value);

function below({ row, event, index }) {
  const link = clipLink(row, index);
  return h(
    'tr',
    { class: 'below', onclick: (click) => !click.target.closest('a') && (location.href = link) },
    h('td'),
    h('td'),
    h('td', {}, row.clip),
    h('td', {}, h('a', { href: link }, event.text), `, ${kindText(event)}${frames(event)}`),
    h('td'),
    number(millimetres(event.depth_mm)),
    number(percent(event.depth_percent)),
    h('td'),
    number(isAccepted(row, event) ? 'accepted' : event.state, event.state === 'new' && !isAccepted(row, event) ? ' warning' : ''),
  );
}

export function elements(ticket) {
  const [{ row, event, index }, ...others] = ticket.events;
  const link = clipLink(row, index);
  const more = others.map(below);
  const show = () => {
    for (const line of more) line.hidden = !opened.has(ticket.id);
    button.setAttribute('aria-expanded', opened.has(ticket.id));
  };
  const toggle = () => {
    if (!opened.delete(ticket.id)) opened.add(ticket.id);
    show();
  };
  const button = h('button', { type: 'button', class: 'more', onclick: toggle }, `and ${plural(others.length, 'other')}`);
  show();
  return [
    h(
      'tr',
      { onclick: (click) => !click.target.closest('a, button') && (location.href = link) },
      h('td', { class: 'picture' }, h('img', { src: ticket.picture, loading: 'lazy', alt: '', width: 72, height: 72 })),
      h('th', { scope: 'row' }, h('a', { href: characterLink(row), title: 'Where on its skin all its faults are' }, ticket.character)),
      h('td', {}, ticket.clips.length > 1 ? `${row.clip} and ${ticket.clips.length - 1} like it` : row.clip),
      h('td', {}, h('a', { href: link }, event.text), `, ${kindText(event)}${frames(event)}`, others.length > 0 && ' ', others.length > 0 && button),
      number(ticket.severity.toFixed(1)),
      number(millimetres(ticket.mm)),
      number(percent(ticket.percent)),
      number(ticket.faults),
      number(ticket.fresh, ticket.fresh > 0 ? ' warning' : ''),
    ),
    ...more,
  ];
}
