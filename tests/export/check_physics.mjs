// KHR_physics_rigid_bodies and OMI_physics_body as a reader of the specification has them: bodies rebuilt from the file
// alone, posed by three.js, their overlaps found by Jolt Physics.
import fs from 'node:fs';
import path from 'node:path';
import Ajv from 'ajv/dist/2020.js';
import initJolt from 'jolt-physics';
import * as THREE from 'three';
import { loadGlb, readGlb, validate } from './glb.mjs';
import { Animated, map_from, placed } from './poses.mjs';

const kWords = {
  khr: { shapes: 'KHR_implicit_shapes', bodies: 'KHR_physics_rigid_bodies', shapeOf: (c) => c.geometry.shape },
  omi: { shapes: 'OMI_physics_shape', bodies: 'OMI_physics_body', shapeOf: (c) => c.shape },
};
const check = (holds, what) => {
  if (!holds) throw new Error(what);
};

// Bodies as [{name, node, filter, shapes: [{node, shape}]}]. A collider belongs to the nearest node above with a motion.
function bodiesOf(json, words) {
  const shapes = json.extensions[words.shapes].shapes, filters = json.extensions[words.bodies].collisionFilters;
  const parent = new Map();
  json.nodes.forEach((node, n) => (node.children ?? []).forEach((child) => {
    check(!parent.has(child) && child < json.nodes.length, `node ${child} has two parents, or is none`);
    parent.set(child, n);
  }));
  const bodies = new Map();
  json.nodes.forEach((node, n) => {
    const collider = node.extensions?.[words.bodies]?.collider;
    if (!collider) return;
    let body = n;
    while (body !== undefined && !json.nodes[body].extensions?.[words.bodies]?.motion) body = parent.get(body);
    check(body !== undefined, `collider ${n} moves with no body`);
    const motion = json.nodes[body].extensions[words.bodies].motion;
    check(motion.isKinematic === true || motion.type === 'kinematic', `body ${body} is not kinematic`);
    const shape = shapes[words.shapeOf(collider)], filter = filters[collider.collisionFilter];
    check(shape && filter, `collider ${n} has no shape or no filter`);
    const { height, radiusBottom, radiusTop, radius, size } = shape[shape.type];
    check([height, radiusBottom, radiusTop, radius, ...(size ?? [])].every((x) => x === undefined || (x > 0 && x < 1e4)),
      `shape of ${n} has no size`);
    if (!bodies.has(body)) bodies.set(body, { name: json.nodes[body].name, node: body, filter, shapes: [] });
    bodies.get(body).shapes.push({ node: n, shape });
  });
  return [...bodies.values()];
}

const collides = (a, b) => {
  const lets = (one, other) => !(one.notCollideWithSystems ?? []).some((name) => other.collisionSystems.includes(name));
  return lets(a, b) && lets(b, a);
};

export function checkSchemas(file, format) {
  const folder = process.env.SPHERECHAIN_TEST_DATA && path.join(process.env.SPHERECHAIN_TEST_DATA, 'schemas');
  if (!folder || !fs.existsSync(folder)) return false;
  const ajv = new Ajv({ strict: false, allErrors: true });
  ajv.addSchema({ $id: 'glTFProperty.schema.json', type: 'object' });
  ajv.addSchema({ $id: 'glTFChildOfRootProperty.schema.json', type: 'object' });
  ajv.addSchema({ $id: 'glTFid.schema.json', type: 'integer', minimum: 0 });
  for (const name of fs.readdirSync(folder).filter((f) => f.endsWith('.schema.json'))) {
    const schema = JSON.parse(fs.readFileSync(path.join(folder, name)));
    ajv.addSchema(schema, schema.$id ?? name);
  }
  const holds = (id, value) => check(ajv.validate(id, value), `${file}: ${id}: ${ajv.errorsText()}`);
  const { json } = readGlb(file), words = kWords[format];
  holds(`glTF.${words.shapes}.schema.json`, json.extensions[words.shapes]);
  holds(`glTF.${words.bodies}.schema.json`, json.extensions[words.bodies]);
  for (const node of json.nodes) {
    if (node.extensions?.[words.bodies]) holds(`node.${words.bodies}.schema.json`, node.extensions[words.bodies]);
  }
  return true;
}

class JoltWorld {
  constructor(Jolt) {
    this.Jolt = Jolt;
    // A world that nobody steps: making one fills the tables of which shape meets which.
    const settings = new Jolt.JoltSettings(), pairs = new Jolt.ObjectLayerPairFilterTable(1);
    const layers = new Jolt.BroadPhaseLayerInterfaceTable(1, 1);
    layers.MapObjectToBroadPhaseLayer(0, new Jolt.BroadPhaseLayer(0));
    settings.mObjectLayerPairFilter = pairs;
    settings.mBroadPhaseLayerInterface = layers;
    settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(layers, 1, pairs, 1);
    this.world = new Jolt.JoltInterface(settings);
    this.settings = new Jolt.CollideShapeSettings();
    this.settings.mMaxSeparationDistance = 0;
    this.settings.mCollisionTolerance = 1e-6;
    this.settings.mPenetrationTolerance = 1e-6;
    this.one = new Jolt.Vec3(1, 1, 1);
    this.filter = new Jolt.ShapeFilter();
  }
  shape({ type, [type]: s }) {
    const { Jolt } = this;
    const made = () => {
      if (type === 'sphere') return new Jolt.SphereShape(s.radius);
      if (type === 'box') return new Jolt.BoxShape(new Jolt.Vec3(s.size[0] / 2, s.size[1] / 2, s.size[2] / 2), 0);
      if (s.radiusTop === s.radiusBottom) return new Jolt.CapsuleShape(s.height / 2, s.radiusTop);
      const tapered = new Jolt.TaperedCapsuleShapeSettings(s.height / 2, s.radiusTop, s.radiusBottom).Create();
      check(tapered.IsValid(), 'Jolt refuses a tapered capsule');
      return tapered.Get();
    };
    const shape = made();
    shape.AddRef();
    return shape;
  }
  // The shape where a scene has its node: Jolt wants the centre of mass.
  place(shape, matrix) {
    const { Jolt } = this, p = new THREE.Vector3(), q = new THREE.Quaternion(), s = new THREE.Vector3();
    matrix.decompose(p, q, s);
    const mass = shape.GetCenterOfMass();
    p.add(new THREE.Vector3(mass.GetX(), mass.GetY(), mass.GetZ()).applyQuaternion(q));
    return { at: new Jolt.RVec3(p.x, p.y, p.z), turn: new Jolt.Quat(q.x, q.y, q.z, q.w), shape };
  }
  overlap(a, b) {
    const { Jolt } = this;
    const fixed = new Jolt.TransformedShape();
    fixed.mShape = a.shape;
    fixed.mShapePositionCOM = a.at;
    fixed.mShapeRotation = a.turn;
    fixed.SetShapeScale(this.one);
    const collector = new Jolt.CollideShapeAnyHitCollisionCollector();
    const matrix = Jolt.RMat44.prototype.sRotationTranslation(b.turn, b.at);
    fixed.CollideShape(b.shape, this.one, matrix, this.settings, a.at, collector, this.filter);
    const hit = collector.HadHit();
    Jolt.destroy(collector);
    Jolt.destroy(fixed);
    return hit;
  }
}

let world;

// Where the file's shape stands in the scene, as `placed` has ours.
function placedInScene({ type, [type]: s }, matrix) {
  const point = (x, y, z) => new THREE.Vector3(x, y, z).applyMatrix4(matrix);
  if (type === 'sphere') return { points: [point(0, 0, 0)], radii: [s.radius] };
  if (type === 'box') {
    const [x, y, z] = s.size.map((size) => size / 2);
    return { points: [point(x, y, z), point(-x, y, z), point(x, -y, z), point(x, y, -z)], radii: [0] };
  }
  return { points: [point(0, -s.height / 2, 0), point(0, s.height / 2, 0)], radii: [s.radiusBottom, s.radiusTop] };
}

const reach = ({ points, radii }) => {
  const center = points.reduce((sum, p) => sum.add(p), new THREE.Vector3()).divideScalar(points.length);
  return { center, radius: Math.max(...points.map((p) => p.distanceTo(center))) * (points.length > 2 ? 2 : 1) + Math.max(...radii) };
};

// Compares each pose. Throws where a transform is off by more than 1e-5 of the height, or fewer than 99.9 % of the pairs
// agree.
export async function checkPhysics(file, format, ours) {
  await validate(file);
  const { json } = readGlb(file);
  check(!(json.extensionsRequired ?? []).some((name) => /physics|shape/.test(name)), 'an extension is required');
  const bodies = bodiesOf(json, kWords[format]);
  const gltf = await loadGlb(file), animated = new Animated(gltf);
  world ??= new JoltWorld(await initJolt());
  const jolt = world;
  const of = new Map(ours.bodies.map((body, i) => [`spherechain ${body.part}`, i]));
  for (const body of bodies) {
    body.ours = of.get(body.name);
    const volumes = ours.bodies[body.ours]?.volumes ?? [];
    check(volumes.length === body.shapes.length, `${body.name} has ${body.shapes.length} shapes, not ${volumes.length}`);
    body.volumes = volumes;
    for (const one of body.shapes) one.jolt = jolt.shape(one.shape);
  }
  check(bodies.length === ours.bodies.filter((body) => body.volumes.length > 0).length, 'a body is missing');
  bodies.sort((a, b) => a.ours - b.ours);

  let map, worst = 0, worstAt = '', agree = 0, all = 0, overlaps = 0, wrong = [];
  const scale = new THREE.Vector3();
  for (const [p, pose] of ours.poses.entries()) {
    animated.stand(pose);
    map ??= map_from(pose.bodies[bodies[0].ours], gltf.nodes[bodies[0].node].matrixWorld);
    for (const body of bodies) {
      body.placed = body.shapes.map(({ node, shape, jolt: solid }, k) => {
        const matrix = gltf.nodes[node].matrixWorld;
        const there = placedInScene(shape, matrix), here = placed(body.volumes[k], pose.bodies[body.ours]);
        matrix.decompose(new THREE.Vector3(), new THREE.Quaternion(), scale);
        const near = (distance) => {
          if (distance > worst) [worst, worstAt] = [distance, `${body.name} in pose ${p}`];
        };
        here.points.forEach((point, i) => near(point.applyMatrix4(map).distanceTo(there.points[i])));
        here.radii.forEach((radius, i) => ['x', 'y', 'z'].forEach((k) => near(Math.abs(there.radii[i] * scale[k] - radius))));
        return { ...jolt.place(solid, matrix), ...reach(there) };
      });
    }
    const theirs = new Set(), said = new Set(pose.overlaps.map(([a, b]) => `${a} ${b}`));
    for (let i = 0; i < bodies.length; ++i) {
      for (let j = i + 1; j < bodies.length; ++j) {
        const a = bodies[i], b = bodies[j];
        const hit = collides(a.filter, b.filter) && a.placed.some((one) => b.placed.some((other) =>
          one.center.distanceTo(other.center) <= one.radius + other.radius + 1e-6 && jolt.overlap(one, other)));
        ++all;
        if (hit) ++overlaps;
        if (hit === said.has(`${a.ours} ${b.ours}`)) ++agree;
        else wrong.push(`pose ${p}: ${a.name} and ${b.name}: ${hit ? 'Jolt' : 'we'} alone`);
        if (hit) theirs.add(`${a.ours} ${b.ours}`);
      }
    }
  }
  const off = worst / ours.height;
  const result = `${bodies.length} bodies, ${ours.poses.length} poses: ${agree} of ${all} pairs agree (${((100 * agree) / all).toFixed(3)} %), ` +
    `${overlaps} overlap; transforms off by ${off.toExponential(1)} of the height at most`;
  check(off <= 1e-5, `transforms of ${worstAt}: ${result}`);
  check(agree / all >= 0.999, `${result}: ${wrong.slice(0, 5).join('; ')}`);
  return { result, overlaps };
}
