// A skeleton that is posed by hand: where its joints are, turning them, two-bone inverse kinematics, and the pose as a file.
// Everything is in the source's units and axes. A matrix is twelve numbers, three rows of four.
//
// A joint's own matrix says how it moves from the rest pose before what is above it moves, so `whole = parent's whole * own`:
// the skinning matrix. A joint that only turns keeps its place at rest. Saved poses hold the own matrices.
import { Matrix3, Matrix4, Quaternion, Vector3 } from 'three';

const ROUNDING = 3e-6; // of a palette's single floats, and of files' numbers, as a share of the height

const matrix = (of, at = 0) => new Matrix4().set(...of.subarray(at, at + 12), 0, 0, 0, 1);
function put(m, to, at) {
  const e = m.elements;
  for (let row = 0; row < 3; ++row) for (let column = 0; column < 4; ++column) to[at + 4 * row + column] = e[4 * column + row];
}
export const about = (turn, center) =>
  new Matrix4().makeTranslation(center).multiply(new Matrix4().makeRotationFromQuaternion(turn)).multiply(new Matrix4().makeTranslation(center.clone().negate()));
const turnBetween = (from, to) => new Quaternion().setFromUnitVectors(from.clone().normalize(), to.clone().normalize());
const across = (v, axis) => v.clone().addScaledVector(axis, -v.dot(axis));

// The rotation of a pure rotation matrix; null for any other matrix.
function turnOf(m) {
  const e = m.elements;
  const rows = [0, 1, 2].map((k) => new Vector3(e[k], e[k + 4], e[k + 8]));
  const off = Math.max(...rows.flatMap((row, i) => rows.map((other, j) => Math.abs(row.dot(other) - (i === j ? 1 : 0)))));
  return off > 10 * ROUNDING || m.determinant() < 0 ? null : new Quaternion().setFromRotationMatrix(m).normalize();
}

// Single floats of a palette, given as doubles, leave a little behind that is no movement: a joint that only turns does so exactly.
function cleaned(own, at, height) {
  const turn = turnOf(own);
  const shift = at.clone().applyMatrix4(own).sub(at);
  if (!turn || shift.length() >= ROUNDING * height) return own;
  return Math.hypot(turn.x, turn.y, turn.z) < ROUNDING ? new Matrix4() : about(turn, at);
}

export class Poser {
  constructor(rig) {
    this.rig = rig;
    this.at = rig.joints.map(({ at }) => new Vector3(...at)); // at rest
    this.own = new Float64Array(12 * rig.joints.length);
    this.whole = new Float64Array(12 * rig.joints.length);
    const depth = (j) => (rig.joints[j].parent < 0 ? 0 : 1 + depth(rig.joints[j].parent));
    this.order = rig.joints.map((_, j) => [depth(j), j]).sort((a, b) => a[0] - b[0]).map(([, j]) => j);
    const { origin, left, up, forward, height } = rig.axes;
    const [l, u, f] = [left, up, forward].map((axis) => new Vector3(...axis).multiplyScalar(height));
    this.toSource = new Matrix4().makeBasis(l, u, f).setPosition(...origin); // from the character's axes, in heights
    this.forward = new Vector3(...forward);
  }

  // Takes over a frame's palette, or part of a longer array of them.
  load(palette, from = 0) {
    const whole = Float64Array.from(palette.subarray(from, from + this.own.length));
    for (const j of this.order) {
      const { parent } = this.rig.joints[j];
      const own = parent < 0 ? matrix(whole, 12 * j) : this.wholeOf(parent).invert().multiply(matrix(whole, 12 * j));
      put(cleaned(own, this.at[j], this.rig.axes.height), this.own, 12 * j);
      this.compose(j);
    }
  }

  compose(j) {
    const { parent } = this.rig.joints[j];
    const own = matrix(this.own, 12 * j);
    put(parent < 0 ? own : this.wholeOf(parent).multiply(own), this.whole, 12 * j);
  }

  take(own) {
    this.own.set(own);
    for (const j of this.order) this.compose(j);
  }

  wholeOf(j) {
    return matrix(this.whole, 12 * j);
  }

  // Where a point at rest is that moves with a joint; without one, the joint itself.
  place(j, point = this.at[j]) {
    return point.clone().applyMatrix4(this.wholeOf(j));
  }

  // By how many degrees a joint is turned from rest.
  angle(j) {
    const turn = new Quaternion();
    matrix(this.own, 12 * j).decompose(new Vector3(), turn, new Vector3());
    return (2 * Math.atan2(Math.hypot(turn.x, turn.y, turn.z), Math.abs(turn.w)) * 180) / Math.PI;
  }

  // Moves a joint and all below it, in the space of the pose.
  apply(j, movement) {
    const { parent } = this.rig.joints[j];
    const whole = movement.multiply(this.wholeOf(j));
    const own = parent < 0 ? whole : this.wholeOf(parent).invert().multiply(whole);
    put(cleaned(own, this.at[j], this.rig.axes.height), this.own, 12 * j);
    for (const k of this.order) this.compose(k);
  }

  turn(j, by, center = this.place(j)) {
    this.apply(j, about(by, center));
  }

  tip({ end, tip }) {
    return this.place(end, new Vector3(...tip));
  }

  // The end of a limb goes to a point, or as near as its two bones reach. A foot stays as it is turned.
  drag(limb, target) {
    const { upper, middle, end, stands } = limb;
    const a = this.place(upper);
    const b = this.place(middle);
    const c = this.tip(limb);
    const u = a.clone().sub(b);
    const v = c.clone().sub(b);
    const [first, second] = [u.length(), v.length()];
    const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
    const distance = clamp(target.distanceTo(a), 1.001 * Math.abs(first - second), 0.9995 * (first + second));
    const angle = Math.acos(clamp((first ** 2 + second ** 2 - distance ** 2) / (2 * first * second), -1, 1));
    const axis = this.bendAxis(limb, u.normalize(), v.normalize());
    const bend = new Quaternion().setFromAxisAngle(axis, angle - Math.PI).multiply(turnBetween(v, u.negate())); // of the straight limb
    this.turn(middle, bend, b);
    const swing = turnBetween(this.tip(limb).sub(a), target.clone().sub(a));
    this.turn(upper, swing, a);
    if (stands) this.turnBack(limb, swing.multiply(bend));
  }

  // About which a limb bends, whose bones lead from its middle along `u` and `v`: as it is bent. The straighter it is, the more as
  // people bend theirs: knees forward, elbows backward.
  bendAxis({ upper, stands }, u, v) {
    const own = u.clone().cross(v);
    const straight = u.dot(v) > 0 ? 0 : Math.max(1 - own.length() / 0.35, 0);
    const body = new Matrix3().setFromMatrix4(matrix(this.whole, 12 * Math.max(this.rig.joints[upper].parent, 0)));
    const usual = this.forward.clone().applyMatrix3(body).multiplyScalar(stands ? -1 : 1).normalize();
    const axis = own.normalize().multiplyScalar(1 - straight).addScaledVector(u.clone().cross(usual), straight);
    return across(axis.length() > 0 ? axis : new Vector3(1, 0, 0), u).normalize();
  }

  // A hand or foot that the limb has turned is turned back.
  turnBack({ end, tip }, by) {
    if (this.at[end].distanceTo(new Vector3(...tip)) < ROUNDING * this.rig.axes.height) this.turn(end, by.invert());
  }

  // The limb turns about the line from its beginning to its end, so that its elbow or knee is as near to a point as can be.
  dragMiddle(limb, target) {
    const a = this.place(limb.upper);
    const bone = this.place(limb.middle).sub(a);
    const axis = this.tip(limb).sub(a).normalize();
    const from = across(bone, axis);
    const to = across(target.clone().sub(a), axis);
    if (from.length() < 0.05 * bone.length()) return this.turn(limb.upper, turnBetween(bone, target.clone().sub(a)), a);
    const by = new Quaternion().setFromAxisAngle(axis, Math.atan2(from.clone().cross(to).dot(axis), from.dot(to)));
    this.turn(limb.upper, by, a);
    this.turnBack(limb, by);
  }

  // Feet stay where they stand, as far as legs reach.
  dragHips(target) {
    const feet = this.rig.limbs.filter(({ stands }) => stands).map((limb) => [limb, this.tip(limb)]);
    this.apply(this.rig.hips, new Matrix4().makeTranslation(target.clone().sub(this.place(this.rig.hips))));
    for (const [limb, foot] of feet) this.drag(limb, foot);
  }

  head() {
    return this.place(this.rig.head, new Vector3(...this.rig.head_at));
  }

  dragHead(target) {
    const neck = this.place(this.rig.neck);
    this.turn(this.rig.neck, turnBetween(this.head().sub(neck), target.clone().sub(neck)), neck);
  }

  // The pose as docs/formats.md has it. `morphs` are the weights of the rig's morph targets.
  file(name, about, morphs) {
    const pose = {};
    const { axes, joints, is_own: isOwn } = this.rig;
    const rounded = (x, digits) => Number(x.toFixed(digits)) + 0; // no -0
    for (const [j, joint] of joints.entries()) {
      const own = matrix(this.own, 12 * j);
      const turn = turnOf(own);
      const shift = this.place(j).distanceTo(joint.parent < 0 ? this.at[j] : this.place(joint.parent, this.at[j]));
      if (turn && shift < ROUNDING * axes.height) {
        if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);
        const sine = Math.hypot(turn.x, turn.y, turn.z);
        const degrees = ((2 * Math.atan2(sine, turn.w)) / Math.PI) * 180;
        const vector = new Vector3(turn.x, turn.y, turn.z).multiplyScalar(sine > 0 ? degrees / sine : 0);
        const turned = [axes.left, axes.up, axes.forward].map((axis) => rounded(vector.dot(new Vector3(...axis)), 6));
        if (turned.some((x) => x !== 0)) pose[joint.name] = turned;
      } else {
        const numbers = new Float64Array(12);
        put(this.toSource.clone().invert().multiply(own).multiply(this.toSource), numbers, 0);
        pose[joint.name] = [...numbers].map((x) => rounded(x, 9));
      }
    }
    const weights = Object.fromEntries(this.rig.morphs.map((morph, i) => [morph, morphs[i] ?? 0]).filter(([, weight]) => weight !== 0));
    if (Object.keys(weights).length > 0) pose.morphs = weights;
    return { name, about, ...(isOwn ? { rig: 'own' } : {}), poses: [pose] };
  }
}
