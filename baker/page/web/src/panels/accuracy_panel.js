import { h } from '../base/dom.js';
import { number, percent, plural } from '../base/format.js';
import { sphereName } from './sphere_panel.js';

// Results of `validate`: how much of what truly intersects is reported, and the worst misses. A click on a miss goes there.

const share = (value) => (value === undefined || value === null ? '–' : percent(value));

function table(head, rows) {
  const cells = (row) => row.map((cell, i) => h(i === 0 ? 'th' : 'td', i === 0 ? { scope: 'row' } : {}, cell));
  return h(
    'div',
    { class: 'scroll' },
    h(
      'table',
      {},
      h('thead', {}, h('tr', {}, head.map((name) => h('th', { scope: 'col' }, name)))),
      h('tbody', {}, rows.map((row) => h('tr', {}, cells(row)))),
    ),
  );
}

function figures(validation) {
  const { skin, all_pairs: allPairs, out_of_scope: out, raw_pairs: raw, truth_pairs: truth } = validation;
  const row = (name, score) => [name, share(score.pair_recall), share(score.precision), number(score.reported_per_frame)];
  const rows = [row('skin', skin), row('spheres, all pairs', allPairs)];
  return [
    h('section', {}, h('h3', {}, 'Reported pairs'), table(['', 'recall', 'precision', 'a frame'], rows)),
    h(
      'section',
      {},
      h('h3', {}, 'Triangle pairs that intersect'),
      table(
        ['', 'pairs'],
        [
          ['all', number(raw)],
          ['at rest too', number(out.rest)],
          ['of one sphere', number(out.same_sphere)],
          ['of ignored spheres', number(out.ignored)],
          ['true', number(truth)],
        ],
      ),
    ),
  ];
}

// The validation may have other frames than the page: the one nearest in time.
function frameAt(model, time) {
  const away = (frame) => Math.abs(model.time(frame) - time);
  let nearest = 0;
  for (let frame = 1; frame < model.frameCount; ++frame) if (away(frame) < away(nearest)) nearest = frame;
  return nearest;
}

export function fillAccuracyPanel(panel, store, model, flyTo) {
  const { validation } = model;
  if (!validation) {
    panel.append(h('p', { class: 'note' }, 'No validation in this page: give `view` the file that `validate --json` wrote.'));
    return;
  }
  const row = ({ time, spheres: [a, b], triangle_pairs: pairs, depth_mm: depth }) => {
    const frame = frameAt(model, time);
    return h(
      'li',
      {},
      h(
        'button',
        {
          type: 'button',
          class: 'pair miss',
          'data-frame': frame,
          title: `${plural(pairs, 'triangle pair')} at ${time.toFixed(2)} s; click to go there`,
          'aria-label': `frame ${frame}: ${a} ${model.spheres[a].name} and ${b} ${model.spheres[b].name}, ${Math.round(depth)} mm`,
          onclick: () => {
            store.set({ frame, playing: false, alarm: `${a}-${b}` });
            if (!store.state.spheres) store.showSpheres(true);
            flyTo(a, b);
          },
        },
        h('span', { class: 'two-names' }, sphereName(model, a), sphereName(model, b)),
        h('span', { class: 'depth' }, `${Math.round(depth)} mm`, h('i', { style: `width: ${Math.min(100, depth)}%` })),
      ),
    );
  };
  const known = validation.worst_misses.filter(({ spheres }) => spheres.every((id) => id < model.spheres.length));
  panel.append(
    ...figures(validation),
    h(
      'section',
      {},
      h('h3', {}, 'Worst misses'),
      h(
        'p',
        { class: 'note' },
        known.length === 0
          ? `${validation.reported} missed nothing.`
          : `Contacts that ${validation.reported} at the ${validation.radius} radius missed. In mm: how deep two body parts are in each other of which nothing was reported.`,
      ),
      h('ol', { class: 'pairs', id: 'misses' }, known.map(row)),
    ),
  );
}
