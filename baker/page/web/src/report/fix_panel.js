import './clip.css';
import { commandBlock, h } from '../base/dom.js';
import { plural } from '../base/format.js';
import { keyOf, millimetres } from '../model/contacts.js';
import { download } from './marks.js';

// The events of a clip before and after `fix`. One is chosen: its window plays again and again, and the camera is where it is
// seen. Each can be refused; `fix --decisions` reads the file that is saved.

const VERDICTS = { changes_pose: 'changes the pose', visible: 'visible', small: 'small', unchanged: 'unchanged' };
const LEFT_ALONE = ['fold', 'accepted']; // nothing to decide

// For the list of all keys.
export const fixKeys = [
  ['N', 'Next event'],
  ['P', 'Previous event'],
  ['A', 'Accept what was done for the event'],
  ['R', 'Refuse it: the event stays as animated'],
];

// Refused events of all clips of this report, until they are saved. Pages of one folder share them.
const STORE = `spherechain-fix ${location.pathname.replace(/[^/]*$/, '')}`;
const identity = ({ parts, from, to }) => JSON.stringify([parts, from, to]);

function readStore() {
  try {
    return JSON.parse(localStorage.getItem(STORE)) ?? {};
  } catch {
    return {}; // no storage for files, or another's content
  }
}

function writeStore(clip, decisions) {
  try {
    localStorage.setItem(STORE, JSON.stringify({ ...readStore(), [clip]: decisions }));
  } catch {
    // Kept for this page only.
  }
}

const decisionOf = (clip, { parts, from, to }, isRefused) => ({ clip, parts, from, to, decision: isRefused ? 'refuse' : 'accept' });
const framesText = ({ from, to }) => (from === to ? `frame ${from}` : `frames ${from}–${to}`);
const nameOf = (event) => `${event.parts.join(', ')}, ${framesText(event)}`;
const listText = (sizes, text) => Object.entries(sizes).map(([name, size]) => `${name} ${text(size)}`);

const turned = ({ acting }) => Object.keys(acting.turns_degrees).filter((joint) => acting.turns_degrees[joint] > 0.5);
// Whether two events need one joint at the same time: then one keeps the other's turns.
const overlap = (a, b) => a.acting.from <= b.to + 1 && b.from - 1 <= a.acting.to && turned(a).some((joint) => turned(b).includes(joint));

export function fillFixPanel(panel, { model, store, flyToContact }) {
  const clip = model.clips[0];
  const rank = ({ acting }) => Object.keys(VERDICTS).indexOf(acting.verdict);
  const most = ({ acting }) => Object.values(acting.moves_mm)[0] ?? 0;
  const events = [...model.change.events].sort((a, b) => rank(a) - rank(b) || most(b) - most(a) || a.from - b.from);
  const all = model.change.events;
  const isOpen = ({ outcome }) => !LEFT_ALONE.includes(outcome);
  const stored = (readStore()[clip.name] ?? []).filter(({ decision }) => decision === 'refuse').map(identity);
  const isStored = clip.name in readStore();
  const refused = new Set(events.filter((event) => isOpen(event) && (isStored ? stored.includes(identity(event)) : event.outcome === 'refused')));
  let chosen = null;

  const partOf = (name) => model.parts.find((part) => part.name === `before: ${name}`)?.part;
  const place = (frame) => Math.min(Math.max(frame, 0), clip.count - 1);

  const go = (event) => {
    if (!event) return;
    chosen = event;
    const { from, to } = event.acting;
    const key = keyOf(event.parts.map(partOf));
    const loop = { first: place(from), count: place(to) - place(from) + 1 };
    const { showing } = store.state;
    store.set({ frame: place(event.deepest), playing: false, contact: key, loop, showing: showing === 'beside' ? 'ghost' : showing });
    flyToContact(key, null, 1.7);
    store.set({ playing: !matchMedia('(prefers-reduced-motion: reduce)').matches });
    draw();
  };
  const step = (by) => go(events[chosen === null ? (by > 0 ? 0 : events.length - 1) : events.indexOf(chosen) + by]);

  const decide = (isRefused) => {
    if (chosen === null || !isOpen(chosen)) return;
    if (isRefused) refused.add(chosen);
    else refused.delete(chosen);
    writeStore(clip.name, decisions());
    draw();
  };
  const refuseAll = (these) => {
    for (const event of these) refused.add(event);
    decide(true);
  };
  const decisions = () => all.filter(isOpen).map((event) => decisionOf(clip.name, event, refused.has(event)));
  const save = () => {
    const others = Object.entries(readStore()).flatMap(([name, list]) => (name === clip.name ? [] : list));
    download('decisions.json', `${JSON.stringify({ spherechain_decisions: [...decisions(), ...others] }, null, 1)}\n`);
  };

  const button = (text, title, pressed, onclick) => h('button', { type: 'button', title, 'aria-pressed': `${pressed}`, onclick }, text);
  const details = (event) => {
    const { acting } = event;
    const moves = listText(acting.moves_mm, (mm) => millimetres(mm));
    const turns = listText(acting.turns_degrees, (degrees) => `${degrees.toFixed(1)}°`);
    const holders = refused.has(event) ? events.filter((other) => other !== event && !refused.has(other) && isOpen(other) && overlap(event, other)) : [];
    const line = (name, values) => values.length > 0 && h('p', { class: 'when' }, h('b', {}, name), ` ${values.slice(0, 6).join(', ')}${values.length > 6 ? ' …' : ''}`);
    return h(
      'div',
      { class: 'event-details' },
      line('Moves', moves),
      line('Turns', turns),
      acting.step_percent >= 0.05 && line('Extra step', [`${acting.step_percent.toFixed(1)} % of the height a frame`]),
      isOpen(event) &&
        h(
          'div',
          { class: 'segments', role: 'group', 'aria-label': 'Decision' },
          button('Accept', 'Take what was done (A)', !refused.has(event), () => decide(false)),
          button('Refuse', 'Leave it as animated (R)', refused.has(event), () => decide(true)),
        ),
      holders.length > 0 &&
        h(
          'p',
          { class: 'held' },
          `Where it meets ${holders.slice(0, 3).map(nameOf).join('; ')}${holders.length > 3 ? ` and ${holders.length - 3} more` : ''}, the limb stays as it is there. `,
          h('button', { type: 'button', class: 'link', onclick: () => refuseAll(holders) }, `Refuse ${holders.length > 1 ? 'them' : 'it'}, too`),
        ),
    );
  };
  const item = (event) =>
    h(
      'li',
      { class: event === chosen ? 'chosen' : '' },
      h(
        'button',
        { type: 'button', class: `pair event${refused.has(event) ? ' refused' : ''}`, 'aria-pressed': `${event === chosen}`, onclick: () => go(event) },
        h('span', { class: 'part-names' }, event.parts.join(', ')),
        h('span', { class: `count verdict ${event.acting.verdict}` }, refused.has(event) ? 'refused' : VERDICTS[event.acting.verdict]),
        h('span', { class: 'when' }, `${framesText(event)}, ${millimetres(event.depth_mm_before)} → ${millimetres(event.depth_mm_after)}, ${event.outcome.replaceAll('_', ' ')}`),
      ),
      event === chosen && details(event),
    );

  const list = h('ol', { class: 'pairs', id: 'clip-events' });
  const summary = h('p', { class: 'summary', role: 'status' });
  const bar = h('div', { id: 'verdict' }, summary, h('button', { type: 'button', id: 'save-decisions', class: 'accept', title: 'A file for fix --decisions', onclick: save }, 'Save decisions'));
  const note = h('p', { class: 'note' }, 'The largest change first. O: ghost or beside. C: old or new pose. Esc: the whole clip again. What is refused stays as animated in');
  panel.append(bar, list, note, commandBlock('spherechain', 'fix', 'INPUT', '--decisions', 'decisions.json', '-o', 'OUTPUT'));

  function draw() {
    const verdicts = Object.entries({ ...VERDICTS, changes_pose: 'change the pose' }).filter(([key]) => key !== 'unchanged');
    const counts = verdicts.map(([key, text]) => [events.filter(({ acting }) => acting.verdict === key).length, text]);
    summary.textContent = `${plural(events.length, 'event')}: ${[...counts, [refused.size, 'refused']].filter(([count]) => count > 0).map(([count, text]) => `${count} ${text}`).join(', ')}`;
    list.replaceChildren(...events.map(item));
    list.querySelector('.chosen')?.scrollIntoView({ block: 'nearest' });
  }

  const keys = { n: () => step(1), p: () => step(-1), a: () => decide(false), r: () => decide(true) };
  document.addEventListener('keydown', (event) => {
    const action = keys[event.key.toLowerCase()];
    if (!action || event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    event.preventDefault();
    action();
  });
  draw();
}
