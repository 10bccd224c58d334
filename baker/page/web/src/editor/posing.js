import './posing.css';
import { commandBlock, h } from '../base/dom.js';
import { check } from '../panels/controls.js';
import { History, stepOf } from './history.js';
import { hasRuntime, openLive } from './live.js';
import { addHandles } from './pose_handles.js';
import { Poser } from './poser.js';
import { Refit } from '../model/refit.js';

// Posing by hand. It starts from the frame that is shown, and takes that frame's place until another frame is shown: its
// bones are written over the frame's, and what touches is found anew after each movement.

const SETTLED_MS = 120; // after the last movement; then depths are measured anew, as those of a frame are
const FAST_MS = 5; // depths that take no longer are all measured along all directions at every movement, else likely faults alone

// A character that takes over the bones of one frame.
class Posed {
  constructor(model, skin) {
    Object.assign(this, { skin, frame: null, poser: new Poser(model.rig) });
    this.bones = model.motion.bones;
    this.size = 12 * model.motion.boneCount;
  }

  start(frame) {
    this.frame = frame;
    this.kept = this.bones.slice(frame * this.size, (frame + 1) * this.size);
    this.poser.load(this.kept);
    this.show();
  }

  palette() {
    return this.bones.subarray(this.frame * this.size, (this.frame + 1) * this.size);
  }

  show() {
    this.palette().set(this.poser.whole.subarray(0, this.size));
    this.skin.frame = -1; // to be posed again
  }

  // The frame is again as it was.
  stop() {
    if (this.frame === null) return;
    this.palette().set(this.kept);
    this.skin.frame = -1;
    this.frame = null;
  }
}

export function addPosing({ model, skin, store, stage, toolbar, canvas }) {
  if (!model.rig || model.motion.boneCount !== model.rig.joints.length || !stage) return null;
  const posed = new Posed(model, skin);
  const { poser } = posed;
  const refit = new Refit(model.inspect, model.mesh, skin);
  const history = new History({ frame: null, isChanged: false }); // {frame, own, isChanged}: whether it is other than its frame's
  let saved = null;
  let live = null;
  let response = null;
  let fullMs = Infinity; // that the last full measure took
  let settle = 0;
  let isSettled = false;
  const times = { contacts: 0, depths: 0, all: 0 }; // milliseconds of the last change: all is what the drawing waits for

  const find = (isQuick, isLast = false) => {
    if (isLast) live?.forget();
    const found = live?.find(posed.palette(), model.rig.morphWeights(posed.frame), isQuick) ?? { pairs: [], measures: new Map(), times: {} };
    Object.assign(times, found.times);
    isSettled = isLast;
    if (!isQuick) fullMs = times.depths;
    model.contacts.show(found);
    const spheres = {};
    model.live = {
      pairs: found.pairs,
      sphere(i, kind) {
        if (!live) return refit.sphere(i, kind);
        spheres[kind] ??= live.spheres(kind);
        return spheres[kind].subarray(4 * i, 4 * i + 4);
      },
      touching: (kind) => live?.touching(kind) ?? [],
    };
    store.set({ pose: store.state.pose + 1 });
  };
  const show = (start = performance.now()) => {
    posed.show();
    const isQuick = fullMs > FAST_MS;
    clearTimeout(settle);
    settle = setTimeout(() => posed.frame !== null && find(false, true), SETTLED_MS);
    find(isQuick);
    times.all = performance.now() - start;
  };
  const stateNow = (isChanged) => ({ frame: posed.frame, own: poser.own.slice(), isChanged });
  const correct = (drag) => store.state.respond && response?.correct(drag, model.rig.morphWeights(posed.frame));
  // `drag`: the movement that goes on; all of it is one step back.
  const changed = (drag) => {
    const start = performance.now();
    correct(drag);
    history.push(stateNow(true), drag);
    show(start);
  };
  const stop = () => {
    clearTimeout(settle);
    posed.stop();
    model.live = null;
    model.contacts.show(null);
    store.set({ pose: 0, joint: null });
  };
  const say = (text) => (status.textContent = text);
  let isLoading = false;
  const load = () => {
    if (isLoading) return;
    isLoading = true;
    if (!hasRuntime || !model.rig.asset) return say('This page was built without the runtime: it finds no contacts in your poses.');
    openLive(model.rig.asset, model.mesh).then(
      (opened) => {
        live = opened;
        response = live.responseOf(poser);
        keepOut.hidden = response === null;
        if (posed.frame !== null) find(false, true);
      },
      (error) => say(`This browser cannot find contacts: ${error.message}`),
    );
  };
  let isGoingBack = false;
  // A pose that was left stays in the history.
  const start = (frame) => {
    load();
    posed.start(frame);
    const { now } = history;
    if (!isGoingBack && now.isChanged) history.push(stateNow(false));
    else if (!isGoingBack && now.frame !== frame) history.replace(stateNow(false));
    find(false, true);
  };

  const step = (by) => {
    if (handles.isDragging()) return;
    history.step(by);
    const { frame, own } = history.now;
    isGoingBack = true;
    store.set({ frame });
    isGoingBack = false;
    poser.take(own);
    show();
  };
  const reset = () => {
    if (!history.now.isChanged) return;
    poser.load(posed.kept);
    history.push(stateNow(false));
    show();
  };
  const file = () => {
    const clip = model.clips[model.clipAt(posed.frame)].name;
    const name = `pose of ${model.title.replace(/[.]sphc$/, '')}`;
    return poser.file(name, `From ${clip}, frame ${model.number(posed.frame)}.`, model.rig.morphWeights(posed.frame));
  };
  const fileName = `${model.title.replace(/[.]sphc$/, '')}_pose.json`;
  const save = () => {
    const url = URL.createObjectURL(new Blob([textOf(file())], { type: 'application/json' }));
    h('a', { href: url, download: fileName }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
    saved = history.now;
    tell();
  };

  const button = (id, text, title, onclick) => h('button', { type: 'button', id, title, onclick }, text);
  const toggle = () => store.set({ posing: !store.state.posing, playing: false });
  const open = button('pose', 'Pose', 'Pose the character by hand (J)', toggle);
  const undoButton = button('pose-undo', 'Undo', 'Undo the last change (Ctrl Z)', () => step(-1));
  const redoButton = button('pose-redo', 'Redo', 'Redo what was undone (Ctrl Shift Z, Ctrl Y)', () => step(1));
  const resetButton = button('pose-reset', 'As in the frame', 'Back to the pose of the frame', reset);
  const saveButton = button('pose-save', 'Save pose', 'Download the pose as a pose file', save);
  const keepOut = check(store, 'respond', 'Keep arms out of the body', 'K');
  keepOut.hidden = true;
  const status = h('p', { role: 'status' });
  const turned = h('p', { id: 'pose-joint' });
  const command = commandBlock('spherechain', 'play', model.title, '--source', model.inspect.source.file, '--poses', fileName, '--frames', '1');
  const how = h('div', { id: 'pose-how' }, h('p', {}, 'Its contacts, printed:'), command);
  const bar = h(
    'div',
    { id: 'posing', 'aria-label': 'Pose', role: 'group', hidden: true },
    h('p', {}, 'Drag a handle. Click a joint to turn it.'),
    turned,
    keepOut,
    h('div', { class: 'pose-steps' }, undoButton, redoButton),
    resetButton,
    saveButton,
    how,
    status,
  );
  toolbar.before(open);
  canvas.parentElement.append(bar);
  const handles = addHandles({ poser, mesh: model.mesh, stage, store, canvas, changed });
  const tell = () => {
    undoButton.disabled = !history.canUndo;
    redoButton.disabled = !history.canRedo;
    how.hidden = history.now !== saved;
  };

  store.watch(['posing', 'frame'], ({ posing, frame }) => {
    open.setAttribute('aria-pressed', posing);
    bar.hidden = !posing;
    if (posing && posed.frame === frame) return;
    if (posed.frame !== null) stop();
    if (posing) start(frame);
  });
  store.watch(['playing'], ({ playing }) => playing && store.set({ posing: false }));
  store.watch(['pose', 'posing'], () => {
    tell();
    handles.place();
  });
  store.watch(['respond'], ({ posing }) => {
    if (!posing || !history.now.isChanged || !correct({ from: poser.own.slice() })) return;
    history.push(stateNow(true));
    show();
  });
  store.watch(['pose', 'posing', 'joint'], ({ posing, joint }) => {
    turned.hidden = !posing || joint === null;
    if (!turned.hidden) turned.replaceChildren(h('b', {}, model.rig.joints[joint].name), ` ${poser.angle(joint).toFixed(0)}° from rest`);
  });
  document.addEventListener('keydown', (event) => {
    const by = stepOf(event);
    if (!store.state.posing || by === 0 || document.querySelector('dialog[open]')) return;
    event.preventDefault();
    step(by);
  });
  addEventListener('beforeunload', (event) => history.now.isChanged && history.now !== saved && event.preventDefault());

  const keys = [
    ['J', 'j', 'Pose the character by hand', toggle],
    ['K', 'k', 'Pose: keep arms out of the body', () => store.set({ respond: !store.state.respond })],
    ['Ctrl Z', null, 'Pose: undo; with Shift redo', () => {}],
  ];
  return { keys, toggle, place: handles.place, file, times, isLive: () => live !== null, isSettled: () => isSettled };
}

// A joint a line.
function textOf({ poses: [pose], ...rest }) {
  const lines = Object.entries(pose).map(([joint, numbers]) => `      ${JSON.stringify(joint)}: ${JSON.stringify(numbers).replaceAll(',', ', ')}`);
  const head = Object.entries(rest).map(([key, value]) => `  ${JSON.stringify(key)}: ${JSON.stringify(value)},\n`);
  return `{\n${head.join('')}  "poses": [\n    {\n${lines.join(',\n')}\n    }\n  ]\n}\n`;
}
