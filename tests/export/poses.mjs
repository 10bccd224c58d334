// Our own results, and a loaded character in the same poses.
import { execFileSync } from 'node:child_process';
import * as THREE from 'three';

export const run = (tool, args) => execFileSync(tool, args, { encoding: 'utf8', maxBuffer: 1 << 30, stdio: ['ignore', 'pipe', 'pipe'] });

export const posedColliders = (program, asset, source, shape, count, poses) =>
  JSON.parse(run(program, [asset, source, shape, String(count), String(poses)]));

// Puts the scene into a pose of posed_colliders.
export class Animated {
  constructor(gltf) {
    this.gltf = gltf;
    this.mixer = new THREE.AnimationMixer(gltf.scene);
  }
  stand(pose) {
    const clip = this.gltf.animations.find((one) => one.name === pose.clip) ?? this.gltf.animations[0];
    if (clip) {
      if (clip !== this.clip) {
        this.mixer.stopAllAction();
        const action = this.mixer.clipAction(clip);
        action.setLoop(THREE.LoopOnce, 1);
        action.clampWhenFinished = true;
        action.play();
        this.clip = clip;
      }
      const action = this.mixer.clipAction(clip);
      action.paused = false;
      action.enabled = true;
      action.time = Math.min(pose.seconds, clip.duration);
      this.mixer.update(0);
    }
    this.gltf.scene.updateMatrixWorld(true);
  }
}

const rigid = ({ position, rotation }) =>
  new THREE.Matrix4().compose(new THREE.Vector3(...position), new THREE.Quaternion(...rotation), new THREE.Vector3(1, 1, 1));

// The points and radii that say where a volume of ours is, in the pose's space.
export function placed(volume, body) {
  const at = rigid(body), point = (p) => new THREE.Vector3(...p).applyMatrix4(at);
  if (volume.type === 'sphere') return { points: [point(volume.center)], radii: [volume.radius] };
  if (volume.type === 'box') {
    const turn = new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion(...volume.rotation));
    const corner = (x, y, z) => point(new THREE.Vector3(x * volume.half[0], y * volume.half[1], z * volume.half[2])
      .applyMatrix4(turn).add(new THREE.Vector3(...volume.center)));
    return { points: [corner(1, 1, 1), corner(-1, 1, 1), corner(1, -1, 1), corner(1, 1, -1)], radii: [0] };
  }
  const a = volume.radius ?? volume.radius_a, b = volume.radius ?? volume.radius_b;
  return { points: [point(volume.a), point(volume.b)], radii: [a, b] };
}

// Our poses stand in the axes of the bind pose, a file's scene elsewhere: one rigid map leads there, the same for all
// poses. It takes the first body's frame in the first pose to where the scene has that body.
export const map_from = (body, inScene) => inScene.clone().multiply(rigid(body).invert());

// The same from points: the frame of three that are far apart.
export function fit(from, to) {
  const farthest = (points, measure) => points.reduce((best, _, i) => (measure(points[i]) > measure(points[best]) ? i : best), 0);
  const b = farthest(from, (p) => p.distanceTo(from[0]));
  const axis = new THREE.Line3(from[0], from[b]);
  const c = farthest(from, (p) => axis.closestPointToPoint(p, false, new THREE.Vector3()).distanceTo(p));
  const frame = (points) => {
    const x = points[b].clone().sub(points[0]).normalize(), z = x.clone().cross(points[c].clone().sub(points[0])).normalize();
    return new THREE.Matrix4().makeBasis(x, z.clone().cross(x), z).setPosition(points[0]);
  };
  return frame(to).multiply(frame(from).invert());
}
