import uPlot from 'uplot';
import { css, h } from '../base/dom.js';
import { number } from '../base/format.js';

// How many pairs of spheres touch in each frame, at both radii. The line is the frame shown; a click goes to a frame.

const PADDING = 12; // pixels, as in style.css
const TITLE = 28;
const CHARTS = [
  { title: 'Pairs', series: [['fit radius', 'fit-pairs', 'fit'], ['detect radius', 'all-pairs', 'detect']] },
];

function options(series, size) {
  const axis = (size) => ({
    size,
    stroke: () => css('--muted'),
    grid: { stroke: () => css('--line'), width: 1 },
    ticks: { show: false },
    font: `10px ${css('--font')}`,
    gap: 3,
  });
  return {
    ...size,
    legend: { show: false },
    padding: [6, 8, 0, 0],
    cursor: { y: false, drag: { x: false, y: false }, sync: { key: 'frames' }, points: { size: 5 } },
    scales: { x: { time: false }, y: { range: (_, low, high) => [Math.min(0, low), high > 0 ? 1.12 * high : 1] } },
    axes: [
      { ...axis(18), space: 40, incrs: [1, 2, 5, 10, 20, 50, 100, 200] },
      { ...axis(38), space: 24, values: (_, ticks) => ticks.map(number) },
    ],
    series: [
      {},
      ...series.map(([label, name]) => ({ label, stroke: () => css(`--${name}`), width: 1.75, points: { show: false } })),
    ],
  };
}

function chart({ title, series }, store, model, size) {
  const frames = Array.from({ length: model.frameCount }, (_, i) => i);
  const values = series.map(([, , kind]) => frames.map((frame) => model.pairCount(kind, frame)));
  const readouts = series.map(() => h('output', {}));
  const box = h('div', { class: 'chart' });
  const plot = new uPlot(options(series, size), [frames, ...values], box);
  const line = h('div', { class: 'now' });
  plot.over.append(line);
  plot.over.addEventListener('click', (event) => {
    const left = event.clientX - plot.over.getBoundingClientRect().left;
    store.set({ frame: plot.posToIdx(left), playing: false });
  });
  const follow = ({ frame }) => {
    line.style.left = `${plot.valToPos(frame, 'x')}px`;
    readouts.forEach((readout, i) => (readout.textContent = number(values[i][frame])));
  };
  // The first layout comes after this turn; a redraw before it would lose the scales.
  queueMicrotask(() => {
    store.watch(['frame'], follow);
    store.watch(['theme'], () => plot.redraw());
  });
  const legend = series.map(([label, name], i) =>
    h('span', { class: 'key' }, h('i', { style: `background: var(--${name})` }), label, ' ', readouts[i]),
  );
  return {
    element: h('section', { class: 'chart-box', 'aria-label': `${title} per frame` }, h('h3', {}, title, legend), box),
    resize: (size) => {
      plot.setSize(size);
      follow(store.state);
    },
  };
}

export function fillCharts(panel, store, model) {
  if (!model.hasPairs || model.frameCount < 2) {
    panel.append(h('p', { class: 'note' }, 'One frame only: nothing to draw over time.'));
    return;
  }
  // uPlot needs a size to start with: the charts are made when their tab is first shown.
  let charts = null;
  new ResizeObserver(() => {
    if (panel.hidden) return;
    const height = Math.floor((panel.clientHeight - PADDING) / CHARTS.length) - TITLE;
    const size = { width: panel.clientWidth - 2 * PADDING, height: Math.min(Math.max(height, 64), 150) };
    if (charts) return charts.forEach(({ resize }) => resize(size));
    charts = CHARTS.map((spec) => chart(spec, store, model, size));
    panel.append(...charts.map(({ element }) => element));
  }).observe(panel);
}
