import { h } from '../base/dom.js';
import { plural } from '../base/format.js';
import { LAYERS } from '../base/palette.js';
import { HIDDEN_LAYER } from '../model/model.js';

// The mask in numbers, the key to the layers' colours, and the hidden triangles of each mesh; a click shows a mesh alone.

const NAMES = ['nothing covers it', 'covered, and stays: a clip shows it or skin near it', 'hidden: covered, and no clip shows it'];

export function fillMaskPanel(panel, store, model) {
  const { hidden, hidden_percent: triangles, area_percent: area } = model.mask;
  const { layerOf, partOf } = model.mesh;
  const count = (keep) => layerOf.reduce((sum, layer, t) => sum + (keep(layer, t) ? 1 : 0), 0);
  const key = h(
    'div',
    { class: 'legends' },
    LAYERS.map((colour, layer) =>
      h('div', { class: 'legend' }, h('span', { class: 'swatch', style: `background: ${colour}` }), NAMES[layer], h('span', { class: 'count' }, count((own) => own === layer).toLocaleString('en'))),
    ),
  );
  store.watch(['layers'], ({ layers }) => (key.hidden = !layers));
  const others = (part) => model.parts.filter((other) => other.part !== part).map((other) => other.part);
  const isAlone = ({ hiddenParts }, part) => model.parts.length > 1 && !hiddenParts.has(part) && others(part).every((other) => hiddenParts.has(other));
  const rows = model.parts.map(({ part, name }) => {
    const own = count((layer, t) => layer === HIDDEN_LAYER && partOf[t] === part);
    const of = count((_, t) => partOf[t] === part);
    const show = () => store.set({ hiddenParts: new Set(isAlone(store.state, part) ? [] : others(part)) });
    const button = h(
      'button',
      { type: 'button', class: 'pair', 'data-mesh': part, title: `Show alone, or all: ${name}`, onclick: show },
      h('span', { class: 'part-names' }, name),
      h('span', { class: 'count' }, `${own.toLocaleString('en')} of ${of.toLocaleString('en')}`),
    );
    store.watch(['hiddenParts'], (state) => button.setAttribute('aria-pressed', isAlone(state, part)));
    return h('li', {}, button);
  });
  panel.append(
    h('p', { class: 'summary', id: 'mask-summary' }, `${plural(hidden, 'hidden triangle')} of ${layerOf.length.toLocaleString('en')} (${triangles.toFixed(1)} %), ${area.toFixed(1)} % of the area`),
    key,
    h('p', { class: 'note' }, 'Skin that comes through its cloth is hidden, too.'),
    h('h3', {}, 'Hidden triangles by mesh'),
    h('ol', { class: 'pairs' }, rows),
    h('p', { class: 'note' }, 'A click shows a mesh alone. A second click shows all.'),
  );
}
