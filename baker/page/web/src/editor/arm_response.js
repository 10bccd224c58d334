// The runtime's response in the page: it keeps the arms of a pose that is made by hand out of the body.
import { Matrix4, Quaternion, Vector3 } from 'three';
import { about } from './poser.js';

const SECONDS = 1 / 30; // of a frame, whatever the time that it takes
const STEP = 0.2; // radians that a joint turns in a frame: a faster drag is several frames
const FRAMES = 8; // that the response is given to come to rest
const STILL = 0.005; // radians

const rotation = (joints, j) => new Quaternion().fromArray(joints, 10 * j + 3);

export class ArmResponse {
  constructor(runtime, body, poser) {
    const { bones } = body.model;
    this.poser = poser;
    this.binds = bones.map(({ inverseBind }) => new Matrix4().fromArray(inverseBind).invert()); // from a joint's space to the rest pose
    this.parents = bones.map((_, j) => poser.rig.joints[j]?.parent ?? -1);
    this.response = body.createResponse({ parents: this.parents });
    this.state = runtime.createResponseState();
    this.drag = null;
  }

  place(j) {
    const { poser, binds } = this;
    return j < poser.at.length ? poser.wholeOf(j).multiply(binds[j]) : binds[j].clone();
  }
  parentPlace(j) {
    return this.parents[j] < 0 ? new Matrix4() : this.place(this.parents[j]);
  }

  // The poser's joints as the runtime takes them.
  joints() {
    const out = new Float32Array(10 * this.parents.length);
    this.parents.forEach((_, j) => {
      const [at, turn, scale] = [new Vector3(), new Quaternion(), new Vector3()];
      this.parentPlace(j).invert().multiply(this.place(j)).decompose(at, turn, scale);
      out.set([...at, ...turn, ...scale], 10 * j);
    });
    return out;
  }

  // The largest angle between rotations of two lists of joints.
  angle(from, to) {
    return Math.max(...this.parents.map((_, j) => rotation(from, j).angleTo(rotation(to, j))));
  }

  // Joints between two lists, at a share of the way.
  mixed(from, to, share) {
    const out = from.map((x, i) => x + share * (to[i] - x));
    this.parents.forEach((_, j) => rotation(from, j).slerp(rotation(to, j), share).toArray(out, 10 * j + 3));
    return out;
  }

  // Turns the arms out of the body in the poser's pose, which a drag reached from the pose `drag.from`. Returns whether any
  // turned. Arms leave the body on the side where the drag took them in.
  correct(drag, morphWeights) {
    const { poser, parents, state } = this;
    const wanted = this.joints();
    if (!wanted.every(Number.isFinite)) return false; // a joint is scaled to nothing
    if (drag !== this.drag) {
      const own = poser.own.slice();
      poser.take(drag.from);
      Object.assign(this, { drag, last: this.joints() });
      poser.take(own);
      state.fill(0);
    }
    const steps = Math.max(Math.ceil(this.angle(this.last, wanted) / STEP), 1);
    let corrected = wanted;
    for (let step = 1; step < steps + FRAMES; ++step) {
      const before = corrected;
      corrected = this.mixed(this.last, wanted, Math.min(step / steps, 1));
      const { turned } = this.response.respond(state, corrected, { seconds: SECONDS, morphWeights });
      if (step >= steps && (turned === 0 || this.angle(before, corrected) < STILL)) break;
    }
    this.last = wanted;
    let isTurned = false;
    for (const j of poser.order) {
      const turn = rotation(corrected, j).multiply(rotation(wanted, j).invert());
      if (Math.hypot(turn.x, turn.y, turn.z) < 1e-6) continue;
      isTurned = true;
      const parent = this.parentPlace(j);
      const movement = about(turn, new Vector3().fromArray(wanted, 10 * j));
      poser.apply(j, parent.clone().multiply(movement).multiply(parent.invert()));
    }
    return isTurned;
  }
}
