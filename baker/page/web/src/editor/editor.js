import './editor.css';
import { Vector3 } from 'three';
import { h } from '../base/dom.js';
import { fillEditorPanel } from './editor_panel.js';
import { addBeside, fileOf, forget, ignore, mayRemove, place, placeNow, placeOf, pointOf, remove, restore, startState, unignore } from './editor_state.js';
import { createEditorView } from './editor_view.js';
import { History, stepOf } from './history.js';

// Editing spheres, and which parts are ignored, for `spherechain bake --edits`. It goes on while its tab is open.

const NUDGE = 2; // mm of an arrow key; with Shift ten
const SMALLEST = 2e-4; // radius, of a region's length
const LARGEST = 2;

const KEYS = [
  ['A, Del', 'Edit: add or delete a sphere'],
  ['+, −', 'Edit: the picked sphere larger or smaller; so does Shift and the wheel'],
  ['← ↑ → ↓', 'Edit: move the picked sphere by 2 mm, with Shift by 10 mm'],
  ['Ctrl Z', 'Edit: undo; with Shift redo'],
];

// The tab and its panel come before the bake's. Null where there is nothing to edit.
export function createEditor({ model, skin, store, stage, layers, canvas, overlay }) {
  if (!model.edits || model.spheres.length === 0) return null;
  const tab = h('button', { type: 'button', role: 'tab', id: 'tab-edit', 'aria-controls': 'edit', 'aria-selected': 'false', tabindex: '-1' }, 'Edit');
  const panel = h('div', { role: 'tabpanel', id: 'edit', 'aria-labelledby': 'tab-edit', hidden: true });
  document.getElementById('tab-bake').before(tab);
  document.getElementById('bake').before(panel);
  const { regions, refusal } = model.edits;
  const names = model.regions.map(({ name }) => name);
  const keys = [['E', 'e', 'Edit spheres and ignored parts', () => (store.state.editing ? document.getElementById('tab-contacts') : tab).click()], ...KEYS.map(([label, what]) => [label, null, what, () => {}])];
  const why = refusal ?? (stage ? null : 'Editing needs WebGL 2, which this browser has not.');
  if (why) {
    panel.append(h('p', {}, why));
    return { keys: keys.slice(0, 1), draw() {}, overlay: null, read: () => null, asReset: (state) => state };
  }

  const history = new History(startState(model.edits, names, model.spheres));
  let saved = history.now;
  let view = null;
  let shown = null;
  const sphereOf = (id) => history.now.spheres.find((s) => s.id === id && !s.deleted) ?? null;
  const shownRadius = (of) => (store.state.radius === 'fit' ? of.radius : of.detect_radius ?? of.radius);
  const sizeOf = (region, of) => (shownRadius(of) * regions[region].length) / model.mesh.unitsPerMm;
  const factors = ({ radius, detect_radius: detect = radius }) => [SMALLEST / radius, LARGEST / detect];
  const fileName = `${model.inspect.source.file.replace(/[.][^.]*$/, '')}_edits.json`;

  const actions = {
    picked: () => view?.picked ?? null,
    pick: (id) => view.pick(id),
    name: ({ id, region, origin }) => {
      const where = model.spheres[id]?.name ?? names[region].replaceAll('_', ' ');
      return origin === null ? `New sphere, ${where}` : `Sphere ${id}, ${where}`;
    },
    place: (id, to, kind) => history.push(place(history.now, id, to), kind, performance.now()),
    // Both radii by the same factor.
    grow(factor) {
      const sphere = sphereOf(view.picked);
      if (!sphere) return;
      const now = placeNow(sphere);
      const [least, most] = factors(now);
      const by = (x) => Number((x * Math.min(Math.max(factor, least), most)).toPrecision(7));
      const to = { ...now, radius: by(now.radius) };
      if (now.detect_radius !== undefined) to.detect_radius = Math.max(by(now.detect_radius), to.radius);
      actions.place(sphere.id, to, `grow ${sphere.id}`);
    },
    // Null, or the least and the most millimetres where these are refused.
    resize(mm) {
      const sphere = sphereOf(view.picked);
      if (!sphere) return null;
      const size = sizeOf(sphere.region, placeNow(sphere));
      const [least, most] = factors(placeNow(sphere)).map((factor) => factor * size);
      if (!(mm >= least && mm <= most)) return [least, most];
      actions.grow(mm / size);
      return null;
    },
    // In the picture, by millimetres to the right and up.
    nudge(right, up) {
      const sphere = sphereOf(view.picked);
      if (!sphere) return;
      const { camera, toWorld } = stage.inner;
      const back = toWorld().clone().invert();
      const axis = (column) => new Vector3().setFromMatrixColumn(camera.matrixWorld, column).transformDirection(back);
      const now = placeNow(sphere);
      const by = axis(0).multiplyScalar(right).addScaledVector(axis(1), up).multiplyScalar(model.mesh.unitsPerMm);
      const point = pointOf(regions[sphere.region], now).map((x, k) => x + by.getComponent(k));
      const { along, across } = placeOf(regions[sphere.region], point, 0, 0);
      actions.place(sphere.id, { ...now, along, across }, `nudge ${sphere.id}`);
    },
    add() {
      if (!sphereOf(view.picked)) return;
      const next = addBeside(history.now, view.picked);
      history.push(next);
      view.pick(next.spheres.at(-1).id);
    },
    remove() {
      if (sphereOf(view.picked) && mayRemove(history.now, view.picked)) history.push(remove(history.now, view.picked));
    },
    restore: (id) => history.push(restore(history.now, id)),
    ignore: (pair) => history.push(ignore(history.now, pair)),
    unignore: (pair) => history.push(unignore(history.now, pair)),
    forget: (edit) => history.push(forget(history.now, edit)),
    file: () => fileOf(history.now, names),
    save() {
      const text = `${JSON.stringify(actions.file(), null, 1)}\n`;
      h('a', { href: `data:application/json;charset=utf-8,${encodeURIComponent(text)}`, download: fileName }).click();
      saved = history.now;
      shown.update();
    },
    fileName,
    isSaved: () => history.now === saved,
  };

  view = createEditorView({
    model,
    skin,
    store,
    stage,
    layers,
    canvas,
    overlay,
    regions,
    history,
    actions: { ...actions, picked: () => shown?.update(), moving: (to) => shown?.update(to) },
  });
  shown = fillEditorPanel(panel, { model, store, regions, history, actions, sizeOf });

  // The tab that is open says what goes on. Meanwhile the skin shows through the spheres, and they through the skin.
  const seeThrough = { spheres: true, skinOpacity: 0.6, sphereOpacity: 0.24 };
  const lookOf = (state) => Object.fromEntries(Object.keys(seeThrough).map((key) => [key, state[key]]));
  let before = null;
  new MutationObserver(() => {
    const editing = tab.getAttribute('aria-selected') === 'true';
    if (editing === store.state.editing) return;
    if (editing) before = lookOf(store.state);
    store.set({ editing, playing: false, ...(editing ? { posing: false, pinned: null, pointed: null, ...seeThrough } : before) });
    const [a, b] = (store.state.contact ?? '').split('-').map((part) => model.parts.find((other) => `${other.part}` === part)?.name);
    if (editing && a !== b) shown.offer(a, b);
  }).observe(tab, { attributeFilter: ['aria-selected'] });
  store.watch(['playing', 'posing'], ({ editing, playing, posing }) => editing && (playing || posing) && document.getElementById('tab-contacts').click());
  store.watch(['editing'], ({ editing }) => document.body.classList.toggle('editing', editing));

  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  function handle(event) {
    const { key, shiftKey: shift } = event;
    const by = stepOf(event);
    if (by !== 0) return () => history.step(by);
    if (event.ctrlKey || event.metaKey || event.altKey) return null;
    if (arrows[key]) return () => actions.nudge(...arrows[key].map((step) => step * (shift ? 5 : 1) * NUDGE));
    if (key === '+' || key === '=') return () => actions.grow(1.03);
    if (key === '-') return () => actions.grow(1 / 1.03);
    if (key === 'Delete' || key === 'Backspace') return actions.remove;
    if (key.toLowerCase() === 'a') return actions.add;
    if (key === 'Escape') return () => view.pick(null);
    return [' ', 'Home', 'End', 'd', 'D'].includes(key) ? () => {} : null; // of the timeline
  }
  document.addEventListener(
    'keydown',
    (event) => {
      const { target } = event;
      if (!store.state.editing || document.querySelector('dialog[open]') || /^(INPUT|SELECT)$/.test(target.tagName)) return;
      if (target.role === 'tab' && arrows[event.key]) return;
      if (event.key === ' ' && /^(BUTTON|SUMMARY)$/.test(target.tagName)) return;
      const action = handle(event);
      if (!action) return;
      event.preventDefault();
      event.stopPropagation();
      if (!view.isDragging) action();
    },
    { capture: true },
  );
  addEventListener('beforeunload', (event) => history.now !== saved && event.preventDefault());

  const stale = h('p', { class: 'note', id: 'stale' }, 'Contacts are those of the spheres as baked: bake again with your edits.');
  document.getElementById('contacts').prepend(stale);
  const say = () => (stale.hidden = !history.canUndo);
  history.listeners.push(say);
  say();

  return {
    keys,
    // State after a reset to `start`: while spheres are edited they stay visible, and the initial view comes after.
    asReset(start) {
      if (!store.state.editing) return start;
      before = lookOf(start);
      return { ...start, ...seeThrough };
    },
    draw: view.draw,
    overlay: view.overlay,
    // For tests and other tools: the file as it would be saved, and where spheres are, in source units.
    read: () => ({
      file: actions.file(),
      picked: view.picked,
      spheres: history.now.spheres.filter((s) => !s.deleted).map((s) => ({ id: s.id, center: pointOf(regions[s.region], placeNow(s)), radius: placeNow(s).radius * regions[s.region].length })),
    }),
  };
}
