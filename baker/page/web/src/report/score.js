import '../style.css';
import './library.css';
import './score.css';
import { h } from '../base/dom.js';
import { number, percent, plural } from '../base/format.js';
import { followTheme } from './theme.js';

// The scores of a library: how each metric is distributed, and the clips, the worst first by the one that is chosen.

const $ = (id) => document.getElementById(id);
const BARS = 24;
const SHARES = /^(fault_frames|deeper_than_1cm|star_penetration_rate|voxel_volume.*|contacts_.*)$/;
const ASCENDING = /^(limmt|contacts_kept)$/; // less is worse

const text = (metric, value) => (value === null || value === undefined ? '–' : SHARES.test(metric) ? percent(value) : number(value));
const title = (metric) => metric.replaceAll('_', ' ').replace(' percent', ', %');

// How many of the values lie in each of BARS ranges of the same width.
function histogram(values) {
  const least = Math.min(...values);
  const width = (Math.max(...values) - least) / BARS || 1;
  const bars = new Array(BARS).fill(0);
  for (const value of values) bars[Math.min(Math.floor((value - least) / width), BARS - 1)] += 1;
  return bars;
}

function chart(metric, clips, choose) {
  const values = clips.map((clip) => clip.metrics[metric]).filter((value) => typeof value === 'number').sort((a, b) => a - b);
  const button = h('button', { class: 'chart', type: 'button', onclick: choose, 'aria-pressed': 'false' }, h('b', { title: title(metric) }, title(metric)));
  if (values.length === 0) {
    button.append(h('small', {}, 'not measured here'));
    return button;
  }
  const bars = histogram(values);
  const most = Math.max(...bars);
  button.append(
    h('div', { class: 'bars', 'aria-hidden': 'true' }, bars.map((count) => h('i', { style: `height:${(100 * count) / most}%` }))),
    h('small', {}, `${text(metric, values[0])} · median ${text(metric, values[Math.floor(values.length / 2)])} · ${text(metric, values.at(-1))}`),
  );
  return button;
}

function start({ clips, failed, reference }) {
  const metrics = Object.keys(clips[0]?.metrics ?? {});
  const state = { metric: metrics[0], filter: '' };
  const charts = new Map(metrics.map((metric) => [metric, chart(metric, clips, () => choose(metric))]));
  $('charts').append(...charts.values());
  const frames = clips.reduce((sum, clip) => sum + clip.frames, 0);
  $('summary').textContent = [plural(new Set(clips.map((clip) => clip.character)).size, 'character'), plural(clips.length, 'clip'), plural(frames, 'frame'), reference ? `compared with ${reference}` : '', failed.length > 0 ? `${failed.length} not scored` : ''].filter(Boolean).join(' · ');
  $('failed').append(...failed.map(({ error }) => h('p', {}, error)));

  const worst = (clip) => clip.metrics[state.metric] ?? (ASCENDING.test(state.metric) ? Infinity : -Infinity);
  const draw = () => {
    const words = state.filter.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = clips.filter((clip) => words.every((word) => `${clip.character} ${clip.clip}`.toLowerCase().includes(word)));
    const sign = ASCENDING.test(state.metric) ? 1 : -1;
    shown.sort((a, b) => sign * (worst(a) - worst(b)) || 0);
    const columns = [state.metric, ...['fault_frames', 'depth_percent_max', 'volume_percent', 'star_penetration_rate', 'limmt'].filter((metric) => metric !== state.metric && metrics.includes(metric))];
    $('heads').replaceChildren(...['Character', 'Clip', 'Frames', ...columns.map(title)].map((head) => h('th', { scope: 'col' }, head)));
    $('rows').replaceChildren(
      ...shown.map((clip) => h('tr', {}, h('td', {}, clip.character), h('td', {}, clip.clip), h('td', { class: 'value' }, number(clip.frames)), columns.map((metric) => h('td', { class: 'value' }, text(metric, clip.metrics[metric]))))),
    );
  };
  const choose = (metric) => {
    state.metric = metric;
    for (const [name, button] of charts) button.setAttribute('aria-pressed', `${name === metric}`);
    draw();
  };
  $('filter').addEventListener('input', () => {
    state.filter = $('filter').value;
    draw();
  });
  followTheme($('theme'));
  if (metrics.length > 0) choose(metrics[0]);
}

start(JSON.parse($('spherechain-data').textContent) ?? { clips: [], failed: [], reference: null });
