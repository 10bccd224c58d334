// GLBs in JavaScript: read, write, load with three.js without pictures, check with the Khronos validator.
import fs from 'node:fs';
import validator from 'gltf-validator';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';

export function readGlb(file) {
  const bytes = fs.readFileSync(file);
  const size = bytes.readUInt32LE(12);
  return { json: JSON.parse(bytes.toString('utf8', 20, 20 + size)), rest: bytes.subarray(20 + size), bytes };
}

export function glbBytes(json, binary) {
  const padded = (buffer, fill) => Buffer.concat([buffer, Buffer.alloc((4 - (buffer.length % 4)) % 4, fill)]);
  const text = padded(Buffer.from(JSON.stringify(json)), ' '), data = padded(Buffer.from(binary), 0);
  const word = (value) => {
    const out = Buffer.alloc(4);
    out.writeUInt32LE(value);
    return out;
  };
  const chunks = [word(text.length), 'JSON', text, word(data.length), 'BIN\0', data];
  return Buffer.concat(['glTF', word(2), word(28 + text.length + data.length), ...chunks].map((c) => Buffer.from(c)));
}

// three.js in Node decodes no pictures.
function withoutPictures(file) {
  const { json, rest } = readGlb(file);
  for (const name of ['materials', 'textures', 'images', 'samplers']) delete json[name];
  for (const mesh of json.meshes ?? []) for (const primitive of mesh.primitives) delete primitive.material;
  const used = (name) => !/^(KHR_materials|KHR_texture|EXT_texture|VRMC_materials)/.test(name);
  if (json.extensionsUsed) json.extensionsUsed = json.extensionsUsed.filter(used);
  if (json.extensionsRequired) json.extensionsRequired = json.extensionsRequired.filter(used);
  const out = glbBytes(json, rest.subarray(8));
  return out.buffer.slice(out.byteOffset, out.byteOffset + out.length);
}

globalThis.self ??= globalThis;
globalThis.ProgressEvent ??= class {};

export async function loadGlb(file, ...plugins) {
  const loader = new GLTFLoader();
  for (const plugin of plugins) loader.register(plugin);
  const gltf = await loader.parseAsync(withoutPictures(file), '');
  const nodes = await gltf.parser.getDependencies('node');
  gltf.scene.updateMatrixWorld(true);
  return { ...gltf, nodes };
}

export async function validate(file) {
  const { issues } = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
  if (issues.numErrors > 0) {
    throw new Error(`${file}: ${issues.messages.filter((m) => m.severity === 0).map((m) => m.message).slice(0, 5).join('; ')}`);
  }
}
