import * as THREE from 'three';

// From where a contact is seen best: small pictures of the skin with the chosen contact's triangles from many directions, and
// in each how many of its pixels show the outside of those triangles.

const SIZE = 64;

// Directions to look from, evenly spread, few from below.
const DIRECTIONS = Array.from({ length: 36 }, (_, i) => {
  const y = 0.95 - (1.35 * (i + 0.5)) / 36;
  const turn = i * Math.PI * (3 - Math.sqrt(5));
  const across = Math.sqrt(1 - y * y);
  return new THREE.Vector3(across * Math.sin(turn), y, across * Math.cos(turn));
});

export function createViewFinder(renderer, skinLayer, contactLayer, fieldOfView) {
  const target = new THREE.WebGLRenderTarget(SIZE, SIZE);
  const pixels = new Uint8Array(4 * SIZE * SIZE);
  const camera = new THREE.PerspectiveCamera(fieldOfView, 1, 0.01, 100);
  const scene = new THREE.Scene();
  const character = new THREE.Group();
  character.matrixAutoUpdate = false;
  const skin = new THREE.Mesh(skinLayer.depth.geometry, skinLayer.depth.material);
  skin.frustumCulled = false;
  skin.renderOrder = 1;
  character.add(skin, contactLayer.probe);
  scene.add(character);
  const probe = contactLayer.probe.material.uniforms;

  // Pixels of the first and the second part.
  function seen(eye, center, near, far) {
    camera.near = near;
    camera.far = far;
    camera.position.copy(eye);
    camera.lookAt(center);
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
    renderer.readRenderTargetPixels(target, 0, 0, SIZE, SIZE, pixels);
    let [a, b] = [0, 0];
    for (let i = 0; i < pixels.length; i += 4) {
      if (pixels[i] > 127) ++a;
      else if (pixels[i + 1] > 127) ++b;
    }
    return a + b + (a > 0 && b > 0 ? 0.5 * Math.min(a, b) + 8 : 0);
  }

  // The direction from `center` to the eye, near to `back` and across the way out where others are no better; null where the contact is seen from
  // nowhere. `refuses(eye)` says where no eye may be.
  return function find(matrix, center, distance, back, refuses) {
    character.matrix.copy(matrix);
    probe.winding.value = skinLayer.skin.winding();
    const before = renderer.getRenderTarget();
    const colour = renderer.getClearColor(new THREE.Color());
    const alpha = renderer.getClearAlpha();
    renderer.setClearColor(0, 0);
    renderer.setRenderTarget(target);
    let best = null;
    let most = 0;
    const way = contactLayer.way?.clone().transformDirection(matrix);
    for (const direction of [back, ...DIRECTIONS]) {
      const eye = center.clone().addScaledVector(direction, distance);
      if (refuses(eye)) continue;
      const aside = way ? Math.sqrt(1 - Math.min(direction.dot(way) ** 2, 1)) : 1; // 0: the arrow is seen end-on
      const score = seen(eye, center, distance / 50, distance * 4) * (0.7 + 0.3 * direction.dot(back)) * (0.4 + 0.6 * aside);
      if (score > most) [best, most] = [direction.clone(), score];
    }
    renderer.setRenderTarget(before);
    renderer.setClearColor(colour, alpha);
    return best;
  };
}
