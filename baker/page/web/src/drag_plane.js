import { Vector3 } from 'three';

// What is dragged stays in the plane through it that faces the eye. `at` is the point where the pointer event `hold` takes hold
// of it; the result says where it is as the pointer moves.
export function dragPlane(stage, at, hold) {
  const back = new Vector3(...stage.camera().back);
  const meet = ({ clientX, clientY }) => {
    const { origin, direction } = stage.ray(clientX, clientY);
    return origin.clone().addScaledVector(direction, at.clone().sub(origin).dot(back) / direction.dot(back));
  };
  const from = meet(hold);
  return (pointer) => at.clone().add(meet(pointer)).sub(from);
}
