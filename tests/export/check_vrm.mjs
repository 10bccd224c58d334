// Spring bone colliders as three-vrm has them.
import fs from 'node:fs';
import { VRMSpringBoneLoaderPlugin } from '@pixiv/three-vrm';
import * as THREE from 'three';
import { glbBytes, loadGlb, readGlb, validate } from './glb.mjs';
import { Animated, fit, placed } from './poses.mjs';

const check = (holds, what) => {
  if (!holds) throw new Error(what);
};
const isOwn = (group) => (group.name ?? '').startsWith('spherechain ');

// The file's JSON without what the export wrote; equal to the source's where nothing else was touched.
function without(json, source) {
  const out = structuredClone(json), had = source.extensions ?? {};
  delete out.asset.extras.spherechain;
  if (!source.asset.extras) delete out.asset.extras;
  if (had.VRM) {
    const animation = out.extensions.VRM.secondaryAnimation, first = had.VRM.secondaryAnimation.colliderGroups?.length ?? 0;
    animation.colliderGroups = animation.colliderGroups.filter((group) => !isOwn(group));
    for (const spring of animation.boneGroups) spring.colliderGroups = spring.colliderGroups.filter((g) => g < first);
    return out;
  }
  if (!had.VRMC_springBone) {
    delete out.extensions.VRMC_springBone;
    out.extensionsUsed = out.extensionsUsed.filter((name) => name !== 'VRMC_springBone');
    if (out.extensionsUsed.length === 0) delete out.extensionsUsed;
    if (Object.keys(out.extensions).length === 0) delete out.extensions;
    return out;
  }
  const written = out.extensions.VRMC_springBone, before = had.VRMC_springBone;
  for (const list of ['colliders', 'colliderGroups']) {
    written[list] = written[list].slice(0, before[list]?.length ?? 0);
    if (!before[list]) delete written[list];
  }
  written.springs?.forEach((spring, i) => {
    spring.colliderGroups = spring.colliderGroups?.filter((g) => g < (before.colliderGroups?.length ?? 0));
    if (!before.springs[i].colliderGroups) delete spring.colliderGroups;
  });
  return out;
}

// Indices, sizes, and that nothing else of the source changed.
export function checkFile(file, sourceFile) {
  const written = readGlb(file), source = readGlb(sourceFile);
  check(written.rest.equals(source.rest), 'the binary chunk changed');
  check(JSON.stringify(without(written.json, source.json)) === JSON.stringify(source.json), 'the JSON changed elsewhere');
  const { nodes, extensions } = written.json, isNumber = (x) => typeof x === 'number' && Number.isFinite(x);
  const isNode = (n) => check(Number.isInteger(n) && n >= 0 && n < nodes.length, `collider on node ${n}`);
  if (extensions.VRM) {
    for (const group of extensions.VRM.secondaryAnimation.colliderGroups.filter(isOwn)) {
      isNode(group.node);
      for (const { offset, radius } of group.colliders) check([offset.x, offset.y, offset.z].every(isNumber) && radius > 0, 'a bad sphere');
    }
    return;
  }
  const { colliders, colliderGroups, specVersion, springs } = extensions.VRMC_springBone;
  check(specVersion === '1.0' && written.json.extensionsUsed.includes('VRMC_springBone'), 'not announced');
  for (const { node, shape } of colliders) {
    isNode(node);
    check(Object.keys(shape).length === 1, 'a collider of two shapes');
    const { offset, tail, radius } = shape.sphere ?? shape.capsule;
    check([...offset, ...(shape.capsule ? tail : [])].every(isNumber) && radius > 0, 'a bad shape');
  }
  for (const group of colliderGroups) check(group.colliders.length > 0 && group.colliders.every((c) => colliders[c]), 'a group of nothing');
  for (const { colliderGroups: g } of springs ?? []) check(g === undefined || (g.length > 0 && g.every((i) => colliderGroups[i])), 'a spring of no group');
}

// Our colliders in the scene, read from the JSON: three.js places the nodes.
function readColliders(file, gltf) {
  const { extensions } = readGlb(file).json, out = [];
  const add = (node, points, radius) => {
    const { matrixWorld } = gltf.nodes[node];
    out.push({ points: points.map((p) => p.applyMatrix4(matrixWorld)), radius: radius * Math.cbrt(Math.abs(matrixWorld.determinant())), node });
  };
  for (const group of extensions.VRM?.secondaryAnimation.colliderGroups.filter(isOwn) ?? []) {
    for (const { offset, radius } of group.colliders) add(group.node, [new THREE.Vector3(offset.x, offset.y, -offset.z)], radius);
  }
  const bones = extensions.VRMC_springBone;
  for (const group of extensions.VRM ? [] : bones.colliderGroups.filter(isOwn)) {
    for (const { node, shape } of group.colliders.map((c) => bones.colliders[c])) {
      const { offset, tail, radius } = shape.sphere ?? shape.capsule;
      add(node, (tail ? [offset, tail] : [offset]).map((p) => new THREE.Vector3(...p)), radius);
    }
  }
  return out;
}

// The same of three-vrm, whose radii are the scene's.
const loadedColliders = (manager) => manager.colliders.map((collider) => {
  collider.updateWorldMatrix(true, false);
  const { offset, tail, radius } = collider.shape;
  return { points: (tail ? [offset, tail] : [offset]).map((p) => p.clone().applyMatrix4(collider.matrixWorld)), radius };
});

const between = (a, b) => (a.points.length !== b.points.length ? Infinity
  : Math.max(Math.abs(a.radius - b.radius), ...a.points.map((p, i) => p.distanceTo(b.points[i]))));

// A source with a spring that gravity swings into one of our colliders: its root is outside the body, its tip beside it.
export function withSpring(file, out, colliders, gltf, isVrm0, height) {
  const { json, rest } = readGlb(file);
  const middle = colliders.reduce((sum, c) => sum.addScaledVector(c.points[0], 1 / colliders.length), new THREE.Vector3());
  const far = (c) => c.points[0].distanceTo(middle);
  const goal = colliders.reduce((a, b) => (far(b) > far(a) ? b : a));
  const away = goal.points[0].clone().sub(middle).normalize(), length = 0.3 * height;
  const side = new THREE.Vector3(away.y, away.z, away.x).cross(away).normalize();
  const root = goal.points[0].clone().addScaledVector(away, length);
  const toNode = gltf.nodes[goal.node].matrixWorld.clone().invert(), at = root.clone().applyMatrix4(toNode);
  const tip = root.clone().addScaledVector(side, length).applyMatrix4(toNode).sub(at);
  const first = json.nodes.length;
  json.nodes.push({ name: 'spring root', translation: at.toArray(), children: [first + 1] }, { name: 'spring tip', translation: tip.toArray() });
  (json.nodes[goal.node].children ??= []).push(first);
  const down = away.clone().negate(), feel = { hitRadius: 0.001 * height, gravityPower: 3 * height, dragForce: 0.5 };
  json.extensions ??= {};
  if (isVrm0) {
    const { x, y, z } = down;
    json.extensions.VRM ??= {};
    json.extensions.VRM.secondaryAnimation ??= {};
    (json.extensions.VRM.secondaryAnimation.colliderGroups ??= []);
    (json.extensions.VRM.secondaryAnimation.boneGroups ??= []).push({ bones: [first], colliderGroups: [], stiffiness: 0, gravityDir: { x, y, z }, ...feel });
  } else {
    const bones = (json.extensions.VRMC_springBone ??= { specVersion: '1.0' });
    (bones.springs ??= []).push({ joints: [{ node: first, stiffness: 0, gravityDir: down.toArray(), ...feel }, { node: first + 1 }] });
  }
  const name = isVrm0 ? 'VRM' : 'VRMC_springBone';
  if (!json.extensionsUsed?.includes(name)) (json.extensionsUsed ??= []).push(name);
  fs.writeFileSync(out, glbBytes(json, rest.subarray(8)));
  return root;
}

// Swings the springs until they rest, and returns how far the tip is from the nearest collider.
function swing({ manager }, colliders) {
  const joint = [...manager.joints].find(({ bone }) => /spring.root/.test(bone.name));
  for (let i = 0; i < 400; ++i) manager.update(1 / 60);
  joint.bone.updateWorldMatrix(true, true);
  const tip = joint.child.getWorldPosition(new THREE.Vector3());
  return Math.min(...colliders.map(({ points, radius }) => {
    const axis = new THREE.Line3(points[0], points.at(-1));
    return axis.closestPointToPoint(tip, true, new THREE.Vector3()).distanceTo(tip) - radius;
  }));
}

async function loadSprings(file, Plugin) {
  const gltf = await loadGlb(file, (parser) => new Plugin(parser));
  return { gltf, manager: gltf.userData.vrmSpringBoneManager ?? gltf.userData.vrm?.springBoneManager };
}

// `write(source, out)` exports. Throws where something else of the file changed, a second export changes the first, a
// collider is off by more than 1e-5 of the height, or a spring swings into one.
export async function checkVrm(source, folder, ours, write, isVrm0 = false, Plugin = VRMSpringBoneLoaderPlugin) {
  const plain = `${folder}/plain.vrm`, sprung = `${folder}/sprung.vrm`, file = `${folder}/export.vrm`, again = `${folder}/again.vrm`;
  write(source, plain);
  await validate(plain);
  checkFile(plain, source);
  const rest = await loadGlb(plain), colliders = readColliders(plain, rest);

  withSpring(source, sprung, colliders, rest, isVrm0, ours.height);
  write(sprung, file);
  await validate(file);
  checkFile(file, sprung);
  write(file, again);
  check(fs.readFileSync(again).equals(fs.readFileSync(file)), 'a second export changed the first');

  const loaded = await loadSprings(file, Plugin), bare = await loadSprings(sprung, Plugin);
  const animated = new Animated(loaded.gltf);
  const volumes = ours.bodies.flatMap((body, b) => body.volumes.map((volume) => ({ volume, b })));
  check(volumes.length === colliders.length, `${colliders.length} colliders of ${volumes.length} volumes`);
  let map, worst = 0, scaled = false;
  for (const pose of ours.poses) {
    animated.stand(pose);
    const read = readColliders(file, loaded.gltf), three = loadedColliders(loaded.manager);
    const here = volumes.map(({ volume, b }) => {
      const { points, radii } = placed(volume, pose.bodies[b]);
      return { points, radius: radii[0] };
    });
    map ??= fit(here.flatMap((c) => c.points), read.flatMap((c) => c.points));
    here.forEach((c, i) => {
      c.points.forEach((p) => p.applyMatrix4(map));
      worst = Math.max(worst, between(c, read[i]));
      const isScaled = Math.abs(loaded.gltf.nodes[read[i].node].matrixWorld.determinant() - 1) > 1e-3;
      scaled ||= isScaled;
      const nearest = Math.min(...three.map((t) => between(isScaled ? { ...c, radius: t.radius } : c, t)));
      worst = Math.max(worst, nearest);
    });
  }
  const off = worst / ours.height;
  check(off <= 1e-5, `colliders are off by ${off.toExponential(1)} of the height`);
  if (scaled) return `${colliders.length} colliders, off by ${off.toExponential(1)} of the height at most; bones have a scale, springs not tried`;
  const outside = swing(await loadSprings(file, Plugin), colliders), inside = swing(bare, colliders);
  check(inside < -0.02 * ours.height, `the spring does not reach the body without colliders (${inside})`);
  check(outside > -0.005 * ours.height, `the spring swings ${-outside} m into a collider`);
  return `${colliders.length} colliders, off by ${off.toExponential(1)} of the height at most; a spring rests ${(1000 * outside).toFixed(1)} mm outside, without them ${(-1000 * inside).toFixed(1)} mm inside`;
}
