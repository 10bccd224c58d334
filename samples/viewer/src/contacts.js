import { h } from './dom.js';
import { number, percent, plural } from './format.js';
import { regionColour } from './palette.js';

// The list of a frame's pairs; a click flies there.
export function fillContacts(panel, store, model, flyTo) {
  const list = h('ol', { class: 'pairs', id: 'pairs' });
  const summary = h('p', { class: 'note', role: 'status' });
  panel.append(summary, list);

  const sphere = (id) => {
    const { region, name } = model.spheres[id];
    return h(
      'span',
      { class: 'sphere-name' },
      h('span', { class: 'swatch', style: `background: ${regionColour(region)}` }),
      h('b', {}, `${id}`),
      ` ${name}`,
    );
  };

  const row = ([a, b], frame) => {
    const { depth } = model.depth(frame, a, b, model.radius);
    const share = depth / model.height;
    return h(
      'li',
      {},
      h(
        'button',
        {
          type: 'button',
          class: 'pair',
          'data-pair': `${a}-${b}`,
          title: `${number(depth)} in source units; click to fly there`,
          'aria-label': `${a} ${model.spheres[a].name} and ${b} ${model.spheres[b].name}, ${percent(share)} of the height deep`,
          onclick: () => {
            store.set({ pair: `${a}-${b}` });
            flyTo(a, b);
          },
        },
        h('span', { class: 'two-names' }, sphere(a), sphere(b)),
        h('span', { class: 'depth' }, percent(share), h('i', { style: `width: ${Math.min(100, 2500 * share)}%` })),
      ),
    );
  };

  store.watch(['frame'], ({ frame }) => {
    const pairs = model.pairs(frame);
    summary.textContent =
      pairs.length === 0
        ? 'Nothing touches in this frame.'
        : `${plural(pairs.length, 'pair')} at the ${model.radius} radius; depth in % of the height.`;
    list.replaceChildren(...pairs.map((pair) => row(pair, frame)));
  });
  store.watch(['frame', 'pair'], ({ pair }) => {
    for (const button of list.querySelectorAll('.pair')) button.setAttribute('aria-pressed', button.dataset.pair === pair);
  });
}
