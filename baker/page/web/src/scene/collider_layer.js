import * as THREE from 'three';
import { COLLIDER, CONTACT } from '../base/palette.js';

// Colliders as an engine would have them: each body part's volumes, moved rigidly with its bone. The volumes of parts
// that overlap are red.

const UP = new THREE.Vector3(0, 1, 0);

// A tapered capsule's outline from pole to pole, from the centre of its end `a` along the axis: two arcs and their tangent.
function coneOutline(length, a, b) {
  const lean = Math.asin(Math.max(-1, Math.min(1, (a - b) / length))); // of the tangent's normal
  const arc = (center, radius, from, to) =>
    Array.from({ length: 13 }, (_, i) => {
      const angle = from + ((to - from) * i) / 12;
      return new THREE.Vector2(Math.max(radius * Math.cos(angle), 0), center + radius * Math.sin(angle));
    });
  return [...arc(0, a, -Math.PI / 2, lean), ...arc(length, b, lean, Math.PI / 2)];
}

function shapeOf(volume) {
  const at = (geometry, center, rotation = [0, 0, 0, 1], scale = [1, 1, 1]) =>
    geometry.applyMatrix4(new THREE.Matrix4().compose(new THREE.Vector3(...center), new THREE.Quaternion(...rotation), new THREE.Vector3(...scale)));
  const ball = (radius) => new THREE.SphereGeometry(radius, 24, 16);
  if (volume.type === 'sphere') return at(ball(volume.radius), volume.center);
  if (volume.type === 'ellipsoid') return at(ball(1), volume.center, volume.rotation, volume.radii);
  if (volume.type === 'box') return at(new THREE.BoxGeometry(2, 2, 2), volume.center, volume.rotation, volume.half);
  const { a, b, radius } = volume;
  const { radius_a: radiusA = radius, radius_b: radiusB = radius } = volume;
  const axis = new THREE.Vector3(...b).sub(new THREE.Vector3(...a));
  const length = axis.length();
  if (length <= Math.abs(radiusA - radiusB)) return radiusA >= radiusB ? at(ball(radiusA), a) : at(ball(radiusB), b);
  const turn = new THREE.Quaternion().setFromUnitVectors(UP, axis.divideScalar(length));
  return at(new THREE.LatheGeometry(coneOutline(length, radiusA, radiusB), 24), a, turn.toArray());
}

export class ColliderLayer {
  constructor(colliders, motion) {
    this.colliders = colliders;
    this.motion = motion;
    this.group = new THREE.Group();
    this.bodies = colliders.map(({ volumes }) => {
      const material = new THREE.MeshLambertMaterial({ color: COLLIDER, transparent: true, opacity: 0.5, depthWrite: false, side: THREE.FrontSide });
      const body = new THREE.Group();
      body.matrixAutoUpdate = false;
      body.add(...volumes.map((volume) => Object.assign(new THREE.Mesh(shapeOf(volume), material), { renderOrder: 9, frustumCulled: false })));
      this.group.add(body);
      return { body, material };
    });
    const sun = new THREE.DirectionalLight(0xffffff, 2);
    sun.position.set(-0.4, 0.7, 1);
    this.group.add(sun, new THREE.AmbientLight(0xffffff, 1.6));
  }

  // `overlapping`: the bodies that overlap another in that frame.
  pose(frame, overlapping, opacity) {
    const { bones, boneCount } = this.motion;
    this.bodies.forEach(({ body, material }, i) => {
      const { bone } = this.colliders[i];
      const at = 12 * (frame * boneCount + bone);
      if (bone >= 0 && bone < boneCount) body.matrix.set(...bones.subarray(at, at + 12), 0, 0, 0, 1);
      body.matrixWorldNeedsUpdate = true;
      material.color.set(overlapping.has(i) ? CONTACT : COLLIDER);
      material.opacity = opacity;
    });
  }
}
