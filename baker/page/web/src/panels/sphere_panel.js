import { h } from '../base/dom.js';
import { length, number, percent, plural } from '../base/format.js';
import { CONTACT, FALSE_ALARM, regionColour } from '../base/palette.js';

// The method's spheres: which touch, and which of these are false alarms; and the figures of the one that is pointed at.

export function legend(store) {
  const key = (colour, text) => h('span', { class: 'legend' }, h('span', { class: 'swatch', style: `background: ${colour}` }), text);
  const box = h('div', { class: 'legends' }, key(CONTACT, 'the skin touches too'), key(FALSE_ALARM, 'false alarm: only the spheres touch'));
  store.watch(['spheres', 'method'], ({ spheres, method }) => (box.hidden = !spheres && !method));
  return box;
}

function radiusChoice(store, kinds) {
  const buttons = kinds.map((kind) =>
    h('button', { type: 'button', id: `radius-${kind}`, onclick: () => store.set({ radius: kind }) }, kind),
  );
  store.watch(['radius'], (state) =>
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', kinds[i] === state.radius)),
  );
  return h('div', { class: 'row' }, 'Radius', h('div', { class: 'segments', role: 'group', 'aria-label': 'Radius' }, buttons));
}

export function sphereName(model, id) {
  const { region, name } = model.spheres[id];
  return h(
    'span',
    { class: 'sphere-name' },
    h('span', { class: 'swatch', style: `background: ${regionColour(region)}` }),
    h('b', {}, `${id}`),
    ` ${name}`,
  );
}

export function fillSpherePanel(panel, store, model, flyTo) {
  const summary = h('p', { role: 'status' });
  const list = h('ol', { class: 'pairs', id: 'sphere-pairs' });
  panel.append(radiusChoice(store, model.kinds), legend(store), summary, list);
  const row = ({ a, b, depth, isFalse }) => {
    const share = depth / model.height;
    const key = `${a}-${b}`;
    return h(
      'li',
      {},
      h(
        'button',
        {
          type: 'button',
          class: `pair ${isFalse ? 'false-alarm' : 'true-alarm'}`,
          'data-pair': key,
          title: `${number(depth)} in source units; click to fly there`,
          'aria-label': `${a} ${model.spheres[a].name} and ${b} ${model.spheres[b].name}, ${percent(share)} of the height${isFalse ? ', false alarm' : ''}`,
          onclick: () => {
            store.set({ alarm: key });
            if (!store.state.spheres) store.showSpheres(true);
            flyTo(a, b);
          },
        },
        h('span', { class: 'two-names' }, sphereName(model, a), sphereName(model, b)),
        h('span', { class: 'depth' }, percent(share), h('i', { style: `width: ${Math.min(100, 2500 * share)}%` })),
      ),
    );
  };
  store.watch(['frame', 'radius', 'method'], ({ frame, radius, method }) => {
    if (!method) return;
    const pairs = model.spherePairs(frame, radius);
    const wrong = pairs.filter(({ isFalse }) => isFalse).length;
    summary.textContent =
      pairs.length === 0
        ? `No spheres touch at the ${radius} radius.`
        : `${plural(pairs.length, 'pair')} at the ${radius} radius, ${wrong} of them false alarms. The deepest first, in % of the height; false alarms last.`;
    list.replaceChildren(...pairs.map(row));
  });
  store.watch(['frame', 'radius', 'method', 'alarm'], ({ alarm }) => {
    for (const button of list.querySelectorAll('.pair')) button.setAttribute('aria-pressed', button.dataset.pair === alarm);
  });
}

export function fillSphereCard(card, store, model) {
  const row = (key, name, value) => h('tr', {}, h('th', { scope: 'row' }, name), h('td', { 'data-figure': key }, value));
  const neighbours = (id, frame) =>
    [...model.spheres[id].neighbours].sort((a, b) => a - b).map((other) => {
      const { share } = model.depth(frame, id, other, 'fit');
      return h('li', {}, h('b', {}, `${other}`), ` ${model.spheres[other].name}`, h('span', { class: 'count' }, share.toFixed(2)));
    });

  store.watch(['pointed', 'frame', 'method'], ({ pointed, pinned, frame, method }) => {
    card.hidden = pointed === null || !method;
    if (card.hidden) return;
    const sphere = model.spheres[pointed];
    const now = Object.fromEntries(model.kinds.map((kind) => [kind, model.sphere(frame, pointed, kind)[3]]));
    card.replaceChildren(
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
