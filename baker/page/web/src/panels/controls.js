import { h } from '../base/dom.js';
import { chainColour, regionColour } from '../base/palette.js';
import { legend } from './sphere_panel.js';

// Controls that choose what is shown. Sets (chains, levels, sides) mark spheres: if any is chosen, all other spheres fade.
// Controls for the paper's method are behind a switch: class `method`.

export function check(store, key, label, shortcut, set = (value) => store.set({ [key]: value })) {
  const input = h('input', { type: 'checkbox', id: `show-${key}`, onchange: () => set(input.checked) });
  store.watch([key], (state) => (input.checked = state[key]));
  return h('label', { class: 'check', title: `Key ${shortcut}` }, input, label);
}

function slider(store, key, label) {
  const set = () => store.set({ [key]: Number(input.value) / 100 });
  const input = h('input', { type: 'range', min: 0, max: 100, 'aria-label': label, id: `slide-${key}`, oninput: set });
  store.watch([key], (state) => (input.value = Math.round(100 * state[key])));
  return input;
}

const toggle = (store, key, item, properties, ...content) =>
  h('button', { type: 'button', ...properties, onclick: () => store.toggle(key, item) }, ...content);

function partToggles(store, model) {
  const buttons = model.parts.map(({ part, name }) =>
    toggle(store, 'hiddenParts', part, { class: 'part', id: `part-${part}`, title: `Show or hide: ${name}` }, name),
  );
  store.watch(['hiddenParts'], (state) =>
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', !state.hiddenParts.has(model.parts[i].part))),
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
          h('span', { class: 'route' }, `${shortName(set.route[0])} – ${shortName(set.route.at(-1))}`),
        )
      : toggle(store, 'sets', set.name, { class: 'chip', id: `set-${set.label}`, title: set.name, 'aria-label': set.name }, set.label),
  );
  store.watch(['sets'], (state) =>
    buttons.forEach((button, i) => button.setAttribute('aria-pressed', state.sets.has(sets[i].name))),
  );
  return buttons;
}

function regionKey(model) {
  return model.regions.map((region, i) =>
    h('div', { class: 'legend' }, h('span', { class: 'swatch', style: `background: ${regionColour(i)}` }), region.label, h('span', { class: 'count' }, `${region.spheres}`)),
  );
}

export function fillControls(panel, store, model) {
  const of = (kind) => model.sets.filter((set) => set.kind === kind);
  const link = (key, text) => {
    const button = h('button', { type: 'button', class: 'link', onclick: () => store.set({ [key]: new Set() }) }, text);
    store.watch([key], (state) => (button.hidden = state[key].size === 0));
    return button;
  };
  const content = [
    h('h2', {}, 'Show'),
    h('div', { class: 'row' }, check(store, 'skin', 'Skin', 'S'), slider(store, 'skinOpacity', 'Opacity of the skin')),
    model.response && check(store, 'ghost', 'As animated, as a ghost', 'O'),
    model.look && check(store, 'look', 'Textures', 'X'),
    model.mask && check(store, 'layers', 'Layers in colours', 'L'),
    model.mask && check(store, 'masked', "Hide the mask's triangles", 'K'),
    !model.mask && check(store, 'paint', 'Paint on contacts', 'R'),
    !model.mask && check(store, 'hiddenContacts', 'Contacts behind the skin', 'H'),
    model.frameCount > 1 && check(store, 'follow', 'Hold the character in place', 'F'),
    model.spheres.length > 0 && h(
      'div',
      { class: 'row' },
      check(store, 'spheres', 'Spheres', 'B', (shown) => store.showSpheres(shown)),
      slider(store, 'sphereOpacity', 'Opacity of the spheres'),
    ),
    model.colliders && h('div', { class: 'row' }, check(store, 'colliders', 'Colliders', 'V'), slider(store, 'colliderOpacity', 'Opacity of the colliders')),
    model.hasMethod && legend(store),
    h('h2', {}, model.mask ? 'Meshes' : 'Body parts', link('hiddenParts', 'show all')),
    h('div', { class: 'parts' }, partToggles(store, model)),
    model.hasMethod && h('h2', {}, 'Under the hood'),
    model.hasMethod && check(store, 'method', 'Method', 'M', (shown) => store.showMethod(shown)),
    h(
      'div',
      { class: 'method' },
      h('h2', {}, 'Regions', h('span', { class: 'note' }, 'spheres')),
      check(store, 'regions', 'In their colours', 'G'),
      ...regionKey(model),
      h('h2', {}, 'Marks'),
      check(store, 'patches', "Spheres' triangles", 'U'),
      h('div', { class: 'row' }, check(store, 'pivots', 'Pivots', 'P'), check(store, 'numbers', 'Numbers', 'N')),
      of('chain').length > 0 && h('h2', {}, 'Chains', link('sets', 'show all')),
      h('div', { class: 'chips chains' }, setToggles(store, of('chain'))),
      of('level').length > 0 && h('h2', {}, 'Torso levels and sides'),
      h('div', { class: 'chips' }, setToggles(store, of('level')), h('span', { class: 'gap' }), setToggles(store, of('side'))),
    ),
  ];
  panel.replaceChildren(...content.filter(Boolean));
}
