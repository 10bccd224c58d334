// A person of prisms, and a clip in which its hands go into its body. An awkward one has all that exporters trip over:
// centimetres and +Z up below a root that makes metres of them, a bone stretched along its axes and another scaled.
import * as THREE from 'three';
import { glbBytes } from './glb.mjs';

const kBones = [  // name, parent, where it starts, where its prism ends, radius
  ['hips', null, [0, 0, 95], [0, 0, 108], 14],
  ['spine', 'hips', [0, 0, 109], [0, 0, 124], 13],
  ['chest', 'spine', [0, 0, 125], [0, 0, 146], 15],
  ['neck', 'chest', [0, 0, 147], [0, 0, 154], 5],
  ['head', 'neck', [0, 0, 155], [0, 0, 178], 9],
  ...[['left', 1], ['right', -1]].flatMap(([side, x]) => [
    [`${side}_upper_arm`, 'chest', [18 * x, 0, 142], [44 * x, 0, 142], 5],
    [`${side}_lower_arm`, `${side}_upper_arm`, [45 * x, 0, 142], [69 * x, 0, 142], 4],
    [`${side}_hand`, `${side}_lower_arm`, [70 * x, 0, 142], [86 * x, 0, 142], 3.5],
    [`${side}_upper_leg`, 'hips', [10 * x, 0, 92], [10 * x, 0, 52], 8],
    [`${side}_lower_leg`, `${side}_upper_leg`, [10 * x, 0, 51], [10 * x, 0, 11], 6],
    [`${side}_foot`, `${side}_lower_leg`, [10 * x, 3, 5], [10 * x, -20, 5], 4.5],
  ]),
];
const kAwkward = { left_lower_arm: [1, 1.3, 0.8], right_upper_leg: [2, 2, 2] };

// A closed prism of eight sides along a line, in three rings.
function prism(from, to, radius) {
  const a = new THREE.Vector3(...from), axis = new THREE.Vector3(...to).sub(a);
  const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis.clone().normalize());
  const points = [], corners = [], rings = 3, sides = 8;
  for (let r = 0; r < rings; ++r) {
    for (let k = 0; k < sides; ++k) {
      const angle = (2 * Math.PI * k) / sides;
      points.push(new THREE.Vector3(radius * Math.cos(angle), radius * Math.sin(angle), 0).applyQuaternion(turn)
        .addScaledVector(axis, r / (rings - 1)).add(a));
    }
  }
  points.push(a.clone(), a.clone().add(axis));
  for (let k = 0; k < sides; ++k) {
    const next = (k + 1) % sides, last = sides * (rings - 1);
    for (let r = 0; r + 1 < rings; ++r) {
      const [p, q, s, t] = [r * sides + k, r * sides + next, (r + 1) * sides + next, (r + 1) * sides + k];
      corners.push(p, q, s, p, s, t);
    }
    corners.push(rings * sides, next, k, rings * sides + 1, last + k, last + next);
  }
  return { points, corners };
}

export function person(isAwkward) {
  const scales = isAwkward ? kAwkward : {}, unit = isAwkward ? 1 : 0.01;
  const json = { asset: { version: '2.0', generator: 'a test' }, scene: 0, scenes: [{ nodes: [0] }], nodes: [], accessors: [], bufferViews: [], buffers: [] };
  const data = [];
  let size = 0;
  const accessor = (array, type, bounds) => {
    const width = { SCALAR: 1, VEC3: 3, VEC4: 4, MAT4: 16 }[type], bytes = Buffer.from(array.buffer);
    json.bufferViews.push({ buffer: 0, byteOffset: size, byteLength: bytes.length });
    data.push(bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4));
    size += bytes.length + ((4 - (bytes.length % 4)) % 4);
    const componentType = array instanceof Float32Array ? 5126 : array instanceof Uint16Array ? 5123 : 5121;
    const out = { bufferView: json.bufferViews.length - 1, componentType, count: array.length / width, type };
    if (bounds) {
      const column = (k) => [...array].filter((_, i) => i % width === k);
      out.min = Array.from({ length: width }, (_, k) => Math.min(...column(k)));
      out.max = Array.from({ length: width }, (_, k) => Math.max(...column(k)));
    }
    return json.accessors.push(out) - 1;
  };

  json.nodes.push({ name: 'armature', rotation: [-Math.SQRT1_2, 0, 0, Math.SQRT1_2], scale: [0.01 / unit, 0.01 / unit, 0.01 / unit], children: [] }, { name: 'body', mesh: 0, skin: 0 });
  json.nodes[0].children.push(1);
  const node = {}, inverse = [], positions = [], joints = [], corners = [];
  kBones.forEach(([name, parent, from, to, radius], b) => {
    const scale = scales[name] ?? [1, 1, 1];
    // A child of a scaled bone hangs on a node that undoes the scale.
    let above = parent ? node[parent] : 0;
    if (scales[parent]) {
      const undo = { name: `${parent} undone ${name}`, scale: scales[parent].map((s) => 1 / s), children: [] };
      (json.nodes[above].children ??= []).push(json.nodes.length);
      above = json.nodes.push(undo) - 1;
    }
    const start = parent ? kBones.find(([other]) => other === parent)[2] : [0, 0, 0];
    node[name] = json.nodes.push({ name, translation: from.map((x, i) => unit * (x - start[i])), scale }) - 1;
    (json.nodes[above].children ??= []).push(node[name]);
    const global = new THREE.Matrix4().compose(new THREE.Vector3(...from).multiplyScalar(unit), new THREE.Quaternion(), new THREE.Vector3(...scale));
    inverse.push(...global.invert().elements);
    const piece = prism(from.map((x) => unit * x), to.map((x) => unit * x), unit * radius), first = positions.length / 3;
    corners.push(...piece.corners.map((c) => first + c));
    for (const point of piece.points) {
      positions.push(...point);
      joints.push(b, 0, 0, 0);
    }
  });
  const weights = joints.map((_, i) => (i % 4 === 0 ? 1 : 0));
  json.meshes = [{ primitives: [{
    attributes: {
      POSITION: accessor(new Float32Array(positions), 'VEC3', true),
      JOINTS_0: accessor(new Uint8Array(joints), 'VEC4'),
      WEIGHTS_0: accessor(new Float32Array(weights), 'VEC4'),
    },
    indices: accessor(new Uint16Array(corners), 'SCALAR'),
  }] }];
  json.skins = [{ joints: kBones.map(([name]) => node[name]), inverseBindMatrices: accessor(new Float32Array(inverse), 'MAT4') }];

  const seconds = Array.from({ length: 41 }, (_, i) => i / 10), times = accessor(new Float32Array(seconds), 'SCALAR', true);
  const clip = { name: 'swing', channels: [], samplers: [] };
  const swing = (name, axis, degrees, phase) => {
    const values = seconds.flatMap((t) => new THREE.Quaternion()
      .setFromAxisAngle(new THREE.Vector3(...axis).normalize(), ((degrees * Math.PI) / 360) * (1 - Math.cos((t + phase) * Math.PI))).toArray());
    clip.samplers.push({ input: times, output: accessor(new Float32Array(values), 'VEC4') });
    clip.channels.push({ sampler: clip.samplers.length - 1, target: { node: node[name], path: 'rotation' } });
  };
  for (const [side, x] of [['left', 1], ['right', -1]]) {
    swing(`${side}_upper_arm`, [0, x, 0.3], 95, 0.3 * x);
    swing(`${side}_lower_arm`, [0, 0.3, -x], 130, 0.2);
    swing(`${side}_hand`, [1, 0, 0.5], 40, 0.5);
    swing(`${side}_upper_leg`, [x, 0.2 * x, 0], 50, 0.5 * x);
    swing(`${side}_lower_leg`, [1, 0, 0], 90, 0.1 * x);
  }
  swing('spine', [1, 0.3, 0.2], 35, 0.4);
  swing('head', [0.2, 1, 0.4], 30, 0.7);
  json.animations = [clip];
  json.buffers = [{ byteLength: size }];
  return glbBytes(json, Buffer.concat(data));
}
