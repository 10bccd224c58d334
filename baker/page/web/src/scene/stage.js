import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { createViewFinder } from './best_view.js';
import { createFloor } from './floor.js';
import { createFraming } from './framing.js';
import { createHeading } from './heading.js';

// The view of the character: renderer, camera, orbit controls.

// Directions from the character, as it stands at rest.
const VIEWS = { front: [0, 0.06, 1], side: [1, 0.06, 0], back: [0, 0.06, -1], top: [0, 1, 0.0001] };
const FLIGHT_MS = 450;
const FIELD_OF_VIEW = 26;
const TAN = Math.tan(THREE.MathUtils.degToRad(FIELD_OF_VIEW / 2));

// Null where the browser has no WebGL.
export function createStage(canvas, model, store, { skinLayer, ghostLayer, sphereLayer, contactLayer, colliderLayer }) {
  const context = canvas.getContext('webgl2', { antialias: true, alpha: true });
  if (context === null) return null;
  const renderer = new THREE.WebGLRenderer({ canvas, context, antialias: true, alpha: true });
  const framing = createFraming(model);
  const clipNow = () => model.clips[model.clipAt(store.state.frame)];
  let boxes = [];
  const bounds = new THREE.Box3();
  const measure = () => {
    boxes = framing.boxes(clipNow(), store.state);
    bounds.makeEmpty();
    for (const box of boxes) bounds.union(box);
  };
  measure();
  const unit = Math.max(...bounds.getSize(new THREE.Vector3()).toArray());

  const camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01 * unit, 60 * unit);
  const controls = new OrbitControls(camera, canvas);
  controls.enableDamping = true;
  controls.dampingFactor = 0.15;
  controls.minDistance = 0.1 * unit;
  controls.maxDistance = 20 * unit;

  const scene = new THREE.Scene();
  const floor = createFloor(unit);
  const character = new THREE.Group();
  character.matrixAutoUpdate = false;
  character.add(sphereLayer.group, skinLayer.group, contactLayer.group);
  if (colliderLayer) character.add(colliderLayer.group);
  if (ghostLayer) character.add(ghostLayer.group);
  scene.add(floor.mesh, character);
  const findView = createViewFinder(renderer, skinLayer, contactLayer, FIELD_OF_VIEW);

  let beforeDraw = () => {};
  let afterDraw = () => {};
  let flight = null;
  let framed = 'front'; // the view that a change of size or clip keeps
  let heading = 0; // of the character when that view was asked for
  let waiting = false;

  function place() {
    const { frame, follow, editing } = store.state;
    const offset = framing.offset(frame, follow && !editing);
    character.matrix.makeTranslation(offset).multiply(framing.toWorld);
    floor.uniforms.slide.value.set(-offset.x, -offset.z);
  }
  // Half of the way between before and after a change, where they stand beside each other.
  const halfApart = () => (model.change && store.state.showing === 'beside' ? model.change.distance / model.height / 2 : 0);
  const rightOf = (back) => new THREE.Vector3(0, 1, 0).cross(back).normalize();
  // They stay beside each other, whichever way the camera looks.
  function standBeside() {
    if (halfApart() === 0) return;
    const right = rightOf(camera.position.clone().sub(controls.target));
    const aside = Math.atan2(right.z, right.x);
    if (Math.abs(aside - store.state.aside) > 1e-3) store.set({ aside });
  }

  const toWorld = () => (place(), character.matrix);
  const fromWorld = () => toWorld().clone().invert();

  function draw(now) {
    waiting = false;
    if (flight) {
      const t = Math.min((now - flight.start) / FLIGHT_MS, 1);
      const ease = t * t * (3 - 2 * t);
      controls.target.lerpVectors(flight.fromTarget, flight.toTarget, ease);
      camera.position.lerpVectors(flight.fromPosition, flight.toPosition, ease);
      if (t === 1) flight = null;
    }
    if (controls.update() || flight) invalidate();
    standBeside();
    place();
    camera.updateMatrixWorld();
    beforeDraw(camera.position.clone().applyMatrix4(fromWorld()));
    renderer.render(scene, camera);
    afterDraw(project());
  }

  function invalidate() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(draw);
  }

  // Source units -> CSS pixels of the canvas, with the depth for sorting.
  function project() {
    const matrix = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).multiply(toWorld());
    const p = new THREE.Vector3();
    return (x, y, z) => {
      p.set(x, y, z).applyMatrix4(matrix);
      return { x: ((p.x + 1) / 2) * canvas.clientWidth, y: ((1 - p.y) / 2) * canvas.clientHeight, depth: p.z };
    };
  }

  function go(toTarget, toPosition) {
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) {
      controls.target.copy(toTarget);
      camera.position.copy(toPosition);
    } else {
      flight = {
        start: performance.now(),
        fromTarget: controls.target.clone(),
        fromPosition: camera.position.clone(),
        toTarget,
        toPosition,
      };
    }
    invalidate();
  }

  // The nearest eye in a direction that sees every frame's box, from outside them.
  function eyeFor(direction) {
    const target = bounds.getCenter(new THREE.Vector3());
    const back = direction.clone().normalize();
    const right = rightOf(back);
    const up = back.clone().cross(right);
    const vertical = TAN * 0.92;
    const horizontal = vertical * camera.aspect;
    let distance = 0;
    const p = new THREE.Vector3();
    for (const { min, max } of boxes) {
      for (let corner = 0; corner < 8; ++corner) {
        p.set(corner & 1 ? max.x : min.x, corner & 2 ? max.y : min.y, corner & 4 ? max.z : min.z).sub(target);
        const size = Math.max((Math.abs(p.dot(right)) + halfApart()) / horizontal, Math.abs(p.dot(up)) / vertical);
        distance = Math.max(distance, p.dot(back) + size);
      }
    }
    controls.maxDistance = Math.max(controls.maxDistance, 4 * distance);
    camera.far = Math.max(camera.far, 12 * distance);
    camera.updateProjectionMatrix();
    return { target, position: target.clone().addScaledVector(back, distance) };
  }

  const eyeOfView = () => eyeFor(new THREE.Vector3(...VIEWS[framed]).applyAxisAngle(new THREE.Vector3(0, 1, 0), heading));

  // From the character's own front, side or back, whichever way it has turned.
  function aim(name) {
    const { frame, editing } = store.state;
    framed = name;
    if (!editing) skinLayer.pose(frame);
    heading = editing ? 0 : headingNow();
    return eyeOfView();
  }

  function view(name) {
    const { target, position } = aim(name);
    go(target, position);
  }

  // At once.
  function show({ target, position }) {
    flight = null;
    controls.target.copy(target);
    camera.position.copy(position);
    invalidate();
  }

  function resize() {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (width === 0 || height === 0) return;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    renderer.setSize(width, height, false);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (framed) show(eyeOfView());
    invalidate();
  }

  // Whether a point of the world is in a sphere of the frame shown.
  function inSphere(eye) {
    const { frame } = store.state;
    const p = eye.clone().applyMatrix4(fromWorld());
    return model.spheres.some((_, i) => {
      const [x, y, z, r] = model.sphere(frame, i, 'detect');
      return Math.hypot(p.x - x, p.y - y, p.z - z) < 1.1 * r;
    });
  }

  // An eye in a direction that is outside all that moves, so in nothing.
  function outside(center, back, distance) {
    const ball = bounds.getBoundingSphere(new THREE.Sphere());
    return center.clone().addScaledVector(back, Math.max(distance, ball.radius * 1.1 + center.distanceTo(ball.center)));
  }

  controls.addEventListener('start', () => {
    framed = null;
    flight = null;
  });
  controls.addEventListener('change', invalidate);
  new ResizeObserver(resize).observe(canvas);
  const headingNow = createHeading(model, skinLayer.skin);
  aim('front');
  resize();
  let boundsKey = '';
  let standing = '';
  store.watch(['frame', 'follow', 'showing', 'editing'], ({ frame, follow, editing }) => {
    const key = `${model.clipAt(frame)} ${follow} ${halfApart()} ${editing}`;
    if (key === boundsKey) return;
    const isElsewhere = boundsKey !== '' && boundsKey.endsWith('true') !== editing; // the rest pose may stand where no frame does
    boundsKey = key;
    measure();
    const isNew = standing !== (standing = `${model.clipAt(frame)} ${editing}`);
    if (framed) show(isNew ? aim(framed) : eyeOfView());
    else if (isElsewhere) show(eyeFor(camera.position.clone().sub(controls.target)));
  });

  return {
    invalidate,
    view,
    inner: { scene, camera, controls, toWorld }, // of those that put things of their own into the picture
    onDraw(before, after) {
      beforeDraw = before;
      afterDraw = after;
    },
    setInk: (colour) => floor.uniforms.ink.value.set(colour),
    pixelRatio: () => renderer.getPixelRatio(),

    // The camera's target, in source units, and the direction from there to the eye.
    camera() {
      const back = camera.position.clone().sub(controls.target).transformDirection(fromWorld());
      return { target: controls.target.clone().applyMatrix4(fromWorld()).toArray(), back: back.toArray() };
    },

    // The ray through a pixel, in source units.
    ray(clientX, clientY) {
      const box = canvas.getBoundingClientRect();
      const at = new THREE.Vector2(
        ((clientX - box.left) / box.width) * 2 - 1,
        1 - ((clientY - box.top) / box.height) * 2,
      );
      const caster = new THREE.Raycaster();
      caster.setFromCamera(at, camera);
      return caster.ray.applyMatrix4(fromWorld());
    },

    // Looks at a ball of source units from where the outside of the chosen contact's triangles is seen best, or as `known` says.
    // `side`: it is left (-1) or right (1) of where before and after a change meet. `room`: how many times as far it looks from.
    flyToContact(ball, known, side = 0, room = 1) {
      framed = null;
      const center = new THREE.Vector3(...(known?.target ?? ball)).applyMatrix4(toWorld());
      const near = Math.max((1.5 * ball[3]) / model.height / TAN, (known ? 0.74 : 0.62) * unit);
      const distance = room * near;
      const back = camera.position.clone().sub(controls.target).normalize();
      const best = known ? new THREE.Vector3(...known.back).transformDirection(toWorld()) : findView(toWorld(), center, near, back, inSphere);
      if (best) center.addScaledVector(rightOf(back), -side * halfApart()).addScaledVector(rightOf(best), side * halfApart());
      go(center, best ? center.clone().addScaledVector(best, distance) : outside(center, back, distance));
    },

    // Looks at two spheres from where both are seen side by side, turning as little as that takes.
    flyToSpheres(p, q) {
      framed = null;
      const a = new THREE.Vector3(...p).applyMatrix4(toWorld());
      const b = new THREE.Vector3(...q).applyMatrix4(toWorld());
      const axis = b.clone().sub(a).normalize();
      const target = a.clone().add(b).multiplyScalar(0.5);
      const back = camera.position.clone().sub(controls.target).normalize();
      const across = back.clone().addScaledVector(axis, -back.dot(axis));
      if (across.length() > 0.2) back.copy(across).normalize();
      const reach = (p[3] + q[3]) / model.height + a.distanceTo(b);
      const distance = Math.max((1.6 * reach) / TAN, 0.5 * unit);
      const eye = target.clone().addScaledVector(back, distance);
      go(target, inSphere(eye) ? outside(target, back, distance) : eye);
    },
  };
}
