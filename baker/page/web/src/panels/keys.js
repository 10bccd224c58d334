import { h } from '../base/dom.js';

// Keyboard shortcuts, and the page that lists them. `listed`: labels and texts of keys that another part of the page binds.

export function bindKeys(store, { timeline, stage, help, toggleTheme, reset, deepest, chains, hasMethod, hasChange, hasResponse, hasColliders, hasMask, posing, editor, listed }) {
  const flip = (key) => () => store.set({ [key]: !store.state[key] });
  const method = (action) => () => store.state.method && action();
  const allChains = () => store.set({ sets: new Set(chains.every((name) => store.state.sets.has(name)) ? [] : chains) });
  const methodKeys = [
    ['M', 'm', 'Method', () => store.showMethod(!store.state.method)],
    ['G', 'g', 'Method: regions in their colours', method(flip('regions'))],
    ['U', 'u', "Method: spheres' triangles", method(flip('patches'))],
    ['P', 'p', 'Method: pivots', method(flip('pivots'))],
    ['N', 'n', 'Method: numbers of spheres', method(flip('numbers'))],
    ['C', 'c', 'Method: all chains', method(allChains)],
  ];
  const contactKeys = [
    ['R', 'r', 'All paint: contacts, numbers, arrows', flip('paint')],
    ['H', 'h', 'Contacts behind the skin', flip('hiddenContacts')],
  ];
  const maskKeys = [
    ['L', 'l', 'Layers in colours', flip('layers')],
    ['K', 'k', "Hide the mask's triangles", flip('masked')],
  ];
  const show = (first, second) => () => store.set({ showing: store.state.showing === first ? second : first });
  const changeKeys = [
    ['O', 'o', 'Before and after: beside each other, or the old pose as a ghost', show('ghost', 'beside')],
    ['C', 'c', 'Before and after in one place: the old pose, or the new one', show('before', 'after')],
  ];
  const keys = [
    ['Space', ' ', 'Play or pause', flip('playing')],
    ['←', 'ArrowLeft', 'Previous frame', () => timeline.step(-1)],
    ['→', 'ArrowRight', 'Next frame', () => timeline.step(1)],
    ['Home', 'Home', 'First frame', () => timeline.step(-Infinity)],
    ['End', 'End', 'Last frame', () => timeline.step(Infinity)],
    ...(hasMask ? [] : [['D', 'd', 'Deepest frame of the clip', deepest]]),
    ...(hasChange ? changeKeys : []),
    ...(hasResponse ? [['O', 'o', 'The pose as animated, as a ghost', flip('ghost')]] : []),
    ['1', '1', 'View from the front', () => stage?.view('front')],
    ['2', '2', 'View from the side', () => stage?.view('side')],
    ['3', '3', 'View from the back', () => stage?.view('back')],
    ['4', '4', 'View from the top', () => stage?.view('top')],
    ['0', '0', 'Reset', reset],
    ['S', 's', 'Skin', flip('skin')],
    ['X', 'x', 'Textures', flip('look')],
    ...(hasMask ? maskKeys : contactKeys),
    ['F', 'f', 'Hold the character in place', flip('follow')],
    ...(hasMask ? [] : [['B', 'b', 'Spheres', () => store.showSpheres(!store.state.spheres)]]),
    ...(hasColliders ? [['V', 'v', 'Colliders', flip('colliders')]] : []),
    ...(posing?.keys ?? []),
    ...(editor?.keys ?? []),
    ...(hasMethod ? methodKeys : []),
    ...listed.map(([label, what]) => [label, null, what]),
    ['T', 't', 'Light or dark', toggleTheme],
    ['Esc', 'Escape', 'Let go of the contact, sphere or joint', () => store.set({ pinned: null, pointed: null, contact: null, alarm: null, joint: null, loop: null })],
    ['?', '?', 'This list', () => help.showModal()],
  ].filter(([label, key]) => key === null || !listed.some(([other]) => other === label));
  help.querySelector('tbody').append(
    ...keys.map(([label, , what]) => h('tr', {}, h('th', { scope: 'row' }, h('kbd', {}, label)), h('td', {}, what))),
  );
  const isBox = ({ tagName, type }) => tagName === 'INPUT' && type === 'checkbox';
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    // A control keeps the keys it has a use for, but a box leaves the space key to the player.
    const { tagName, type } = event.target;
    if (tagName === 'SELECT') return;
    if (tagName === 'INPUT' && type === 'range' && /^(Arrow|Home|End)/.test(event.key)) return;
    if (event.key === ' ' && ['BUTTON', 'SUMMARY'].includes(tagName)) return;
    if (event.key === 'Enter' && isBox(event.target)) return event.target.click();
    const found = keys.find(([, key]) => key === event.key || key === event.key.toLowerCase());
    if (!found) return;
    event.preventDefault();
    found[3]();
  });
  // Browsers switch a box when the space key comes up.
  document.addEventListener('keyup', (event) => event.key === ' ' && isBox(event.target) && event.preventDefault());
  // After a click the keys belong to the page again.
  document.addEventListener('click', ({ detail }) => {
    const { activeElement: active } = document;
    if (detail > 0 && ['BUTTON', 'SUMMARY'].includes(active?.tagName)) active.blur();
  });
}
