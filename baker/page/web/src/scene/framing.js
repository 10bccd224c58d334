import * as THREE from 'three';

// Where the character is in the world: its own axes with its height as the unit, x to its left, y up, z forward, the feet at
// y = 0. A character that travels is held in place where `follow` says so.

export function toWorldMatrix({ origin, left, up, forward, height }) {
  const axes = new THREE.Matrix4().set(...left, 0, ...up, 0, ...forward, 0, 0, 0, 0, 1);
  return axes.premultiply(new THREE.Matrix4().makeScale(1 / height, 1 / height, 1 / height)).multiply(
    new THREE.Matrix4().makeTranslation(-origin[0], -origin[1], -origin[2]),
  );
}

// How far the character has gone from its place at rest, over the ground.
function travel(model, home, frame) {
  const { centers } = model.motion;
  if (3 * frame + 2 >= centers.length) return [0, 0];
  return [centers[3 * frame] - home.x, centers[3 * frame + 2] - home.z];
}

export function createFraming(model) {
  const toWorld = toWorldMatrix(model.axes);
  const point = new THREE.Vector3();
  const rest = new THREE.Box3();
  const home = new THREE.Vector3();
  const { positions } = model.mesh;
  for (let v = 0; v < positions.length; v += 3) {
    rest.expandByPoint(point.fromArray(positions, v).applyMatrix4(toWorld));
    home.addScaledVector(point, 3 / positions.length);
  }
  if (rest.isEmpty()) rest.set(new THREE.Vector3(-0.5, 0, -0.5), new THREE.Vector3(0.5, 1, 0.5));
  const { boxes } = model.motion;

  const offset = (frame, follow) => {
    const [x, z] = follow ? travel(model, home, frame) : [0, 0];
    return new THREE.Vector3(-x, 0, -z);
  };
  return {
    toWorld,
    offset,
    // The box around each of a clip's frames.
    boxes({ first, count }, { follow, editing }) {
      if (boxes.length === 0 || editing) return [rest];
      return Array.from({ length: count }, (_, i) => {
        const [low, high] = [0, 3].map((k) => new THREE.Vector3().fromArray(boxes, 6 * (first + i) + k));
        return new THREE.Box3(low, high).translate(offset(first + i, follow));
      });
    },
  };
}
