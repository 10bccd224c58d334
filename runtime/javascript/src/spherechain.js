// SPDX-License-Identifier: MIT
// The package: classes over module.cpp. index.d.ts says what they do. build.mjs puts the WebAssembly into `wasm`.
const wasm = '@WASM@';

const SIDES = [null, 'left', 'right'];
const RADII = { detect: 0, fit: 1 };
const SCOPES = { apart: 0, neighbours: 1, all: 2 };
const RELATIONS = ['apart', 'near', 'siblings', 'joined', 'two_bodies'];
const ROWS_3X4 = 1, COLUMNS_4X4 = 3;  // sc_matrix_layout
const PALETTE = 0, MORPHS = 1, SPHERES = 2, PAIRS = 3, PAIR_COUNT = 4, CONTACTS = 5, CONTACT_COUNT = 6, TRIANGLES = 7,
  TRIANGLE_COUNT = 8, PENETRATIONS = 9, PENETRATION_COUNT = 10, VERTICES = 11, VERTEX_COUNT = 12,
  CONTACTS_WITH = 13, CONTACT_WITH_COUNT = 14, PENETRATIONS_WITH = 15, PENETRATION_WITH_COUNT = 16;  // words of Results
const CONTACT_WORDS = 9, TRIANGLE_WORDS = 12, PENETRATION_WORDS = 44;

export class SpherechainError extends Error {
  constructor(message) {
    super(message);
    this.name = 'SpherechainError';
  }
}

let loading = null;

export function load() {
  loading ??= instantiate();
  return loading;
}

async function instantiate() {
  const bytes = Uint8Array.from(atob(wasm), letter => letter.charCodeAt(0));
  const { instance } = await WebAssembly.instantiate(bytes, { env: { emscripten_notify_memory_growth() {} } });
  instance.exports._initialize?.();
  return new Spherechain(new Native(instance.exports));
}

// The module's memory and functions.
class Native {
  #floats = null;
  #words = null;

  constructor(exports) {
    this.call = exports;
    this.memory = exports.memory;
    this.kinds = [0, 1, 2, 3, 4, 5].map(kind => this.text(exports.class_name(kind)));
  }

  // Views of the whole memory, made again when it has grown.
  get floats() {
    if (this.#floats?.buffer !== this.memory.buffer) this.#floats = new Float32Array(this.memory.buffer);
    return this.#floats;
  }
  get words() {
    if (this.#words?.buffer !== this.memory.buffer) this.#words = new Uint32Array(this.memory.buffer);
    return this.#words;
  }

  text(place) {
    const bytes = new Uint8Array(this.memory.buffer);
    return new TextDecoder().decode(bytes.slice(place, bytes.indexOf(0, place)));
  }

  // Memory for the time of a call.
  borrow(bytes, use) {
    const place = this.call.allocate(Math.max(bytes, 8));
    if (place === 0) throw this.noMemory();
    try {
      return use(place);
    } finally {
      this.call.release(place);
    }
  }

  error() {
    return new SpherechainError(this.text(this.call.failure()));
  }
  noMemory() {
    return new SpherechainError('out of memory');
  }
  check(failed) {
    if (failed !== 0) throw this.error();
  }
}

class Spherechain {
  #native;

  constructor(native) {
    this.#native = native;
    this.version = native.text(native.call.version());
  }

  open(bytes) {
    const isBytes = bytes instanceof Uint8Array || bytes instanceof ArrayBuffer;
    if (!isBytes) {
      const isLater = typeof bytes?.then === 'function' || typeof bytes?.arrayBuffer === 'function';
      throw new SpherechainError(`data: the bytes of a .sphc file are wanted, an ArrayBuffer or a Uint8Array, not ${kindOf(bytes)}` +
        (isLater ? `: await ${bytes.arrayBuffer ? 'its arrayBuffer()' : 'it'}` : ''));
    }
    return new Asset(this.#native, bytes instanceof ArrayBuffer ? new Uint8Array(bytes) : bytes);
  }
}

class Asset {
  #native;
  #asset = 0;
  #characters = new Set();

  constructor(native, bytes) {
    this.#native = native;
    const place = native.call.allocate(Math.max(bytes.length, 8));
    if (place === 0) throw native.noMemory();
    new Uint8Array(native.memory.buffer, place, bytes.length).set(bytes);
    this.#asset = native.call.open_asset(place, bytes.length);
    if (this.#asset === 0) throw native.error();
    native.borrow(4 * 32, out => this.#describe(out));
  }

  #describe(out) {
    const { call, words, floats } = this.#native;
    const asset = this.#asset, at = out / 4;
    call.describe(asset, out);
    const [spheres, bones, parts, morphs, regions, vertices, triangles, corners, source] = words.slice(at, at + 9);
    const vector = i => Object.freeze(Array.from(floats.subarray(at + i, at + i + 3)));
    this.origin = vector(9);
    this.left = vector(12);
    this.up = vector(15);
    this.forward = vector(18);
    this.height = floats[at + 21];
    this.metresPerUnit = floats[at + 22];
    this.vertexCount = vertices;
    this.triangleCount = triangles;
    this.sourceFile = this.#native.text(source);
    this.triangles = corners === 0 ? new Uint32Array(0) : words.slice(corners / 4, corners / 4 + 3 * triangles);
    const list = (count, make) => Object.freeze(Array.from({ length: count }, (_, i) => make(i)));
    this.regions = list(regions, i => this.#native.text(call.region_name(asset, i)));
    this.morphs = list(morphs, i => this.#native.text(call.morph_name(asset, i)));
    this.bones = list(bones, i => {
      call.describe_bone(asset, i, out);
      const rows = floats.subarray(words[at + 1] / 4);
      return Object.freeze({ name: this.#native.text(words[at]), inverseBind: columnsOf(rows) });
    });
    this.parts = list(parts, i => {
      call.describe_part(asset, i, out);
      return Object.freeze({
        name: this.#native.text(words[at]), side: SIDES[words[at + 1]], bone: words[at + 2] | 0, parent: words[at + 3] | 0,
      });
    });
    this.spheres = list(spheres, i => {
      call.describe_sphere(asset, i, out);
      return Object.freeze({
        center: vector(0), radius: floats[at + 3], detectRadius: floats[at + 4], side: SIDES[words[at + 5]],
        region: words[at + 6], level: words[at + 7] | 0,
      });
    });
  }

  createCharacter(joints) {
    if (this.#asset === 0) throw disposed('asset');
    if (this.bones.length === 0) {
      throw new SpherechainError('the asset has no bones: no palette moves it');
    }
    const character = joints === undefined ? this.#native.call.create_character(this.#asset, 0, 0, 0) : this.#withJoints(joints);
    const made = new Character(this.#native, this, character, joints?.length ?? this.bones.length,
      () => this.#characters.delete(made));
    this.#characters.add(made);
    return made;
  }

  // The joints, their matrices and their names lie behind each other.
  #withJoints(joints) {
    const native = this.#native;
    const floats = checkJoints(joints);
    const names = joints.map(joint => new TextEncoder().encode(`${joint.name}\0`));
    const matrices = 8 * joints.length, texts = matrices + 4 * floats * joints.length;
    return native.borrow(names.reduce((sum, name) => sum + name.length, texts), place => {
      let text = place + texts;
      joints.forEach((joint, i) => {
        const matrix = place + matrices + 4 * floats * i;
        if (floats > 0) native.floats.set(joint.inverseBind, matrix / 4);
        new Uint8Array(native.memory.buffer).set(names[i], text);
        native.words.set([text, floats > 0 ? matrix : 0], place / 4 + 2 * i);
        text += names[i].length;
      });
      return native.call.create_character(this.#asset, place, joints.length, floats === 16 ? COLUMNS_4X4 : ROWS_3X4);
    });
  }

  dispose() {
    for (const character of [...this.#characters]) character.dispose();
    if (this.#asset !== 0) this.#native.call.close_asset(this.#asset);
    this.#asset = 0;
  }
}

class Character {
  #native;
  #character;
  #gone;
  #views = [];
  #isPosed = false;
  #scope = 'apart';
  #has = null;  // of this pose and scope: null, 'parts', 'triangles'
  #contacts = new Pool(newContact);
  #triangles = { count: 0, pairs: null, segments: null };
  #penetrations = new Pool(newPenetration);
  #contactsWith = new Pool(newContact);
  #penetrationsWith = new Pool(newPenetration);

  constructor(native, asset, character, jointCount, gone) {
    if (character === 0) throw native.error();
    this.asset = asset;
    this.jointCount = jointCount;
    this.#native = native;
    this.#character = character;
    this.#gone = gone;
  }

  setPalette(palette, morphWeights) {
    const character = this.#open(), n = this.jointCount, morphs = this.asset.morphs.length;
    if (palette?.length !== 16 * n && palette?.length !== 12 * n) {
      throw new SpherechainError(`the palette has ${palette?.length ?? 'no'} floats: ${16 * n} are wanted, 16 by columns for each ` +
        `of ${n} joints, or ${12 * n}, 12 by rows`);
    }
    if (morphWeights && morphWeights.length !== morphs) {
      throw new SpherechainError(`${morphWeights.length} morph weights: the asset has ${morphs} morphs`);
    }
    this.#isPosed = false;
    this.#has = null;
    this.#scope = 'apart';
    this.#native.floats.set(palette, this.#result(PALETTE) / 4);
    if (morphWeights) this.#native.floats.set(morphWeights, this.#result(MORPHS) / 4);
    this.#native.check(this.#native.call.set_pose(character, palette.length === 16 * n ? COLUMNS_4X4 : ROWS_3X4, morphWeights ? 1 : 0));
    this.#isPosed = true;
  }

  checkRest() {
    this.#native.check(this.#native.call.check_rest(this.#posed()));
  }

  refit(radius = 'detect') {
    this.#native.check(this.#native.call.refit(this.#posed(), choice(RADII, radius, 'radius')));
    return this.#view(SPHERES, Float32Array, 4 * this.asset.spheres.length);
  }

  detect(radius = 'detect') {
    this.#native.check(this.#native.call.detect(this.#posed(), choice(RADII, radius, 'radius')));
    return this.#view(PAIRS, Uint32Array, 2 * this.#result(PAIR_COUNT));
  }

  contacts(scope = 'apart') {
    choice(SCOPES, scope, 'scope');
    if (scope !== this.#scope) this.#has = null;
    this.#scope = scope;
    this.#find('parts');
    return this.#contacts.fill(this.#result(CONTACT_COUNT), this.#result(CONTACTS) / 4, CONTACT_WORDS, this.#readContact);
  }

  triangleContacts() {
    this.#find('triangles');
    const count = this.#result(TRIANGLE_COUNT), found = this.#triangles;
    found.count = count;
    found.pairs = this.#view(TRIANGLES, Uint32Array, TRIANGLE_WORDS * count);
    found.segments = this.#view(TRIANGLES, Float32Array, TRIANGLE_WORDS * count);
    return found;
  }

  penetrations(quick = true) {
    checkQuick(quick);
    this.#find('triangles');
    this.#native.check(this.#native.call.measure(this.#character, SCOPES[this.#scope], quick ? 1 : 0));
    return this.#penetrations.fill(this.#result(PENETRATION_COUNT), this.#result(PENETRATIONS) / 4, PENETRATION_WORDS,
      this.#readPenetration);
  }

  contactsWith(other) {
    this.#meet(other, 0);
    return this.#contactsWith.fill(this.#result(CONTACT_WITH_COUNT), this.#result(CONTACTS_WITH) / 4, CONTACT_WORDS, this.#readContact);
  }

  penetrationsWith(other, quick = true) {
    checkQuick(quick);
    this.#meet(other, 1);
    this.#native.check(this.#native.call.measure_meeting(this.#character, other.#character, quick ? 1 : 0));
    return this.#penetrationsWith.fill(this.#result(PENETRATION_WITH_COUNT), this.#result(PENETRATIONS_WITH) / 4, PENETRATION_WORDS,
      this.#readPenetration);
  }

  vertices() {
    this.#native.check(this.#native.call.skin(this.#posed()));
    return this.#view(VERTICES, Float32Array, 3 * this.#result(VERTEX_COUNT));
  }

  dispose() {
    if (this.#character === 0) return;
    this.#native.call.destroy_character(this.#character);
    this.#character = 0;
    this.#gone();
  }

  #open() {
    if (this.#character === 0) throw disposed('character');
    return this.#character;
  }

  #posed() {
    const character = this.#open();
    if (!this.#isPosed) throw new SpherechainError('no palette is set: call setPalette() first');
    return character;
  }

  #result(word) {
    return this.#native.words[this.#character / 4 + word];
  }

  #find(what) {
    const character = this.#posed();
    if (this.#has === what || this.#has === 'triangles') return;
    this.#native.check(this.#native.call.find_contacts(character, SCOPES[this.#scope], what === 'triangles' ? 1 : 0));
    this.#has = what;
  }

  #meet(other, listsTriangles) {
    const character = this.#posed();
    if (!(other instanceof Character) || other === this) throw new SpherechainError('other: another character is wanted');
    this.#native.check(this.#native.call.meet(character, other.#posed(), listsTriangles));
  }

  #readContact = (contact, at) => {
    const { floats, words } = this.#native;
    contact.partA = words[at];
    contact.partB = words[at + 1];
    contact.trianglePairs = words[at + 2];
    copy(floats, at + 3, contact.low);
    copy(floats, at + 6, contact.high);
  };

  #readPenetration = (found, at) => {
    const { floats, words, kinds } = this.#native;
    found.part = words[at];
    found.other = words[at + 1];
    found.bone = words[at + 2] | 0;
    found.kind = kinds[words[at + 3]];
    copy(floats, at + 4, found.direction);
    found.distance = floats[at + 7];
    copy(floats, at + 8, found.centre);
    copy(floats, at + 11, found.low);
    copy(floats, at + 14, found.high);
    copyPoint(floats, words, at + 17, found.deepest);
    copyPoint(floats, words, at + 24, found.deepestOther);
    found.depth = floats[at + 31];
    found.volume = known(floats[at + 32]);
    found.contourLength = floats[at + 33];
    found.visible = floats[at + 34];
    found.touching = floats[at + 35];
    found.facing = floats[at + 36];
    found.restDistance = floats[at + 37];
    found.thickness = known(floats[at + 38]);
    found.swallowed = known(floats[at + 39]);
    found.height = floats[at + 40];
    found.metre = floats[at + 41];
    found.relation = RELATIONS[words[at + 42]];
    found.isOnePiece = words[at + 43] === 1;
  };

  // The last one where it still fits: in most frames nothing is new.
  #view(word, Type, length) {
    const buffer = this.#native.memory.buffer, place = this.#result(word), slot = 2 * word + (Type === Float32Array ? 1 : 0);
    const last = this.#views[slot];
    if (last?.buffer === buffer && last.byteOffset === place && last.length === length) return last;
    return (this.#views[slot] = new Type(buffer, place, length));
  }
}

// Objects that are filled again each time.
class Pool {
  #made = [];
  #list = [];
  #make;

  constructor(make) {
    this.#make = make;
  }

  fill(count, first, stride, write) {
    while (this.#made.length < count) this.#made.push(this.#make());
    this.#list.length = count;
    for (let i = 0; i < count; ++i) {
      this.#list[i] = this.#made[i];
      write(this.#made[i], first + stride * i);
    }
    return this.#list;
  }
}

function newContact() {
  return { partA: 0, partB: 0, trianglePairs: 0, low: new Float32Array(3), high: new Float32Array(3) };
}

function newPoint() {
  return { position: new Float32Array(3), triangle: 0, weights: new Float32Array(3) };
}

function newPenetration() {
  return {
    part: 0, other: 0, bone: -1, kind: 'rest', depth: 0, distance: 0, direction: new Float32Array(3),
    centre: new Float32Array(3), low: new Float32Array(3), high: new Float32Array(3), deepest: newPoint(),
    deepestOther: newPoint(), volume: null, contourLength: 0, visible: 0, touching: 0, facing: 0, restDistance: 0,
    thickness: null, swallowed: null, height: 0, metre: 0, relation: 'apart', isOnePiece: false,
  };
}

// The runtime's negative measures are not known.
function known(measure) {
  return measure < 0 ? null : measure;
}

function copy(floats, at, out) {
  out[0] = floats[at];
  out[1] = floats[at + 1];
  out[2] = floats[at + 2];
}

function copyPoint(floats, words, at, out) {
  copy(floats, at, out.position);
  out.triangle = words[at + 3];
  copy(floats, at + 4, out.weights);
}

// Three rows of four to four columns of four.
function columnsOf(rows) {
  const out = new Float32Array(16);
  for (let i = 0; i < 12; ++i) out[(i % 4) * 4 + Math.floor(i / 4)] = rows[i];
  out[15] = 1;
  return out;
}

function checkQuick(quick) {
  if (typeof quick !== 'boolean') throw new SpherechainError(`quick: true or false is wanted, not ${kindOf(quick)}`);
}

// Floats of each joint's inverse bind matrix; 0 where none has one.
function checkJoints(joints) {
  if (!Array.isArray(joints)) {
    throw new SpherechainError(`joints: an array of { name, inverseBind } is wanted, not ${kindOf(joints)}; without joints ` +
      'palettes come in the order of asset.bones');
  }
  if (joints.length === 0) throw new SpherechainError('joints: the list is empty: is the skeleton loaded?');
  joints.forEach((joint, i) => {
    if (typeof joint?.name !== 'string') throw new SpherechainError(`joints[${i}]: its name is ${kindOf(joint?.name)}, a string is wanted`);
  });
  const matrixOf = joint => joint.inverseBind ?? null;
  const first = joints.findIndex(joint => matrixOf(joint) !== null);
  if (first < 0) return 0;
  joints.forEach((joint, i) => {
    const matrix = matrixOf(joint), refuse = what => {
      throw new SpherechainError(`joint "${joint.name}" (joints[${i}]): inverseBind ${what}`);
    };
    if (matrix === null) refuse(`is missing, but joint "${joints[first].name}" has one`);
    if (![12, 16].includes(matrix.length) || !Array.prototype.every.call(matrix, Number.isFinite)) {
      refuse(`is ${kindOf(matrix)}: 16 numbers by columns, or 12 by rows, are wanted` + (matrix.elements ? '; pass its elements' : ''));
    }
    if (matrix.length !== matrixOf(joints[first]).length) {
      refuse(`has ${matrix.length} numbers, that of joint "${joints[first].name}" ${matrixOf(joints[first]).length}`);
    }
  });
  return matrixOf(joints[first]).length;
}

// Of a value that is refused: "null", "a Promise", "an Array of 2".
function kindOf(value) {
  if (typeof value === 'string') return `"${value}"`;
  if (typeof value === 'function') return 'a function';
  const name = value?.constructor?.name;
  if (typeof value !== 'object' || !name) return String(value);
  return `${/^[AEIOU]/.test(name) ? 'an' : 'a'} ${name}${value.length === undefined ? '' : ` of ${value.length}`}`;
}

function choice(table, name, what) {
  if (!Object.hasOwn(table, name)) {
    throw new SpherechainError(`${what} "${name}": one of ${Object.keys(table).join(', ')} is wanted`);
  }
  return table[name];
}

function disposed(what) {
  return new SpherechainError(`the ${what} is disposed of`);
}
