import { commandBlock, h } from '../base/dom.js';
import { distance, fileOf, isEdited, isIgnored, kindOf, mayRemove, placeNow } from './editor_state.js';
import { number, plural } from '../base/format.js';
import { EDITED } from '../base/palette.js';

// The panel of the editor: the picked sphere, the parts to ignore, the edits so far, and the file.

const words = (name) => name.replaceAll('_', ' ');
const at = ({ along }) => `${Math.round(100 * along)} %`;

export function fillEditorPanel(panel, { model, store, regions, history, actions, sizeOf }) {
  const names = model.regions.map(({ name }) => name);
  const button = (id, text, title, onclick) => h('button', { type: 'button', id, class: 'edit-button', title, onclick }, text);
  const swatch = (colour) => h('span', { class: 'swatch', style: `background: ${colour}` });

  const undo = button('edit-undo', '↶ Undo', 'Ctrl Z', () => history.step(-1));
  const redo = button('edit-redo', '↷ Redo', 'Ctrl Shift Z', () => history.step(1));
  const add = button('edit-add', 'Add', 'A copy of the picked sphere, beside it (A)', actions.add);
  const remove = button('edit-delete', 'Delete', 'Del', actions.remove);
  const title = h('h2', { id: 'edit-title' });
  const where = h('p', { class: 'note' });
  const size = h('input', { type: 'number', id: 'edit-size', min: 0, step: 'any', onchange: () => resize() });
  const larger = button('edit-larger', '+', 'Larger (+, or Shift and the wheel)', () => actions.grow(1.05));
  const smaller = button('edit-smaller', '−', 'Smaller (−, or Shift and the wheel)', () => actions.grow(1 / 1.05));
  const figures = h('div', { class: 'row' }, h('label', { for: 'edit-size' }, 'Radius, mm'), h('span', { class: 'edit-sizes' }, smaller, size, larger));
  const limit = h('p', { class: 'note warning', id: 'edit-limit', role: 'status', hidden: true });
  const resize = () => {
    if (!pickedSphere()) return;
    const limits = actions.resize(Number(size.value));
    limit.hidden = limits === null;
    if (limits) limit.textContent = `A radius here is ${limits.map((mm) => number(Number(mm.toPrecision(2)))).join(' to ')} mm.`;
    showSize();
  };
  const pickedSphere = () => history.now.spheres.find((s) => s.id === actions.picked() && !s.deleted) ?? null;
  const showSize = (now = placeNow(pickedSphere())) => (size.value = sizeOf(pickedSphere().region, now).toFixed(1));
  for (const name of ['keydown', 'keyup']) size.addEventListener(name, (event) => event.stopPropagation());

  const parts = model.parts.map(({ name }) => name).filter((name) => name !== 'other parts').sort();
  const select = (id, label) =>
    h('select', { id, 'aria-label': label, onchange: () => update() }, h('option', { value: '' }, label), ...parts.map((name) => h('option', { value: name }, name)));
  const first = select('edit-part-a', 'a body part');
  const second = select('edit-part-b', 'another part');
  const ignore = button('edit-ignore', 'Ignore', 'Contacts of these two parts are not reported', () => {
    actions.ignore([first.value, second.value]);
    first.value = second.value = '';
    update();
  });

  const list = h('ol', { class: 'pairs', id: 'edit-list' });
  const count = h('h2', { role: 'status' });
  const save = button('edit-save', 'Save edits', 'Downloads the file for spherechain bake --edits', actions.save);
  const command = commandBlock('spherechain', 'bake', model.inspect.source.file, '--edits', actions.fileName, '-o', model.title);
  const how = h('div', { class: 'edit-how' }, h('p', { class: 'note' }, 'Then bake again, with the options of the first bake:'), command);

  panel.replaceChildren(
    h('p', { class: 'note' }, 'The character stands at rest. Click a sphere, then drag it or its arrows. Shift and the wheel change its size. The next bake applies your edits.'),
    h('div', { class: 'edit-buttons' }, undo, redo, add, remove),
    title,
    where,
    figures,
    limit,
    h('h2', {}, 'Ignore contacts of two parts'),
    h('div', { class: 'edit-parts' }, first, second, ignore),
    count,
    save,
    how,
    list,
    h('div', { class: 'edit-legend' }, ...Object.entries(EDITED).map(([kind, colour]) => h('span', { class: 'legend' }, swatch(colour), kind))),
  );

  const millimetres = (a, b, region) => {
    return Math.round((distance(a, b) * regions[region].length) / model.mesh.unitsPerMm);
  };
  function whatOf(sphere) {
    const { origin, to, deleted, region } = sphere;
    if (deleted || origin === null) return kindOf(sphere);
    const by = millimetres(origin, to, region);
    const share = Math.round(100 * (to.radius / origin.radius - 1));
    const said = [by > 0 && `moved ${by} mm`, share !== 0 && `${Math.abs(share)} % ${share > 0 ? 'larger' : 'smaller'}`].filter(Boolean);
    return said.length > 0 ? said.join(', ') : 'moved less than 1 mm';
  }
  const row = (name, what, colour, key, onclick, takeBack) =>
    h(
      'li',
      { class: 'edit-row' },
      h('button', { type: 'button', class: 'pair', 'data-edit': key, disabled: !onclick, onclick }, swatch(colour), h('span', { class: 'part-names' }, name), h('span', { class: 'count' }, what)),
      h('button', { type: 'button', class: 'link', title: 'Take this edit back', 'aria-label': `Take back: ${name}, ${what}`, onclick: takeBack }, '✕'),
    );

  function update(moving = null) {
    const state = history.now;
    const sphere = pickedSphere();
    undo.disabled = !history.canUndo;
    redo.disabled = !history.canRedo;
    add.disabled = !sphere;
    remove.disabled = !sphere || !mayRemove(state, sphere.id);
    figures.hidden = !sphere;
    title.textContent = sphere ? actions.name(sphere) : 'No sphere is picked';
    where.textContent = '';
    if (sphere) {
      const now = moving ?? placeNow(sphere);
      const edited = isEdited({ ...sphere, to: moving ?? sphere.to });
      where.textContent = `${at(now)} along the ${words(names[sphere.region])}${edited ? `, ${whatOf({ ...sphere, to: now })}` : ''}`;
      if (remove.disabled) where.append('. The last sphere of its region: it cannot be deleted');
      if (document.activeElement !== size) showSize(now);
    }
    if (document.activeElement !== size) limit.hidden = true;
    if (moving) return;
    ignore.disabled = !first.value || !second.value || first.value === second.value || isIgnored(state, [first.value, second.value]);
    const file = fileOf(state, names);
    const total = file.spheres.length + file.ignored_parts.length;
    count.textContent = total === 0 ? 'No edits yet' : plural(total, 'edit');
    list.replaceChildren(
      ...state.spheres.filter(isEdited).map((s) =>
        row(`${words(names[s.region])}, ${at(s.origin ?? s.to)}`, whatOf(s), EDITED[kindOf(s)], `${s.id}`, s.deleted ? null : () => actions.pick(s.id), () => actions.restore(s.id)),
      ),
      ...state.ignored.map((pair) => row(pair.join(' and '), 'ignored', 'var(--muted)', pair.join('-'), null, () => actions.unignore(pair))),
      ...state.missed.map((edit) => row(`${words(edit.region)} ${at(edit.from ?? edit.to)}`, 'not in this bake', 'var(--warning)', 'missed', null, () => actions.forget(edit))),
    );
    save.disabled = actions.isSaved();
    how.hidden = !history.canUndo;
  }
  history.listeners.push(() => update());
  store.watch(['radius'], () => update());
  update();
  return {
    update,
    // Offers two parts, as those of the contact that was looked at.
    offer(a, b) {
      if (parts.includes(a)) first.value = a;
      if (parts.includes(b)) second.value = b;
      update();
    },
  };
}
