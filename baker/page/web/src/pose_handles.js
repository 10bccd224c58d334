import { Object3D, Quaternion, Vector3 } from 'three';
import { TransformControls } from 'three/addons/controls/TransformControls.js';
import { h } from './dom.js';

// Handles of a character that is posed by hand, over the picture: of the ends of limbs, elbows and knees, head and hips, and a
// small one of every other joint. A drag moves the skeleton; a click takes the rotation gizmo to the joint.

const CLICK = 4; // pixels that a click may move

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

export function addHandles({ poser, mesh, stage, store, canvas, remember, changed }) {
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
  const soon = (action) => {
    if (next === null) {
      requestAnimationFrame(() => {
        const latest = next;
        next = null;
        latest();
      });
    }
    next = action;
  };
  let from = null; // the pose before the drag
  const again = (action) => {
    poser.take(from);
    action();
    changed();
  };

  let grip = null; // what the pointer holds
  const letGo = () => (grip = null);
  // The grip stays in the plane through it that faces the eye.
  const pointAt = (x, y) => {
    const { origin, direction } = stage.ray(x, y);
    const along = grip.at.clone().sub(origin).dot(grip.back) / direction.dot(grip.back);
    return origin.clone().addScaledVector(direction, along);
  };
  store.watch(['frame', 'posing'], letGo);
  let isDragged = false;
  const handles = handlesOf(poser, mesh).map((handle) => {
    const { name, kind, joint, at, drag } = handle;
    const button = h('button', { type: 'button', class: `handle ${kind}`, title: name, 'aria-label': `Handle: ${name}` });
    button.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      button.setPointerCapture(event.pointerId);
      const { back } = stage.camera();
      grip = { button, x: event.clientX, y: event.clientY, at: at(), back: new Vector3(...back) };
      isDragged = false;
    });
    button.addEventListener('pointermove', ({ clientX: x, clientY: y }) => {
      if (grip?.button !== button || !drag || (!isDragged && Math.hypot(x - grip.x, y - grip.y) < CLICK)) return;
      if (!isDragged) {
        isDragged = true;
        grip.start = pointAt(grip.x, grip.y);
        remember();
        from = poser.own.slice();
      }
      const to = grip.at.clone().add(pointAt(x, y)).sub(grip.start);
      soon(() => again(() => drag(to)));
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
    if (!value) return;
    remember();
    from = poser.own.slice();
    rest = own.quaternion.clone();
  });
  gizmo.addEventListener('objectChange', () => {
    if (!gizmo.dragging) return;
    const by = own.quaternion.clone().multiply(rest.clone().invert()); // in the world
    const axes = new Quaternion(); // of the source in the world
    toWorld().clone().decompose(new Vector3(), axes, new Vector3());
    const inSource = axes.clone().invert().multiply(by).multiply(axes);
    const { joint } = store.state;
    soon(() => again(() => poser.turn(joint, inSource)));
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
    // Handles go to their joints in the picture; `latest` takes source units to pixels.
    place(latest = project) {
      project = latest;
      box.hidden = !store.state.posing;
      if (box.hidden || !project) return;
      for (const { at, button, kind } of handles) {
        const { x, y, depth } = project(...at().toArray());
        button.style.zIndex = Math.round(1e6 * (1 - depth)) + (kind === 'joint' ? 0 : 1e7); // the nearest on top, small ones below
        button.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px) translate(-50%, -50%)`;
      }
    },
  };
}
