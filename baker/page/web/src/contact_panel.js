import { h } from './dom.js';
import { plural } from './format.js';

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
  const order = h('p', { class: 'note' }, 'Most pairs of triangles first. How deep they are is not measured yet.');
  const clipTitle = h('h3', {});
  const clipList = h('ol', { class: 'pairs', id: 'clip-contacts' });
  panel.append(summary, list, order, clipTitle, clipList);

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

  const frameRow = ({ key, name, pairs }, i) =>
    row({ class: 'pair contact', 'data-contact': key }, `${i + 1}`, name, plural(pairs, 'triangle pair'), () => {
      store.set({ contact: key });
      flyTo(key);
    });
  const clipRow = (entry) =>
    row(
      {
        class: 'pair clip-contact',
        'data-contact': entry.key,
        'data-frame': model.number(entry.worst),
        title: `Most triangle pairs at frame ${model.number(entry.worst)}: ${entry.most}`,
      },
      null,
      entry.name,
      `${entry.frames.length > 1 ? 'frames' : 'frame'} ${runs(entry.frames, model.number)}`,
      () => {
        store.set({ frame: entry.worst, playing: false, contact: entry.key });
        flyTo(entry.key);
      },
    );

  store.watch(['frame'], ({ frame }) => {
    const contacts = model.contacts.of(frame);
    summary.textContent =
      contacts.length === 0 ? 'The skin touches nowhere in this frame.' : `The skin touches at ${plural(contacts.length, 'place')}:`;
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
    clipTitle.textContent = found.length === 0 ? `No contact in ${clip.name}` : `In the whole of ${clip.name}, the longest first`;
    clipTitle.hidden = clipList.hidden = clip.count < 2;
    clipList.replaceChildren(...found.map(clipRow));
  });
  store.watch(['frame', 'contact'], ({ contact }) => {
    for (const button of list.querySelectorAll('.pair')) button.setAttribute('aria-pressed', button.dataset.contact === contact);
  });
}
