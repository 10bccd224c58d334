import { Object3D, Quaternion, Vector3 } from 'three';
import { TransformControls } from 'three/addons/controls/TransformControls.js';
import { h } from '../base/dom.js';
import { dragPlane } from './drag_plane.js';

// Handles of a character that is posed by hand, over the picture: of the ends of limbs, elbows and knees, head and hips, and a
// small one of every other joint. A drag moves the skeleton; a click takes the rotation gizmo to the joint.

const CLICK = 4; // pixels that a click may move
const NEAR = 12; // pixels: a small handle that is so near to another one is left out

// Joints that move skin, by their own weight.
function movers({ joints, weights }) {
  const out = new Set();
  for (let i = 0; i < joints.length; ++i) if (weights[i] > 0) out.add(joints[i]);
  return out;
}

// [{name, kind, joint, at(), drag(to)}]; the first of a joint is its handle.
function handlesOf(poser, mesh) {
  const { limbs, hips, head, joints } = poser.rig;
  const out = [];
  for (const limb of limbs) {
    out.push({ name: limb.name, kind: 'end', joint: limb.end, at: () => poser.tip(limb), drag: (to) => poser.drag(limb, to) });
    out.push({ name: limb.middle_name, kind: 'middle', joint: limb.middle, at: () => poser.place(limb.middle), drag: (to) => poser.dragMiddle(limb, to) });
  }
  if (head >= 0) out.push({ name: 'head', kind: 'end', joint: head, at: () => poser.head(), drag: (to) => poser.dragHead(to) });
  if (hips >= 0) out.push({ name: 'hips', kind: 'end', joint: hips, at: () => poser.place(hips), drag: (to) => poser.dragHips(to) });
  const taken = new Set(out.map(({ joint }) => joint));
  const moving = movers(mesh);
  joints.forEach(({ name }, joint) => taken.has(joint) || !moving.has(joint) || out.push({ name, kind: 'joint', joint, at: () => poser.place(joint), drag: null }));
  return out;
}

export function addHandles({ poser, mesh, stage, store, canvas, changed }) {
  const box = h('div', { id: 'handles' });
  canvas.parentElement.append(box);
  const { scene, camera, controls, toWorld } = stage.inner;
  const own = new Object3D(); // what the gizmo turns: the chosen joint
  const gizmo = new TransformControls(camera, canvas);
  gizmo.setMode('rotate');
  gizmo.setSpace('local');
  gizmo.setSize(0.7);
  const helper = gizmo.getHelper();
  scene.add(own);

  // Once for each picture, however often the pointer moves.
  let next = null;
  const flush = () => {
    const latest = next;
    next = null;
    latest?.();
  };
  let drag = null; // that goes on or was the last: the pose before it
  const soon = (action) => {
    if (next === null) requestAnimationFrame(flush);
    const of = drag;
    next = () => {
      poser.take(of.from);
      action();
      changed(of);
    };
  };

  let grip = null; // what the pointer holds
  const letGo = () => {
    flush();
    grip = null;
  };
  store.watch(['frame', 'posing'], () => (grip = next = null));
  let isDragged = false;
  const handles = handlesOf(poser, mesh).map((handle) => {
    const { name, kind, joint } = handle;
    const button = h('button', { type: 'button', class: `handle ${kind}`, title: name, 'aria-label': `Handle: ${name}` });
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      grip = { button, hold: event, to: dragPlane(stage, handle.at(), event) };
      isDragged = false;
    });
    button.addEventListener('pointermove', (event) => {
      if (grip?.button !== button || !handle.drag) return;
      if (!isDragged && Math.hypot(event.clientX - grip.hold.clientX, event.clientY - grip.hold.clientY) < CLICK) return;
      if (!isDragged) drag = { from: poser.own.slice() };
      isDragged = true;
      const to = grip.to(event);
      soon(() => handle.drag(to));
    });
    button.addEventListener('pointerup', letGo);
    button.addEventListener('pointercancel', letGo);
    button.addEventListener('click', () => {
      if (!isDragged) store.set({ joint: store.state.joint === joint ? null : joint });
      isDragged = false;
    });
    return { ...handle, button };
  });
  box.append(...handles.map(({ button }) => button));

  // The gizmo's axes are the joint's at rest, turned as the joint is.
  let rest = null;
  const frameOf = (j) => {
    const world = toWorld();
    own.position.copy(poser.place(j).applyMatrix4(world));
    world.clone().multiply(poser.wholeOf(j)).decompose(new Vector3(), own.quaternion, new Vector3());
    own.updateMatrixWorld();
  };
  gizmo.addEventListener('dragging-changed', ({ value }) => {
    controls.enabled = !value;
    if (!value) return flush();
    drag = { from: poser.own.slice() };
    rest = own.quaternion.clone();
  });
  gizmo.addEventListener('objectChange', () => {
    if (!gizmo.dragging) return;
    const by = own.quaternion.clone().multiply(rest.clone().invert()); // in the world
    const axes = new Quaternion(); // of the source in the world
    toWorld().clone().decompose(new Vector3(), axes, new Vector3());
    const inSource = axes.clone().invert().multiply(by).multiply(axes);
    const { joint } = store.state;
    soon(() => poser.turn(joint, inSource));
  });
  gizmo.addEventListener('change', () => stage.invalidate());
  store.watch(['joint', 'pose'], ({ joint, posing }) => {
    const isShown = posing && joint !== null;
    if (!isShown && gizmo.object) {
      gizmo.detach();
      scene.remove(helper);
    }
    if (isShown && !gizmo.dragging) {
      frameOf(joint);
      if (!gizmo.object) {
        gizmo.attach(own);
        scene.add(helper);
      }
    }
    for (const handle of handles) handle.button.setAttribute('aria-pressed', isShown && handle.joint === joint);
    stage.invalidate();
  });

  let project = null;
  return {
    isDragging: () => grip !== null || gizmo.dragging,
    // Handles go to their joints in the picture; `latest` takes source units to pixels.
    place(latest = project) {
      project = latest;
      box.hidden = !store.state.posing;
      if (box.hidden || !project) return;
      const rank = ({ kind, joint }) => (kind !== 'joint' ? 0 : joint === store.state.joint ? 1 : 2);
      const seen = handles.map(({ at, ...handle }) => ({ ...handle, ...project(...at().toArray()) }));
      seen.sort((a, b) => rank(a) - rank(b) || a.depth - b.depth);
      const shown = [];
      for (const handle of seen) {
        const { x, y, depth, button, kind } = handle;
        button.hidden = rank(handle) === 2 && shown.some((other) => Math.hypot(other.x - x, other.y - y) < NEAR);
        if (button.hidden) continue;
        shown.push(handle);
        button.style.zIndex = Math.round(1e6 * (1 - depth)) + (kind === 'joint' ? 0 : 1e7); // the nearest on top, small ones below
        button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      }
    },
  };
}
