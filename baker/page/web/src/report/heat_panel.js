import { h } from '../base/dom.js';
import { decode } from '../model/frame_lists.js';
import { spheresSection } from './events_panel.js';
import { clipLink } from './links.js';
import { isFault } from './marks.js';

// Where on the skin a character's faults are: by how deep they are, or by how many frames they last.

const LOW = [250, 190, 60]; // linear, from faint to strong
const HIGH = [190, 8, 20];
const mix = (share) => [...LOW.map((low, k) => Math.round(low + share * (HIGH[k] - low))), Math.round(110 + 145 * Math.sqrt(share))];

export function fillHeat(panel, { rows, fit, heat, store, skinLayer, redraw }) {
  const triangles = decode(heat.triangles, Uint32Array);
  const measures = {
    depth: { values: decode(heat.mm, Float32Array), text: (value) => `${Math.round(value)} mm`, name: 'How deep' },
    frames: { values: decode(heat.frames, Uint32Array), text: (value) => `${((100 * value) / heat.of).toFixed(1)} % of frames`, name: 'How often' },
  };
  const legend = h('p', { class: 'note' });
  const buttons = Object.entries(measures).map(([key, { name }]) => h('button', { type: 'button', onclick: () => show(key) }, name));
  const show = (key) => {
    const { values, text } = measures[key];
    const most = values.reduce((a, b) => Math.max(a, b), 0);
    const share = new Map();
    triangles.forEach((t, i) => share.set(t, values[i] / most));
    skinLayer.paint((t) => (share.has(t) ? mix(share.get(t)) : null));
    legend.textContent = triangles.length === 0 ? 'No fault touches this skin.' : `Yellow: little. Red: up to ${text(most)}.`;
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', `${Object.keys(measures)[i] === key}`));
    redraw();
  };
  const faults = (row) => row.events.filter((event) => isFault(event) && event.state !== 'resolved' && !event.rule).length;
  const list = rows
    .map((row) => ({ row, count: faults(row) }))
    .sort((a, b) => b.count - a.count)
    .map(({ row, count }) => h('li', {}, h('a', { class: 'pair', href: clipLink(row) }, h('span', { class: 'part-names' }, row.clip), h('span', { class: 'count' }, count || 'clean'))));
  panel.append(
    spheresSection(store, fit),
    h('p', { class: 'summary' }, `The faults of ${rows.length === 1 ? 'its clip' : `its ${rows.length} clips`}, on the skin at rest`),
    h('div', { class: 'segments', role: 'group', 'aria-label': 'Colour' }, buttons),
    legend,
    h('h3', {}, 'Clips, by faults'),
    h('ol', { class: 'pairs' }, list),
  );
  show('depth');
}
