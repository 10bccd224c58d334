import { h } from './dom.js';

// Keyboard shortcuts, and the page that lists them.

export function bindKeys(store, { timeline, stage, help, toggleTheme, reset, chains }) {
  const flip = (key) => () => store.set({ [key]: !store.state[key] });
  const allChains = () => store.set({ sets: new Set(chains.every((name) => store.state.sets.has(name)) ? [] : chains) });
  const keys = [
    ['Space', ' ', 'Play or pause', flip('playing')],
    ['←', 'ArrowLeft', 'Previous frame', () => timeline.step(-1)],
    ['→', 'ArrowRight', 'Next frame', () => timeline.step(1)],
    ['Home', 'Home', 'First frame', () => timeline.step(-Infinity)],
    ['End', 'End', 'Last frame', () => timeline.step(Infinity)],
    ['1', '1', 'View from the front', () => stage?.view('front')],
    ['2', '2', 'View from the side', () => stage?.view('side')],
    ['3', '3', 'View from the back', () => stage?.view('back')],
    ['4', '4', 'View from the top', () => stage?.view('top')],
    ['0', '0', 'Reset', reset],
    ['S', 's', 'Skin', flip('skin')],
    ['B', 'b', 'Spheres', flip('spheres')],
    ['U', 'u', 'Surrounding regions', flip('patches')],
    ['P', 'p', 'Pivots', flip('pivots')],
    ['N', 'n', 'Numbers of spheres', flip('numbers')],
    ['C', 'c', 'All chains', allChains],
    ['T', 't', 'Light or dark', toggleTheme],
    ['Esc', 'Escape', 'Let go of the sphere or pair', () => store.set({ pinned: null, pointed: null, pair: null })],
    ['?', '?', 'This list', () => help.showModal()],
  ];
  help.querySelector('tbody').append(
    ...keys.map(([label, , what]) => h('tr', {}, h('th', { scope: 'row' }, h('kbd', {}, label)), h('td', {}, what))),
  );
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    // A control keeps the keys it has a use for.
    const { tagName, type } = event.target;
    if (tagName === 'INPUT' && type === 'range' && /^(Arrow|Home|End)/.test(event.key)) return;
    if (event.key === ' ' && ['BUTTON', 'SUMMARY', 'INPUT'].includes(tagName) && type !== 'range') return;
    const found = keys.find(([, key]) => key === event.key || key === event.key.toLowerCase());
    if (!found) return;
    event.preventDefault();
    found[3]();
  });
}
