import { Vector3 } from 'three';

// Drags a point in the plane through it that faces the eye. `at` is the point that the pointer event `hold` grabs. The result
// maps a pointer position to the point's new place.
export function dragPlane(stage, at, hold) {
  const back = new Vector3(...stage.camera().back);
  const meet = ({ clientX, clientY }) => {
    const { origin, direction } = stage.ray(clientX, clientY);
    return origin.clone().addScaledVector(direction, at.clone().sub(origin).dot(back) / direction.dot(back));
  };
  const from = meet(hold);
  return (pointer) => at.clone().add(meet(pointer)).sub(from);
}
