import * as THREE from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

// The view of the character: renderer, camera, orbit controls. The world is the character's own frame with its height as the
// unit: x to its left, y up, z forward, the feet at y = 0.

const VIEWS = { front: [0, 0, 1], side: [1, 0, 0], back: [0, 0, -1], top: [0, 1, 0.0001] };
const FLIGHT_MS = 450;
const FIELD_OF_VIEW = 26;

function toWorldMatrix({ origin, left, up, forward, height }) {
  const axes = new THREE.Matrix4().set(...left, 0, ...up, 0, ...forward, 0, 0, 0, 0, 1);
  return axes.premultiply(new THREE.Matrix4().makeScale(1 / height, 1 / height, 1 / height)).multiply(
    new THREE.Matrix4().makeTranslation(-origin[0], -origin[1], -origin[2]),
  );
}

// All the motion fits: the rest mesh, and the spheres of every frame.
function boundsOf(model, toWorld) {
  const bounds = new THREE.Box3();
  const point = new THREE.Vector3();
  const { positions } = model.mesh;
  for (let v = 0; v < positions.length; v += 3) bounds.expandByPoint(point.fromArray(positions, v).applyMatrix4(toWorld));
  for (let frame = 0; frame < model.frameCount; ++frame) {
    for (let i = 0; i < model.spheres.length; ++i) {
      bounds.expandByPoint(point.fromArray(model.sphere(frame, i, 'fit')).applyMatrix4(toWorld));
    }
  }
  return bounds.isEmpty() ? bounds.set(new THREE.Vector3(-0.5, 0, -0.5), new THREE.Vector3(0.5, 1, 0.5)) : bounds;
}

function floor() {
  const geometry = new THREE.PlaneGeometry(3, 3).rotateX(-Math.PI / 2);
  const material = new THREE.ShaderMaterial({
    uniforms: { ink: { value: new THREE.Color() } },
    vertexShader: `
      varying vec2 at;
      void main() { at = position.xz; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `
      uniform vec3 ink;
      varying vec2 at;
      void main() {
        vec2 cell = abs(fract(at * 10.0 - 0.5) - 0.5) / fwidth(at * 10.0);
        float line = 1.0 - min(min(cell.x, cell.y), 1.0);
        float fade = smoothstep(0.75, 0.1, length(at));
        float shadow = 0.22 * smoothstep(0.3, 0.0, length(at * vec2(1.0, 1.5)));
        float grid = 0.25 * fade * line;
        gl_FragColor = vec4(ink * grid / max(grid + shadow, 0.001), grid + shadow);
        #include <colorspace_fragment>
      }`,
    transparent: true,
    depthWrite: false,
    side: THREE.DoubleSide,
  });
  return new THREE.Mesh(geometry, material);
}

// Null where the browser has no WebGL.
export function createStage(canvas, model, layers) {
  const context = canvas.getContext('webgl2', { antialias: true, alpha: true });
  if (context === null) return null;
  const renderer = new THREE.WebGLRenderer({ canvas, context, antialias: true, alpha: true });
  const camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 50);
  const controls = new OrbitControls(camera, canvas);
  controls.enableDamping = true;
  controls.dampingFactor = 0.15;
  controls.minDistance = 0.1;
  controls.maxDistance = 12;

  const scene = new THREE.Scene();
  const ground = floor();
  const character = new THREE.Group();
  const toWorld = toWorldMatrix(model.axes);
  character.matrixAutoUpdate = false;
  character.matrix.copy(toWorld);
  character.add(...layers.map((layer) => layer.group));
  scene.add(ground, character);
  const fromWorld = toWorld.clone().invert();
  const bounds = boundsOf(model, toWorld);

  let beforeDraw = () => {};
  let afterDraw = () => {};
  let flight = null;
  let framed = 'front'; // the preset that a change of size keeps
  let waiting = false;

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
    camera.updateMatrixWorld();
    beforeDraw(camera.position.clone().applyMatrix4(fromWorld));
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
    const matrix = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).multiply(toWorld);
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

  // The nearest eye in a direction that sees the whole box.
  function eyeFor(direction) {
    const target = bounds.getCenter(new THREE.Vector3());
    const back = direction.clone().normalize();
    const right = new THREE.Vector3(0, 1, 0).cross(back).normalize();
    const up = back.clone().cross(right);
    const vertical = Math.tan(THREE.MathUtils.degToRad(FIELD_OF_VIEW / 2)) * 0.92;
    const horizontal = vertical * camera.aspect;
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new THREE.Vector3(
        corner & 1 ? bounds.max.x : bounds.min.x,
        corner & 2 ? bounds.max.y : bounds.min.y,
        corner & 4 ? bounds.max.z : bounds.min.z,
      ).sub(target);
      const size = Math.max(Math.abs(p.dot(right)) / horizontal, Math.abs(p.dot(up)) / vertical);
      distance = Math.max(distance, p.dot(back) + size);
    }
    return { target, position: target.clone().addScaledVector(back, distance) };
  }

  function view(name, fly = true) {
    framed = name;
    const { target, position } = eyeFor(new THREE.Vector3(...VIEWS[name]));
    if (fly) return go(target, position);
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
    if (framed) view(framed, false);
    invalidate();
  }

  controls.addEventListener('start', () => {
    framed = null;
    flight = null;
  });
  controls.addEventListener('change', invalidate);
  new ResizeObserver(resize).observe(canvas);
  resize();

  return {
    invalidate,
    view,
    onDraw(before, after) {
      beforeDraw = before;
      afterDraw = after;
    },
    setInk: (colour) => ground.material.uniforms.ink.value.set(colour),
    pixelRatio: () => renderer.getPixelRatio(),

    // The ray through a pixel, in source units.
    ray(clientX, clientY) {
      const box = canvas.getBoundingClientRect();
      const at = new THREE.Vector2(
        ((clientX - box.left) / box.width) * 2 - 1,
        1 - ((clientY - box.top) / box.height) * 2,
      );
      const caster = new THREE.Raycaster();
      caster.setFromCamera(at, camera);
      return caster.ray.applyMatrix4(fromWorld);
    },

    // Looks at two spheres from where both are seen side by side, turning as little as that takes.
    flyTo(p, q) {
      framed = null;
      const a = new THREE.Vector3(...p).applyMatrix4(toWorld);
      const b = new THREE.Vector3(...q).applyMatrix4(toWorld);
      const axis = b.clone().sub(a).normalize();
      const target = a.clone().add(b).multiplyScalar(0.5);
      const back = camera.position.clone().sub(controls.target).normalize();
      const across = back.clone().addScaledVector(axis, -back.dot(axis));
      if (across.length() > 0.2) back.copy(across).normalize();
      const reach = (p[3] + q[3]) / model.height + a.distanceTo(b);
      const distance = Math.max((1.6 * reach) / Math.tan(THREE.MathUtils.degToRad(FIELD_OF_VIEW / 2)), 0.3);
      go(target, target.clone().addScaledVector(back, distance));
    },
  };
}
