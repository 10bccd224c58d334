#!/usr/bin/env node
// Cuts each triangle of a rigged GLB in four, at the middles of its edges, some times over: the same shape and motion
// with more triangles, to see how a bake's time grows.
//   tests/bench/subdivide.mjs IN.glb OUT.glb TIMES
import { readFileSync, writeFileSync } from "node:fs";

const [input, output, times] = process.argv.slice(2);
if (!times) {
  console.error("usage: subdivide.mjs IN.glb OUT.glb TIMES");
  process.exit(2);
}
const file = readFileSync(input);
const jsonLength = file.readUInt32LE(12);
const gltf = JSON.parse(file.toString("utf8", 20, 20 + jsonLength));
const chunks = [file.subarray(28 + jsonLength)];

const kWidth = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };
const kReader = { 5121: [1, "readUInt8"], 5123: [2, "readUInt16LE"], 5125: [4, "readUInt32LE"], 5126: [4, "readFloatLE"] };

function read(index) {
  const accessor = gltf.accessors[index], view = gltf.bufferViews[accessor.bufferView];
  const [size, method] = kReader[accessor.componentType], width = kWidth[accessor.type];
  const stride = view.byteStride ?? size * width, start = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  return Array.from({ length: accessor.count }, (_, i) =>
    Array.from({ length: width }, (_, k) => chunks[0][method](start + i * stride + k * size)));
}

function write(values, array, type, componentType) {
  const flat = array.from(values.flat());
  const bytes = Buffer.from(flat.buffer);
  const byteOffset = chunks.reduce((sum, chunk) => sum + chunk.length, 0);
  gltf.bufferViews.push({ buffer: 0, byteOffset, byteLength: bytes.length });
  chunks.push(bytes, Buffer.alloc(-bytes.length & 3));
  const accessor = { bufferView: gltf.bufferViews.length - 1, componentType, count: values.length, type };
  if (type === "VEC3") {
    for (const [name, pick] of [["min", Math.min], ["max", Math.max]]) {
      accessor[name] = [0, 1, 2].map((k) => values.reduce((best, value) => pick(best, value[k]), values[0][k]));
    }
  }
  return gltf.accessors.push(accessor) - 1;
}

// The four of two vertices' bones that move the middle most.
function middleOfWeights([jointsA, weightsA], [jointsB, weightsB]) {
  const sums = new Map();
  jointsA.forEach((joint, k) => sums.set(joint, (sums.get(joint) ?? 0) + weightsA[k] / 2));
  jointsB.forEach((joint, k) => sums.set(joint, (sums.get(joint) ?? 0) + weightsB[k] / 2));
  const most = [...sums].sort(([, a], [, b]) => b - a).slice(0, 4);
  while (most.length < 4) most.push([0, 0]);
  const total = most.reduce((sum, [, weight]) => sum + weight, 0) || 1;
  return [most.map(([joint]) => joint), most.map(([, weight]) => weight / total)];
}

function subdivide(primitive) {
  const { POSITION, JOINTS_0, WEIGHTS_0 } = primitive.attributes;
  const positions = read(POSITION), joints = read(JOINTS_0), weights = read(WEIGHTS_0);
  let triangles = read(primitive.indices).flat();
  for (let time = 0; time < Number(times); ++time) {
    const middles = new Map(), next = [];
    const middle = (a, b) => {
      const edge = a < b ? a * 2 ** 24 + b : b * 2 ** 24 + a;
      if (!middles.has(edge)) {
        middles.set(edge, positions.length);
        positions.push(positions[a].map((x, k) => (x + positions[b][k]) / 2));
        const [joint, weight] = middleOfWeights([joints[a], weights[a]], [joints[b], weights[b]]);
        joints.push(joint);
        weights.push(weight);
      }
      return middles.get(edge);
    };
    for (let i = 0; i < triangles.length; i += 3) {
      const [a, b, c] = triangles.slice(i, i + 3);
      const ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      next.push(a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca);
    }
    triangles = next;
  }
  primitive.attributes = {
    POSITION: write(positions, Float32Array, "VEC3", 5126),
    JOINTS_0: write(joints, Uint16Array, "VEC4", 5123),
    WEIGHTS_0: write(weights, Float32Array, "VEC4", 5126),
  };
  primitive.indices = write(triangles, Uint32Array, "SCALAR", 5125);
  delete primitive.targets;
}

for (const mesh of gltf.meshes) {
  mesh.primitives.forEach(subdivide);
  delete mesh.weights;
}
const body = Buffer.concat(chunks);
gltf.buffers = [{ byteLength: body.length }];
const text = Buffer.from(JSON.stringify(gltf));
const json = Buffer.concat([text, Buffer.alloc(-text.length & 3, " ")]);
const header = Buffer.alloc(20), binary = Buffer.alloc(8);
header.write("glTF");
[2, 28 + json.length + body.length, json.length].forEach((value, i) => header.writeUInt32LE(value, 4 + 4 * i));
header.write("JSON", 16);
binary.writeUInt32LE(body.length);
binary.write("BIN\0", 4);
writeFileSync(output, Buffer.concat([header, json, binary, body]));
