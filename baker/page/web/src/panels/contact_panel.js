import { h } from '../base/dom.js';
import { CLASSES, className, isFault, isHidden, MEANINGS, millimetres } from '../model/contacts.js';
import { plural } from '../base/format.js';

// The frame's contacts by body parts, and below those of the whole clip; a click goes there.

// [3, 4, 5, 9] -> "3–5, 9", as their clip numbers them.
function runs(frames, numberOf) {
  const out = [];
  for (const frame of frames) {
    if (out.length > 0 && out.at(-1)[1] === frame - 1) out.at(-1)[1] = frame;
    else out.push([frame, frame]);
  }
  const text = out.slice(0, 5).map(([a, b]) => (a === b ? `${numberOf(a)}` : `${numberOf(a)}–${numberOf(b)}`));
  return text.join(', ') + (out.length > 5 ? ' …' : '');
}

export function fillContactPanel(panel, store, model, flyTo) {
  const summary = h('p', { role: 'status', class: 'summary' });
  const list = h('ol', { class: 'pairs', id: 'frame-contacts' });
  const order = h('p', { class: 'note' }, 'The worst first. The arrow is the way out: where it ends, the first part is free of the second.');
  const clipTitle = h('h3', {});
  const clipList = h('ol', { class: 'pairs', id: 'clip-contacts' });
  const classes = h(
    'details',
    { class: 'classes' },
    h('summary', {}, 'What the classes mean'),
    h('dl', {}, ...CLASSES.map((name, kind) => [h('dt', {}, name), h('dd', {}, MEANINGS[kind])]).reverse().flat()),
  );
  const { frames, faulty_before: before, faulty_after: after, new_faults: added } = model.response ?? {};
  const response = h(
    'p',
    { class: 'note', id: 'response' },
    `The response corrects this motion: ${before} of ${plural(frames ?? 0, 'frame')} had a fault of an arm, ${after} ${after === 1 ? 'has' : 'have'} one now (${added} with a new one).`,
  );
  if (model.response) panel.append(response);
  panel.append(summary, list, order, clipTitle, clipList, classes);

  const row = (properties, badge, name, note, onclick) =>
    h(
      'li',
      {},
      h(
        'button',
        { type: 'button', ...properties, onclick },
        badge && h('b', { class: 'badge' }, badge),
        h('span', { class: 'part-names' }, name),
        h('span', { class: 'count' }, note),
      ),
    );

  const what = (contact) => `${className(contact)}, ${millimetres(contact.depth)}`;
  const millilitres = ({ volume }) => (volume >= 0 ? `, ${Number(volume.toPrecision(2))} ml` : '');
  const minor = (contact) => (isFault(contact) ? '' : ' minor');
  const frameRow = (contact, i) => {
    const { key, name, pairs, visible } = contact;
    const title = [plural(pairs, 'triangle pair')];
    if (visible >= 0 && pairs > 0) title.push(`${Math.round(100 * visible)} % visible`);
    if (isHidden(contact)) title.push('most of it cannot be seen from outside');
    const properties = { class: `pair contact${minor(contact)}`, 'data-contact': key, title: title.join(', ') };
    return row(properties, `${i + 1}`, name, what(contact) + millilitres(contact), () => {
      store.set({ contact: key });
      flyTo(key);
    });
  };
  const clipRow = (entry) =>
    row(
      {
        class: `pair clip-contact${minor(entry)}`,
        'data-contact': entry.key,
        'data-frame': model.number(entry.worst),
        title: `${what(entry)} at frame ${model.number(entry.worst)}${isHidden(entry) ? ': most of it cannot be seen from outside' : ''}`,
      },
      null,
      entry.name,
      `${what(entry)} at ${model.number(entry.worst)}; ${entry.frames.length > 1 ? 'frames' : 'frame'} ${runs(entry.frames, model.number)}`,
      () => go(entry),
    );
  const go = ({ worst, key }) => {
    store.set({ frame: worst, playing: false, contact: key });
    flyTo(key);
  };

  store.watch(['frame', 'pose'], ({ frame, pose }) => {
    const contacts = model.contacts.now(frame);
    summary.textContent =
      contacts.length === 0 ? `The skin touches nowhere in this ${pose ? 'pose' : 'frame'}.` : `${plural(contacts.length, 'contact')}${pose ? ' in this pose' : ''}:`;
    order.hidden = contacts.length === 0;
    list.replaceChildren(...contacts.map(frameRow));
  });
  let shown = -1;
  store.watch(['frame'], ({ frame }) => {
    const at = model.clipAt(frame);
    if (at === shown) return;
    shown = at;
    const clip = model.clips[at];
    const found = model.contacts.over(clip.first, clip.count);
    clipTitle.textContent = found.length === 0 ? `No contact in ${clip.name}` : `In the whole of ${clip.name}, the worst first`;
    clipTitle.hidden = clipList.hidden = clip.count < 2;
    clipList.replaceChildren(...found.map(clipRow));
  });
  store.watch(['frame', 'pose', 'contact'], ({ contact }) => {
    for (const button of list.querySelectorAll('.pair')) button.setAttribute('aria-pressed', button.dataset.contact === contact);
  });
  // To the deepest contact of the clip.
  return () => {
    const { first, count } = model.clips[model.clipAt(store.state.frame)];
    const [deepest] = model.contacts.over(first, count);
    if (deepest) go(deepest);
  };
}
