import * as THREE from 'three';
import { TransformControls } from 'three/addons/controls/TransformControls.js';
import { css, fitCanvas } from '../base/dom.js';
import { dragPlane } from './drag_plane.js';
import { isEdited, kindOf, placeNow, placeOf, pointOf } from './editor_state.js';
import { Names } from '../scene/overlay.js';
import { EDITED, GHOST, POINTED, SPHERE } from '../base/palette.js';
import { SphereLayer } from '../scene/sphere_layer.js';

// The spheres that are edited, in the rest pose: a click picks one, it is dragged itself or by its arrows.

const ADDED_MAX = 400;
const CLICK = 5; // pixels

// Where a ray meets a sphere first; null where it does not.
function meet({ origin, direction }, center, radius) {
  const to = new THREE.Vector3(...center).sub(origin);
  const along = to.dot(direction) / direction.length();
  const away = to.lengthSq() - along * along;
  return along > 0 && away < radius * radius ? along - Math.sqrt(radius * radius - away) : null;
}

export function createEditorView({ model, skin, store, stage, layers, canvas, overlay, regions, history, actions }) {
  const capacity = 2 * (model.spheres.length + ADDED_MAX); // a sphere, and where it was
  const layer = new SphereLayer(capacity);
  const group = new THREE.Group();
  group.matrixAutoUpdate = false;
  group.visible = false;
  const held = new THREE.Object3D();
  group.add(layer.group, held);
  const { scene, camera, controls, toWorld } = stage.inner;
  scene.add(group);
  const gizmo = new TransformControls(camera, canvas);
  gizmo.setSize(0.7);
  gizmo.enabled = false;
  scene.add(gizmo.getHelper());

  let picked = null; // a sphere's number
  let moved = null; // while it is dragged: its place
  let pressed = null; // the pointer's event
  let grip = null; // of the sphere itself: where its centre goes as the pointer moves
  const kind = () => store.state.radius;
  const radiusAt = (place, region) => regions[region].length * (kind() === 'fit' ? place.radius : place.detect_radius ?? place.radius);
  const current = (sphere) => (moved && sphere.id === picked ? moved : placeNow(sphere));
  const sphereOf = (id) => history.now.spheres.find((s) => s.id === id && !s.deleted) ?? null;

  function dress() {
    for (const item of layer.items) item.alpha = 0;
    layer.rimColour.set(css('--rim'));
    let next = 0;
    const show = (region, place, colour, alpha, rim) => {
      const item = layer.items[next++];
      item.sphere = [...pointOf(regions[region], place), radiusAt(place, region)];
      item.colour.set(colour);
      Object.assign(item, { alpha, rim });
    };
    for (const sphere of history.now.spheres) {
      const { id, region, origin, to, deleted } = sphere;
      const isPicked = id === picked;
      const edited = isEdited(sphere) || (isPicked && moved !== null);
      if (next + 2 > capacity) break;
      if (origin && (deleted || to !== null)) show(region, origin, deleted ? EDITED.deleted : GHOST, deleted ? 0.16 : 0.1, deleted ? 0.14 : 0.08);
      if (deleted) continue;
      const colour = isPicked ? POINTED : edited ? EDITED[kindOf(sphere)] : SPHERE;
      const alpha = Math.max(store.state.sphereOpacity, isPicked || edited ? 0.75 : 0);
      show(region, current(sphere), colour, alpha, isPicked ? 0.3 : edited ? 0.16 : 0.05);
    }
    const sphere = sphereOf(picked);
    if (sphere && !gizmo.dragging) held.position.set(...pointOf(regions[sphere.region], current(sphere)));
    if (sphere && store.state.editing) gizmo.attach(held);
    else gizmo.detach();
    stage.invalidate();
  }

  function pick(id) {
    if (id !== null && !store.state.spheres) store.set({ spheres: true });
    picked = id;
    moved = grip = null;
    dress();
    actions.picked(id);
  }

  const under = ({ clientX, clientY }) => {
    if (!store.state.spheres) return null;
    const ray = stage.ray(clientX, clientY);
    let best = null;
    let nearest = Infinity;
    for (const sphere of history.now.spheres) {
      if (sphere.deleted) continue;
      const place = current(sphere);
      const reach = meet(ray, pointOf(regions[sphere.region], place), radiusAt(place, sphere.region));
      if (reach === null || reach >= nearest) continue;
      nearest = reach;
      best = sphere.id;
    }
    return best;
  };

  function moveTo(point) {
    const sphere = sphereOf(picked);
    const now = placeNow(sphere);
    moved = { ...now, ...placeOf(regions[sphere.region], point, 0, 0), radius: now.radius };
    if (now.detect_radius === undefined) delete moved.detect_radius;
    else moved.detect_radius = now.detect_radius;
    dress();
    actions.moving(moved);
  }
  function endMove() {
    const to = moved;
    moved = null;
    if (to) actions.place(picked, to);
    dress();
  }

  gizmo.addEventListener('change', () => stage.invalidate());
  gizmo.addEventListener('objectChange', () => moveTo(held.position.toArray()));
  gizmo.addEventListener('dragging-changed', ({ value }) => {
    controls.enabled = !value;
    if (!value) endMove();
  });

  const on = (name, listener) => canvas.addEventListener(name, (event) => store.state.editing && listener(event), { capture: true });
  on('pointerdown', (event) => {
    if (event.button !== 0) return;
    pressed = event;
    if (gizmo.axis !== null || picked === null || under(event) !== picked) return;
    event.stopImmediatePropagation();
    canvas.setPointerCapture(event.pointerId);
    const sphere = sphereOf(picked);
    grip = dragPlane(stage, new THREE.Vector3(...pointOf(regions[sphere.region], placeNow(sphere))), event);
  });
  on('pointermove', (event) => {
    if (!grip) return;
    event.stopImmediatePropagation();
    if (!moved && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < CLICK) return;
    moveTo(grip(event).toArray());
  });
  on('pointerup', (event) => {
    const still = pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < CLICK;
    const wasHeld = grip !== null;
    pressed = grip = null;
    if (wasHeld && moved) endMove();
    else if (still && event.button === 0 && gizmo.axis === null) pick(under(event));
  });
  on('pointercancel', () => {
    pressed = grip = moved = null;
    dress();
  });
  canvas.addEventListener(
    'wheel',
    (event) => {
      if (!store.state.editing || !event.shiftKey || picked === null) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      actions.grow(Math.sign(event.deltaY || event.deltaX) < 0 ? 1.03 : 1 / 1.03);
    },
    { capture: true, passive: false },
  );

  store.watch(['editing'], ({ editing }) => {
    group.visible = gizmo.enabled = editing;
    gizmo.getHelper().visible = editing;
    layers.contactLayer.group.visible = !editing;
    if (!editing) return gizmo.detach();
    skin.take(skin.mesh.positions);
    skin.computeNormals();
    skin.frame = -2; // none: the next frame is posed anew
    layers.skinLayer.position.needsUpdate = layers.skinLayer.normal.needsUpdate = true;
    dress();
  });
  store.watch(['spheres'], ({ spheres, editing }) => {
    layer.group.visible = spheres;
    if (editing && !spheres) pick(null);
  });
  store.watch(['radius', 'sphereOpacity', 'theme'], () => store.state.editing && dress());
  history.listeners.push(() => {
    if (picked !== null && !sphereOf(picked)) pick(null);
    else dress();
  });

  return {
    pick,
    get picked() {
      return picked;
    },
    get isDragging() {
      return grip !== null || gizmo.dragging;
    },
    draw(eye) {
      group.matrix.copy(toWorld());
      group.matrixWorldNeedsUpdate = true;
      layer.upload(eye);
    },
    overlay(project) {
      const { context, width, height } = fitCanvas(overlay);
      const names = new Names(context, width, height, css('--font'));
      const sphere = sphereOf(picked);
      if (!sphere) return;
      const at = project(...pointOf(regions[sphere.region], current(sphere)));
      names.add(actions.name(sphere), at.x, Math.max(at.y - 58, 10), { ink: '#111', paper: POINTED, bold: true });
    },
  };
}
