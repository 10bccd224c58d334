// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that were rebuilt from an engine's file, against ours: the same volumes, and in every pose the same pairs of
// parts that overlap, by Jolt Physics. A body is { part, volumes, rest? }, volumes are those of capsules.json.
import initJolt from 'jolt-physics';
import { Quaternion, Vector3 } from 'three';

const vector = (v) => new Vector3(...v);
const quaternion = (q) => new Quaternion(...q).normalize();

// The farthest point of a volume along a direction of length 1.
function support(volume, direction) {
  const ball = (center, radius) => vector(center).addScaledVector(direction, radius);
  if (volume.type === 'sphere') return ball(volume.center, volume.radius);
  if (volume.a) {
    const [a, b] = [ball(volume.a, volume.radius_a ?? volume.radius), ball(volume.b, volume.radius_b ?? volume.radius)];
    return a.dot(direction) >= b.dot(direction) ? a : b;
  }
  const turn = quaternion(volume.rotation);
  const local = direction.clone().applyQuaternion(turn.clone().invert());
  const point = volume.half
    ? vector(volume.half.map((h, i) => (local.getComponent(i) < 0 ? -h : h)))
    : vector(volume.radii).multiply(local).normalize().multiply(vector(volume.radii));
  return point.applyQuaternion(turn).add(vector(volume.center));
}

const directions = Array.from({ length: 60 }, (_, i) => {
  const z = 1 - (2 * i + 1) / 60, around = i * Math.PI * (3 - Math.sqrt(5)), r = Math.sqrt(1 - z * z);
  return new Vector3(r * Math.cos(around), r * Math.sin(around), z);
});

// How far apart the surfaces of two volumes are.
const distance = (a, b) => Math.max(...directions.map((d) => Math.abs(d.dot(support(a, d).sub(support(b, d))))));

const Jolt = await initJolt();
{
  // A world that nobody steps: making one fills the tables of which shape meets which.
  const world = new Jolt.JoltSettings(), pairs = new Jolt.ObjectLayerPairFilterTable(1);
  const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
  layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
  world.mObjectLayerPairFilter = pairs;
  world.mBroadPhaseLayerInterface = layers;
  world.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1);
  new Jolt.JoltInterface(world);
}

// A volume as Jolt's, at `scale`, and where it is in its body.
function joltShape(volume, scale) {
  const part = { turn: new Quaternion(), center: new Vector3() };
  if (volume.type === 'sphere') {
    part.shape = new Jolt.SphereShape(scale * volume.radius);
    part.center.copy(vector(volume.center));
    part.bound = volume.radius;
  } else if (volume.a) {
    const [a, b] = [vector(volume.a), vector(volume.b)], along = b.clone().sub(a), half = along.length() / 2;
    const [bottom, top] = [volume.radius_a ?? volume.radius, volume.radius_b ?? volume.radius];
    part.shape = bottom === top
      ? new Jolt.CapsuleShape(scale * half, scale * top)
      : new Jolt.TaperedCapsuleShapeSettings(scale * half, scale * top, scale * bottom).Create().Get();
    part.center.copy(a).add(b).multiplyScalar(0.5);
    if (half > 0) part.turn.setFromUnitVectors(new Vector3(0, 1, 0), along.normalize());
    part.bound = half + Math.max(bottom, top);
  } else if (volume.half) {
    part.shape = new Jolt.BoxShape(new Jolt.Vec3(...volume.half.map((h) => scale * h)), 0);
    part.center.copy(vector(volume.center));
    part.turn = quaternion(volume.rotation);
    part.bound = vector(volume.half).length();
  } else {
    return null;  // Jolt has no ellipsoids
  }
  part.shape.AddRef();
  const mass = part.shape.GetCenterOfMass();
  part.mass = new Vector3(mass.GetX(), mass.GetY(), mass.GetZ());
  return part;
}

const one = new Jolt.Vec3(1, 1, 1), origin = new Jolt.RVec3(0, 0, 0), filter = new Jolt.ShapeFilter();
const settings = new Jolt.CollideShapeSettings();
settings.mCollisionTolerance = 1e-6;
settings.mPenetrationTolerance = 1e-6;
const collector = new Jolt.CollideShapeAnyHitCollisionCollector();
const transformed = new Jolt.TransformedShape();

function overlap(a, b) {
  transformed.mShape = a.shape;
  transformed.mShapePositionCOM = a.position;
  transformed.mShapeRotation = a.rotation;
  collector.Reset();
  collector.ResetEarlyOutFraction();
  const matrix = Jolt.RMat44.prototype.sRotationTranslation(b.rotation, b.position);  // good until the next call
  transformed.CollideShape(b.shape, one, matrix, settings, origin, collector, filter);
  return collector.HadHit();
}

// Places a body's parts in a pose.
function place(parts, { position, rotation }, scale) {
  const turn = quaternion(rotation);
  return parts.map((part) => {
    const center = part.center.clone().applyQuaternion(turn).add(vector(position));
    const q = turn.clone().multiply(part.turn).normalize();
    const mass = part.mass.clone().applyQuaternion(q).addScaledVector(center, scale);
    const at = new Jolt.RVec3(mass.x, mass.y, mass.z), spin = new Jolt.Quat(q.x, q.y, q.z, q.w);
    return { shape: part.shape, center, bound: part.bound, position: at, rotation: spin };
  });
}

// Throws with the first difference. `ignored`: pairs of names of parts. Returns figures for a person.
export function compareOverlaps(name, bodies, ignored, ours, file) {
  const byPart = new Map(bodies.map((body) => [body.part, body]));
  const same = 1e-5 * ours.height;
  let worst = 0;
  for (const body of ours.bodies.filter(({ volumes }) => volumes.length > 0)) {
    const theirs = byPart.get(body.part);
    if (!theirs) throw new Error(`${name}: no body ${body.part}`);
    if (theirs.volumes.length !== body.volumes.length) {
      throw new Error(`${name}: ${body.part} has ${theirs.volumes.length} volumes instead of ${body.volumes.length}`);
    }
    const left = [...theirs.volumes];
    for (const volume of body.volumes) {
      const gaps = left.map((other) => distance(volume, other)), least = Math.min(...gaps);
      if (!(least <= same)) throw new Error(`${name}: ${body.part}: no volume like ${JSON.stringify(volume)} (${least} m off)`);
      left.splice(gaps.indexOf(least), 1);
      worst = Math.max(worst, least);
    }
    if (theirs.rest) {
      const rest = file.bodies.find(({ part }) => part === body.part);
      const off = vector(theirs.rest.position).distanceTo(vector(rest.position));
      const turned = quaternion(theirs.rest.rotation).angleTo(quaternion(rest.rotation));
      if (!(off <= same && turned <= 1e-5)) throw new Error(`${name}: ${body.part} rests elsewhere: ${off} m, ${turned} rad`);
    }
  }
  const key = (a, b) => [a, b].sort().join('\n');
  const skipped = new Set(ignored.map(([a, b]) => key(a, b)));
  const wanted = new Set(file.ignored.map(({ parts }) => key(...parts)));
  for (const pair of wanted) if (!skipped.has(pair)) throw new Error(`${name}: ${pair.replace('\n', ' and ')} are not ignored`);
  if (skipped.size !== wanted.size) throw new Error(`${name}: ${skipped.size} pairs ignored instead of ${wanted.size}`);

  const scale = 1.7 / ours.height;  // Jolt's tolerances are for people
  const parts = ours.bodies.map(({ part }) => (byPart.get(part)?.volumes ?? []).map((volume) => joltShape(volume, scale)));
  if (parts.flat().includes(null)) return `${name}: volumes within ${worst.toExponential(1)} m; ellipsoids, no verdict by Jolt`;
  let agreed = 0, count = 0, touching = 0;
  for (const pose of ours.poses) {
    const placed = parts.map((list, i) => place(list, pose.bodies[i], scale));
    const overlapping = new Set(pose.overlaps.map(([a, b]) => `${a} ${b}`));
    for (let a = 0; a < parts.length; ++a) {
      for (let b = a + 1; b < parts.length; ++b) {
        if (skipped.has(key(ours.bodies[a].part, ours.bodies[b].part))) continue;
        const hit = placed[a].some((p) => placed[b].some((q) => p.center.distanceTo(q.center) <= p.bound + q.bound && overlap(p, q)));
        const expected = overlapping.has(`${a} ${b}`);
        touching += expected ? 1 : 0;
        agreed += hit === expected ? 1 : 0;
        ++count;
      }
    }
    for (const { position, rotation } of placed.flat()) [position, rotation].forEach(Jolt.destroy);
  }
  const share = agreed / count;
  const line = `${name}: Jolt agrees in ${agreed} of ${count} (pose, pair), ${(100 * share).toFixed(3)} %; ` +
    `${touching} overlap; volumes within ${worst.toExponential(1)} m`;
  if (!(share >= 0.999)) throw new Error(line);
  return line;
}
