import './posing.css';
import { h } from './dom.js';
import { hasRuntime, openLive } from './live.js';
import { addHandles } from './pose_handles.js';
import { Poser } from './poser.js';
import { Refit } from './refit.js';

// Posing by hand. It starts from the frame that is shown, and takes that frame's place until another frame is shown: its
// bones are written over the frame's, and what touches is found anew after each movement.

const SETTLED_MS = 120; // after the last movement; then depths are measured anew, as those of a frame are
const FAST_MS = 5; // depths that take no longer are measured along all directions at every movement, else along one

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
  const history = []; // poses that a drag or a reset has changed: {frame, own}
  let live = null;
  let fullMs = Infinity; // that the last full measure took
  let settle = 0;
  let isSettled = false;
  let isChanged = false; // the frame's pose, since it was taken over
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
  const changed = () => {
    if (posed.frame === null) return; // left meanwhile
    const start = performance.now();
    isChanged = true;
    posed.show();
    const isQuick = fullMs > FAST_MS;
    clearTimeout(settle);
    settle = setTimeout(() => posed.frame !== null && find(false, true), SETTLED_MS);
    find(isQuick);
    times.all = performance.now() - start;
  };
  const remember = () => {
    history.push({ frame: posed.frame, own: poser.own.slice() });
    if (history.length > 200) history.shift();
  };
  const stop = () => {
    clearTimeout(settle);
    if (isChanged) remember(); // undo brings it back
    isChanged = false;
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
        if (posed.frame !== null) find(false, true);
      },
      (error) => say(`This browser cannot find contacts: ${error.message}`),
    );
  };
  const start = (frame) => {
    load();
    posed.start(frame);
    find(false, true);
  };

  const undo = () => {
    const last = history.pop();
    if (!last) return;
    isChanged = false; // what is taken back now is not to come back
    if (last.frame !== posed.frame) store.set({ frame: last.frame });
    poser.take(last.own);
    changed();
  };
  const reset = () => {
    remember();
    poser.load(posed.kept);
    changed();
  };
  const file = () => {
    const clip = model.clips[model.clipAt(posed.frame)].name;
    const name = `pose of ${model.title.replace(/[.]sphc$/, '')}`;
    return poser.file(name, `From ${clip}, frame ${model.number(posed.frame)}.`, model.rig.morphWeights(posed.frame));
  };
  const save = () => {
    const url = URL.createObjectURL(new Blob([textOf(file())], { type: 'application/json' }));
    h('a', { href: url, download: `${model.title.replace(/[.]sphc$/, '')}_pose.json` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  };

  const button = (id, text, title, onclick) => h('button', { type: 'button', id, title, onclick }, text);
  const toggle = () => store.set({ posing: !store.state.posing, playing: false });
  const open = button('pose', 'Pose', 'Pose the character by hand (J)', toggle);
  const undoButton = button('pose-undo', 'Undo', 'Undo the last change (Ctrl Z)', undo);
  const resetButton = button('pose-reset', 'As in the frame', 'Back to the pose of the frame', reset);
  const saveButton = button('pose-save', 'Save pose', 'Download the pose as a pose file', save);
  const status = h('p', { role: 'status' });
  const bar = h(
    'div',
    { id: 'posing', 'aria-label': 'Pose', role: 'group', hidden: true },
    h('p', {}, 'Drag a handle. Click a joint to turn it.'),
    undoButton,
    resetButton,
    saveButton,
    status,
  );
  toolbar.before(open);
  canvas.parentElement.append(bar);
  const handles = addHandles({ poser, mesh: model.mesh, stage, store, canvas, remember, changed });

  store.watch(['posing', 'frame'], ({ posing, frame }) => {
    open.setAttribute('aria-pressed', posing);
    bar.hidden = !posing;
    if (posing && posed.frame === frame) return;
    if (posed.frame !== null) stop();
    if (posing) start(frame);
  });
  store.watch(['playing'], ({ playing }) => playing && store.set({ posing: false }));
  store.watch(['pose', 'posing'], () => {
    undoButton.disabled = history.length === 0;
    handles.place();
  });
  document.addEventListener('keydown', (event) => {
    if (!store.state.posing || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== 'z') return;
    event.preventDefault();
    undo();
  });

  return { toggle, place: handles.place, file, times, isLive: () => live !== null, isSettled: () => isSettled };
}

// A joint a line.
function textOf({ poses: [pose], ...rest }) {
  const lines = Object.entries(pose).map(([joint, numbers]) => `      ${JSON.stringify(joint)}: ${JSON.stringify(numbers).replaceAll(',', ', ')}`);
  const head = Object.entries(rest).map(([key, value]) => `  ${JSON.stringify(key)}: ${JSON.stringify(value)},\n`);
  return `{\n${head.join('')}  "poses": [\n    {\n${lines.join(',\n')}\n    }\n  ]\n}\n`;
}
