import { h } from './dom.js';
import { length, number, plural } from './format.js';
import { regionColour } from './palette.js';

// The figures of the sphere under the pointer, or of the one that was clicked.
export function fillSpherePanel(panel, store, model) {
  const row = (key, name, value) => h('tr', {}, h('th', { scope: 'row' }, name), h('td', { 'data-figure': key }, value));

  const neighbours = (id, frame) =>
    [...model.spheres[id].neighbours].sort((a, b) => a - b).map((other) => {
      const { share } = model.depth(frame, id, other, 'fit');
      return h('li', {}, h('b', {}, `${other}`), ` ${model.spheres[other].name}`, h('span', { class: 'count' }, share.toFixed(2)));
    });

  store.watch(['pointed', 'frame'], ({ pointed, pinned, frame }) => {
    if (pointed === null) {
      panel.replaceChildren(
        h('h2', {}, 'Sphere'),
        h('p', { class: 'note' }, 'Point at a sphere to see its figures and its surrounding region; click to keep it.'),
      );
      return;
    }
    const sphere = model.spheres[pointed];
    const now = Object.fromEntries(model.kinds.map((kind) => [kind, model.sphere(frame, pointed, kind)[3]]));
    panel.replaceChildren(
      h(
        'h2',
        { 'data-sphere': `${pointed}` },
        h('span', { class: 'swatch', style: `background: ${regionColour(sphere.region)}` }),
        `Sphere ${pointed}, ${sphere.name}`,
        pointed === pinned && h('button', { type: 'button', class: 'link', onclick: () => store.set({ pinned: null, pointed: null }) }, 'let go'),
      ),
      h(
        'table',
        { class: 'figures' },
        sphere.level !== null && row('level', 'level, side', `${sphere.level}, ${sphere.side}`),
        row('radius', 'r at rest', length(sphere.rest[3], model.height)),
        model.kinds.map((kind) => row(`${kind}-now`, `${kind} radius now`, length(now[kind], model.height))),
        row('mean-f', 'mean |F|', length(sphere.meanF, model.height)),
        row('max-f', 'max |F|', length(sphere.maxF, model.height)),
        row('triangles', `triangles, pivots`, [number(sphere.triangles), `, ${sphere.pivots.length}`]),
      ),
      h('h3', { title: '(r1 + r2 - d) / (r1 + r2), of the fit radii in this frame' }, `PD to ${plural(sphere.neighbours.size, 'neighbour')} on chains`),
      h('ul', { class: 'neighbours' }, neighbours(pointed, frame)),
    );
  });
}
