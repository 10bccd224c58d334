import { h } from './dom.js';
import { chainColour, regionColour } from './palette.js';

// The panel of what is shown. Sets (chains, levels, sides) mark spheres: where any is chosen, all other spheres fade.

function check(store, key, label, shortcut) {
  const input = h('input', { type: 'checkbox', id: `show-${key}`, onchange: () => store.set({ [key]: input.checked }) });
  store.watch([key], (state) => (input.checked = state[key]));
  return h('label', { class: 'check', title: `Key ${shortcut}` }, input, label);
}

function slider(store, key, label) {
  const set = () => store.set({ [key]: Number(input.value) / 100 });
  const input = h('input', { type: 'range', min: 0, max: 100, 'aria-label': label, id: `slide-${key}`, oninput: set });
  store.watch([key], (state) => (input.value = Math.round(100 * state[key])));
  return input;
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

function toggle(store, key, item, properties, ...content) {
  const button = h('button', { type: 'button', ...properties, onclick: () => store.toggle(key, item) }, ...content);
  return button;
}

function regionToggles(store, model) {
  const buttons = model.regions.map((region, i) =>
    toggle(
      store,
      'hiddenRegions',
      i,
      { class: 'region', id: `region-${region.name}`, title: `Show or hide the ${region.label}` },
      h('span', { class: 'swatch', style: `background: ${regionColour(i)}` }),
      h('span', {}, region.label),
      h('span', { class: 'count', title: 'spheres' }, `${region.spheres}`),
    ),
  );
  store.watch(['hiddenRegions'], (state) =>
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', !state.hiddenRegions.has(i))),
  );
  return buttons;
}

const shortName = (region) => region.replace(/^left /, 'L ').replace(/^right /, 'R ');

function setToggles(store, sets) {
  const buttons = sets.map((set, i) =>
    set.kind === 'chain'
      ? toggle(
          store,
          'sets',
          set.name,
          { class: 'chip chain', id: `set-${set.name}`, title: `${set.name}: ${set.route.join(' – ')}`, 'aria-label': set.name },
          h('span', { class: 'swatch', style: `background: ${chainColour(i)}` }),
          h('b', {}, set.label),
          h('span', { class: 'route' }, `${shortName(set.route[0])}–${shortName(set.route.at(-1))}`),
        )
      : toggle(store, 'sets', set.name, { class: 'chip', id: `set-${set.label}`, title: set.name, 'aria-label': set.name }, set.label),
  );
  store.watch(['sets'], (state) =>
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', state.sets.has(sets[i].name))),
  );
  return buttons;
}

export function fillControls(panel, store, model) {
  const of = (kind) => model.sets.filter((set) => set.kind === kind);
  const clear = h('button', { type: 'button', class: 'link', onclick: () => store.set({ sets: new Set() }) }, 'show all');
  store.watch(['sets'], (state) => (clear.hidden = state.sets.size === 0));
  panel.replaceChildren(
    h('h2', {}, 'Show'),
    h('div', { class: 'row' }, check(store, 'skin', 'Skin', 'S'), slider(store, 'skinOpacity', 'Opacity of the skin')),
    h('div', { class: 'row' }, check(store, 'spheres', 'Spheres', 'B'), slider(store, 'sphereOpacity', 'Opacity of the spheres')),
    radiusChoice(store, model.kinds),
    h('div', { class: 'row' }, check(store, 'patches', 'Surrounding regions', 'U')),
    h('div', { class: 'row' }, check(store, 'pivots', 'Pivots', 'P'), check(store, 'numbers', 'Numbers', 'N')),
    h('h2', {}, 'Regions', h('span', { class: 'note' }, 'spheres')),
    ...regionToggles(store, model),
    of('chain').length > 0 && h('h2', {}, 'Chains', clear),
    h('div', { class: 'chips two' }, setToggles(store, of('chain'))),
    of('level').length > 0 && h('h2', {}, 'Torso levels and sides'),
    h('div', { class: 'chips' }, setToggles(store, of('level')), h('span', { class: 'gap' }), setToggles(store, of('side'))),
  );
}
