// SPDX-License-Identifier: MIT
// The package: classes over the C interface. index.d.ts says what they do; module.cpp asserts how the structs below lie in memory.
// build.mjs puts the WebAssembly into `wasm`.
const wasm = '@WASM@';

export class SpherechainError extends Error {
  name = 'SpherechainError';
}

function refuse(why) {
  throw new SpherechainError(why);
}

let loading = null;
let call, bytes, words, floats;  // the module's functions, and views of all its memory
let status, query, subject, pose, out, responseFrame, sentence;  // where calls pass structs
const SENTENCE_BYTES = 256;
const ABI_VERSION = 18, IGNORED_PAIRS = 30;  // SC_ABI_VERSION, and where sc_asset_info.ignored_pairs is: module.cpp asserts both
const STATE_WORDS = 960, JOINT_FLOATS = 10, OTHERS_MAX = 8;  // twice SC_RESPONSE_WORDS; an sc_transform
const handles = new WeakMap();  // where models, bodies, responses and ignored pairs are in memory, until they are disposed of

export function load() {
  return (loading ??= instantiate());
}

async function instantiate() {
  const source = Uint8Array.from(atob(wasm), letter => letter.charCodeAt(0));
  const { instance } = await WebAssembly.instantiate(source, { env: { emscripten_notify_memory_growth: look } });
  call = instance.exports;
  look();
  call._initialize?.();
  [status, query, subject, pose, out, responseFrame, sentence] = [8, 60, 80, 40, 128, 84, SENTENCE_BYTES].map(allocate);
  return new Spherechain();
}

function look() {
  bytes = new Uint8Array(call.memory.buffer);
  words = new Uint32Array(call.memory.buffer);
  floats = new Float32Array(call.memory.buffer);
}

function textAt(place) {
  return new TextDecoder().decode(bytes.slice(place, bytes.indexOf(0, place)));
}

function allocate(size) {
  const place = call.malloc(Math.max(size, 8));
  if (place === 0) refuse('out of memory');
  return place;
}

// Copies arrays into memory for the time of a call.
function lend(arrays, use) {
  const ends = arrays.map((end => array => (end += 8 * Math.ceil(array.byteLength / 8)))(0));
  const first = allocate(ends.at(-1));
  try {
    const places = arrays.map((_, i) => first + (ends[i - 1] ?? 0));
    arrays.forEach((array, i) => bytes.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), places[i]));
    return use(places);
  } finally {
    call.free(first);
  }
}

// Memory that is used again in each frame: one of several rooms.
function room(rooms, which, size) {
  const own = (rooms[which] ??= { place: 0, size: -1 });
  if (size <= own.size) return own.place;
  call.free(own.place);
  Object.assign(own, { place: 0, size: -1 });
  return Object.assign(own, { place: allocate(size), size }).place;
}

const NOT_OPEN = 8, FIELD_BODIES = 37, BODIES = {  // what sc_codes mean with that sc_field
  4: 'the body was made without findsSteps, or for a smaller largestOther',
  7: 'other: another body is wanted',
  [NOT_OPEN]: 'a body has no pose: call setPose() first; steps need two poses',
};

// Throws if the last call failed. `hasSentence`: where it wrote why.
function check(hasSentence = false) {
  const code = words[status / 4], field = words[status / 4 + 1];
  if (code === 0) return;
  const why = hasSentence ? textAt(sentence) : field === FIELD_BODIES ? BODIES[code] : '', name = textAt(call.sc_field_name(field));
  throw new SpherechainError(why || `${name}${name && ': '}${textAt(call.sc_code_text(code))}`);
}

// Types of fields: their words; a value to fill; how it is read and written at a place in memory.
const field = (first, read, write) => ({ words: 1, make: () => first, read, write });
const int = field(0, place => words[place / 4] | 0, (place, value = 0, name) => {
  if (!Number.isInteger(value)) refuse(`${name}: a whole number is wanted, not ${kindOf(value)}`);
  words[place / 4] = value;
});
const float = field(0, place => floats[place / 4], (place, value = 0, name) => {
  if (typeof value !== 'number') refuse(`${name}: a number is wanted, not ${kindOf(value)}`);
  floats[place / 4] = value;
});
const flag = field(false, place => words[place / 4] !== 0, (place, value) => int.write(place, value ? 1 : 0));
const text = field('', place => textAt(words[place / 4]));
// Negative where it is not known.
const measured = field(null, place => (floats[place / 4] < 0 ? null : floats[place / 4]), (place, value) => float.write(place, value ?? -1));
const choice = (...names) => field(names[0], place => names[words[place / 4]], (place, value = names[0], name) => {
  if (!names.includes(value)) refuse(`${name} ${kindOf(value)}: one of ${names.join(', ')} is wanted`);
  words[place / 4] = names.indexOf(value);
});
const vector = (...first) => ({
  words: first.length, make: () => Float32Array.from(first),
  read(place, value) {
    for (let i = 0; i < value.length; ++i) value[i] = floats[place / 4 + i];
    return value;
  },
  write(place, value = first, name) {
    if (value?.length !== first.length) refuse(`${name}: ${first.length} numbers are wanted, not ${kindOf(value)}`);
    floats.set(value, place / 4);
  },
});
// `reserved`: words at its end that are 0.
const struct = (fields, reserved = 0) => {
  const names = Object.keys(fields), types = Object.values(fields), callers = names.filter(name => name !== 'structSize');
  return {
    words: types.reduce((sum, type) => sum + type.words, reserved),
    make: () => Object.fromEntries(names.map((name, i) => [name, types[i].make()])),
    read(place, value) {
      for (let i = 0; i < names.length; place += 4 * types[i++].words) value[names[i]] = types[i].read(place, value[names[i]]);
      return value;
    },
    write(place, value, what) {
      checkKeys(value, callers, what);
      for (let i = 0; i < names.length; place += 4 * types[i++].words) types[i].write(place, value[names[i]], names[i]);
      words.fill(0, place / 4, place / 4 + reserved);
    },
  };
};
// The place of what `maker` made.
const handle = (maker, type) => field(0, null, (place, value, name) => {
  if (value !== undefined && !(handles.has(value) && value instanceof type())) refuse(`${name}: what ${maker} made is wanted, not ${kindOf(value)}`);
  words[place / 4] = value === undefined ? 0 : handles.get(value);
});
// The place of a copy, in a room of its own.
const rooms = [];
const copied = (sizeOf, write) => {
  const own = rooms.push(undefined) - 1;
  return field(0, null, (place, value, name) => {
    const copy = value === undefined ? 0 : room(rooms, own, sizeOf(value));
    if (value !== undefined) write(copy, value, name);
    words[place / 4] = copy;
  });
};
const copiedFloats = () => copied(value => 4 * value.length, (place, value) => floats.set(value, place / 4));

const structSize = field(0, null, place => words.fill(0, place / 4, place / 4 + 1));  // 0: the fields of release 0.1.0
const vec3 = vector(0, 0, 0), side = choice(null, 'left', 'right');
const CLASSES = ['rest', 'shell', 'touch', 'fold', 'deep_fold', 'penetration', 'inside'], classOf = choice(...CLASSES);
const Info = struct({
  sphereCount: int, boneCount: int, partCount: int, morphCount: int, regionCount: int, sourceBufferCount: int, vertexCount: int,
  triangleCount: int, ignoredPairCount: int, writer: text, settings: text, settingsSha256: text, sourceFile: text, sourceSha256: text,
  sourceRestHash: vector(0, 0), origin: vec3, left: vec3, up: vec3, forward: vec3, height: float, metresPerUnit: float,
});
const Bone = struct({ name: text, inverseBind: field(null, place => columnsOf(words[place / 4])) });
const Part = struct({ name: text, side, bone: int, parent: int, mobility: int });
const RestSphere = struct({ center: vec3, radius: float, detectRadius: float, side, region: int, level: int, part: int });
const Triangle = struct({ part: int, region: int, sphere: int });
const PartContact = struct({ partA: int, partB: int, trianglePairs: int, low: vec3, high: vec3 });
const StepContact = struct({
  partA: int, partB: int, atStart: flag, atEnd: flag, begin: float, end: float, triangleA: int, triangleB: int, at: vec3,
});
const SkinPoint = struct({ position: vec3, triangle: int, weights: vec3 });
const Measures = struct({
  depth: float, volume: measured, contourLength: float, visible: float, touching: float, facing: float, restDistance: float,
  thickness: measured, extent: measured, height: float, metre: float,
  relation: choice('apart', 'near', 'siblings', 'joined', 'two_bodies'), isOnePiece: flag, swallowed: float, through: flag,
}, 4);
const Penetration = struct({
  part: int, other: int, joint: int, kind: classOf, direction: vec3, faultDepth: float, distance: float, centre: vec3, low: vec3, high: vec3,
  deepest: SkinPoint, deepestOther: SkinPoint, measures: Measures,
}, 4);
const Rule = struct({
  version: int, touchDepth: float, touchMetres: float, touchMin: float, touchMax: float, touchTimes: float, extent: float,
  atRest: float, hidden: float, shell: float, fold: float, neighbours: float, foldDepth: float, looseDepth: float,
  inside: float,
}, 4);
const BodyDef = struct({
  structSize, findsSteps: flag, maxTriangles: int, maxPenetrations: int, largestOther: handle('createModel()', () => Model), allocator: int,
});
const Pose = struct({
  bones: copiedFloats(), boneCount: int, boneLayout: int, boneStride: int, morphWeights: copiedFloats(),
  morphWeightCount: int, vertices: int, vertexCount: int, vertexStride: int,
});
const Transform = struct({ translation: vec3, rotation: vector(0, 0, 0, 1), scale: vector(1, 1, 1) });
const Ground = struct({ structSize, up: vector(0, 1, 0), height: float, terrain: int, user: int });

let defaultRule;
const limits = copied(() => 4 * Rule.words, (place, value) => Rule.write(place, { ...defaultRule, ...value }, 'rule'));
const PART_WORDS = 8;  // of a bit for each part: an asset has 255 at most
const parts = () => copied(() => 4 * PART_WORDS, (place, value, name) => {
  words.fill(0, place / 4, place / 4 + PART_WORDS);
  for (const part of checkList(value, name)) {
    if (!(part >= 0 && part < 32 * PART_WORDS)) refuse(`${name}: ${kindOf(part)} is no body part`);
    words[place / 4 + (part >> 5)] |= 1 << part % 32;
  }
});
const history = copied(value => 4 * Penetration.words * checkList(value, 'previous').length, (place, value) => {
  for (let i = 0; i < value.length; ++i) Penetration.write(place + 4 * Penetration.words * i, value[i], `previous[${i}]`);
});
const Query = struct({
  structSize, scope: choice('apart', 'neighbours', 'all', 'layers'), full: flag, radius: choice('detect', 'fit'), ignoredPairs: handle('createIgnoredPairs()', () => IgnoredPairs), ignoredParts: parts(),
  ignoredPartsOfOther: parts(), partPairs: copied(value => 4 * value.length, (place, value) => words.set(value, place / 4)),
  rule: limits,
  classes: field(0, null, (place, value = [], name) => {
    let bits = 0;
    for (const kind of checkList(value, name)) {
      classOf.write(place, kind, name);
      bits |= 1 << words[place / 4];
    }
    words[place / 4] = bits;
  }),
  limit: int,
  previous: {
    words: 2,
    write(place, value) {
      history.write(place, value);
      words[place / 4 + 1] = value?.length ?? 0;
    },
  },
  tolerance: float, target: int,
});

const integers = () => copied(value => 4 * value.length, (place, value) => words.set(value, place / 4));
const ContactRow = struct({ part: int, other: int, body: int, at: vec3, atOther: vec3, normal: vec3, gap: float, allowed: float });
const ResponseDef = struct({
  structSize, parents: integers(), jointCount: int, mobility: copiedFloats(), budget: copiedFloats(), hinges: copiedFloats(),
  partPairs: integers(), rule: limits, allocator: int,
});
const ResponseFrame = struct({
  structSize, joints: copiedFloats(), place: copied(() => 4 * Transform.words, Transform.write), morphWeights: copiedFloats(), morphWeightCount: int,
  seconds: float, weakness: float, rounds: int, ahead: copiedFloats(), aheadFrames: int,
  others: copied(value => 4 * value.length, (place, value) => value.forEach((other, i) => {
    words[place / 4 + i] = other instanceof Body ? handleOf(other, 'other body') : refuse(`others[${i}]: a body is wanted, not ${kindOf(other)}`);
  })),
  otherCount: int, ground: copied(() => 4 * Ground.words, Ground.write), planted: integers(), plantedCount: int, target: int,
  turned: int, atBudget: int, remaining: float, rows: int, rowCount: int,
});
const responseState = integers();

class Spherechain {
  version = textAt(call.version());
  classes = Object.freeze([...CLASSES]);

  constructor() {
    call.sc_default_rule(out);
    this.defaultRule = defaultRule = Object.freeze(Rule.read(out, {}));
  }

  createModel(file, joints) {
    const data = dataOf(file), count = joints === undefined ? 0 : checkJoints(joints), names = joints ?? [];
    const texts = names.map(({ name }) => new TextEncoder().encode(`${name}\0`));
    const matrices = count === 0 ? [] : joints.map(({ inverseBind }) => Float32Array.from(inverseBind));
    return lend([data, new Uint32Array(2 * names.length), ...texts, ...matrices], ([first, table, ...places]) => {
      names.forEach((_, i) => words.set([places[i], places[names.length + i] ?? 0], table / 4 + 2 * i));
      words.set([0, layoutOf(count), first, data.length, joints ? table : 0, names.length, 0], subject / 4);
      call.sc_create_model(status, ABI_VERSION, subject, out, sentence, SENTENCE_BYTES);
      check(true);
      return new Model(words[out / 4], joints?.length);
    });
  }

  createResponseState() {
    return new Uint32Array(STATE_WORDS);
  }

  classify(measures, rule = {}) {
    limits.write(out, rule);
    Measures.write(subject, measures, 'measures');
    return CLASSES[call.sc_classify(words[out / 4], subject)];
  }
}

class Model {
  #owned = new Set();
  #triangles = null;

  constructor(model, jointCount) {
    handles.set(this, model);
    const asset = call.sc_get_asset(model);
    const read = (type, getter, ...index) => {
      getter(out, asset, ...index);
      return type.read(out, type.make());
    };
    const list = (count, make) => Object.freeze(Array.from({ length: count }, (_, i) => make(i)));
    Object.assign(this, read(Info, call.sc_asset_get_info));
    this.jointCount = jointCount ?? this.boneCount;
    this.regions = list(this.regionCount, i => textAt(call.sc_asset_region_name(asset, i)));
    this.morphs = list(this.morphCount, i => textAt(call.sc_asset_morph_name(asset, i)));
    this.bones = list(this.boneCount, i => Object.freeze(read(Bone, call.sc_asset_bone, i)));
    this.spheres = list(this.sphereCount, i => Object.freeze(read(RestSphere, call.sc_asset_sphere, i)));
    this.parts = list(this.partCount, i => Object.freeze({ ...read(Part, call.sc_asset_part, i), joint: call.sc_get_part_joint(model, i) }));
  }

  get triangles() {
    const model = handleOf(this, 'model'), indices = new Uint32Array(3 * this.triangleCount);
    return (this.#triangles ??= lend([indices], ([place]) => {
      call.index_triangles(model, place);
      return words.slice(place / 4, place / 4 + indices.length);
    }));
  }

  triangle(number) {
    call.sc_get_triangle(out, handleOf(this, 'model'), number);
    const found = Triangle.read(out, {});
    return found.part < 0 ? null : found;
  }

  millimetres(length) {
    return 1000 * length * this.metresPerUnit;
  }

  checkRest(palette) {
    const model = handleOf(this, 'model');
    writePose(this, palette);
    words[sentence / 4] = 0;
    call.sc_check_rest(status, model, pose, sentence, SENTENCE_BYTES);
    check(true);
  }

  createBody(options = {}) {
    const model = handleOf(this, 'model');
    BodyDef.write(subject, options, 'options');
    call.sc_create_body(status, model, subject, out);
    check();
    return this.#own(Body, words[out / 4], call.sc_destroy_body);
  }

  createIgnoredPairs() {
    const asset = call.sc_get_asset(handleOf(this, 'model')), count = 2 * call.sc_pair_words(asset), pairs = allocate(4 * count);
    call.sc_asset_get_info(out, asset);
    const own = words[out / 4 + IGNORED_PAIRS] / 4;
    words.copyWithin(pairs / 4, own, own + count);
    return this.#own(IgnoredPairs, pairs, call.free);
  }

  #own(Class, place, free) {
    const made = new Class(this, () => {
      if (this.#owned.delete(made)) free(place);
      handles.delete(made);
    });
    handles.set(made, place);
    this.#owned.add(made);
    return made;
  }

  dispose() {
    for (const made of [...this.#owned]) made.dispose();
    if (handles.has(this)) call.sc_destroy_model(handles.get(this));
    handles.delete(this);
  }
}

class IgnoredPairs {
  constructor(model, dispose) {
    Object.assign(this, { model, dispose });
  }

  ignorePair(a, b, isIgnored = true) {
    const pairs = handleOf(this, 'ignored pairs'), low = Math.min(a, b), high = Math.max(a, b), bit = (high * (high - 1)) / 2 + low;
    const are = Number.isInteger(low) && Number.isInteger(high) && low >= 0 && low !== high && high < this.model.sphereCount;
    if (!are) refuse(`ignorePair(): two different spheres are wanted, not ${a} and ${b}`);
    const at = pairs / 4 + (bit >> 5), mask = 1 << bit % 32;
    words[at] = isIgnored ? words[at] | mask : words[at] & ~mask;
  }
  ignoreParts(part, other, isIgnored = true) {
    const pairs = handleOf(this, 'ignored pairs');
    call.sc_ignore_parts(status, call.sc_get_asset(handles.get(this.model)), pairs, part, other, isIgnored ? 1 : 0);
    check();
  }
}

const POSE_KEYS = ['morphWeights', 'place', 'vertices'];
const findSteps = (_, body, other, asked, found) => call.sc_find_steps(status, body, other, asked, found, found + 4);
const findSpherePairs = (_, body, about, asked, found) => call.sc_find_sphere_pairs(status, body, asked, found);

class Body {
  #free;
  #rooms = [];  // for vertices of a pose and of the one before, and of the posed skin
  #turn = 0;
  #views = [];
  #penetrations = listOf(Penetration);
  #penetrationsOfOther = listOf(Penetration);
  #below = listOf(Penetration);
  #parts = listOf(PartContact);
  #steps = listOf(StepContact);
  #contacts = { parts: [], spheres: null, sphereTotal: 0, triangles: null, segments: null, triangleTotal: 0 };
  #spherePairs = { spheres: null, pairs: null, total: 0 };
  #responses = new Set();
  #bounds = { low: vec3.make(), high: vec3.make() };

  constructor(model, free) {
    this.model = model;
    this.#free = free;
  }

  setPose(palette, options = {}) {
    const body = handleOf(this, 'body'), { morphWeights, place, vertices } = options, count = 3 * this.model.vertexCount;
    checkKeys(options, POSE_KEYS, 'setPose()');
    let copy = 0;
    if (vertices) {
      if (vertices.length !== count) refuse(`vertices: ${count} floats are wanted, three for each of the source's, not ${kindOf(vertices)}`);
      this.#turn = 1 - this.#turn;
      copy = room(this.#rooms, this.#turn, 4 * count);
      floats.set(vertices, copy / 4);
    }
    writePose(this.model, palette, morphWeights, copy);
    if (place !== undefined) Transform.write(subject, place, 'place');
    call.sc_set_pose(status, body, pose, place === undefined ? 0 : subject);
    check();
    if (call.refuse_not_finite(body, sentence)) refuse(textAt(sentence));
  }

  penetrations(other, asked) {
    this.#find(call.sc_find_penetrations, other, asked);
    return other instanceof Body ? this.#penetrationsOfOther() : this.#penetrations();
  }

  below(ground, asked) {
    Ground.write(subject, ground, 'ground');
    this.#ask(call.sc_find_in_ground, subject, asked);
    return this.#below();
  }

  contacts(other, asked) {
    this.#find(call.sc_find_contacts, other, asked);
    const found = this.#contacts, at = out / 4, triangles = words[at + 5], length = 12 * words[at + 6];
    found.spheres = this.#view(0, Uint32Array, words[at + 2], 2 * words[at + 3]);
    found.sphereTotal = words[at + 4];
    found.triangles = this.#view(1, Uint32Array, triangles, length);
    found.segments = this.#view(2, Float32Array, triangles, length);
    found.triangleTotal = words[at + 7];
    found.parts = this.#parts(words[at + 1]);
    return found;
  }

  spherePairs(asked) {
    const found = this.#spherePairs, at = out / 4;
    this.#ask(findSpherePairs, 0, asked);
    found.spheres = this.#view(3, Float32Array, words[at], 4 * words[at + 1]);
    found.pairs = this.#view(4, Uint32Array, words[at + 2], 2 * words[at + 3]);
    found.total = words[at + 4];
    return found;
  }

  steps(other, asked) {
    this.#find(findSteps, other, asked);
    return this.#steps(words[out / 4 + 1]);
  }

  bounds() {
    call.sc_get_bounds(status, handleOf(this, 'body'), out, out + 12);
    check();
    vec3.read(out, this.#bounds.low);
    vec3.read(out + 12, this.#bounds.high);
    return this.#bounds;
  }

  vertices() {
    const body = handleOf(this, 'body'), count = call.count_skin_vertices(handles.get(this.model)), place = room(this.#rooms, 2, 12 * count);
    if (call.pose_skin(body, place) === 0) refuse(BODIES[NOT_OPEN]);
    return this.#view(5, Float32Array, place, 3 * count);
  }

  createResponse(options) {
    const body = handleOf(this, 'body'), { partCount } = this.model;
    checkKeys(options, RESPONSE_KEYS, 'createResponse()');
    const { parents, mobility, budget, hinges, partPairs, rule } = options;
    checkNumbers(parents, parents?.length, 'parents', Number.isInteger);
    for (const [name, given] of [['mobility', mobility], ['budget', budget]]) {
      if (given !== undefined) checkNumbers(given, parents.length, name);
    }
    if (hinges !== undefined) checkNumbers(hinges, 3 * parents.length, 'hinges');
    ResponseDef.write(subject, {
      parents, jointCount: parents.length, mobility, budget, hinges, rule,
      partPairs: partPairs === undefined ? undefined : pairBits(partPairs, partCount, partCount),
    }, 'response');
    call.sc_create_response(status, body, subject, out);
    check();
    const place = words[out / 4], made = new Response(this, parents.length, () => {
      if (this.#responses.delete(made)) call.sc_destroy_response(place);
      handles.delete(made);
    });
    handles.set(made, place);
    this.#responses.add(made);
    return made;
  }

  dispose() {
    for (const made of [...this.#responses]) made.dispose();
    this.#free();
    this.#rooms.splice(0).forEach(({ place }) => call.free(place));
  }

  // `other` is another body, or the query where there is none.
  #find(question, other, asked) {
    if (other instanceof Body) return this.#ask(question, handleOf(other, 'other body'), asked, other.model);
    if (asked !== undefined) refuse(`other: another body is wanted, not ${kindOf(other)}`);
    this.#ask(question, 0, other);
  }

  #ask(question, about, asked, { partCount } = this.model) {
    const body = handleOf(this, 'body');
    if (asked?.partPairs !== undefined) asked = { ...asked, partPairs: pairBits(asked.partPairs, this.model.partCount, partCount) };
    if (asked !== undefined) Query.write(query, asked, 'query');
    question(status, body, about, asked === undefined ? 0 : query, out);
    check();
  }

  // The last one where it still fits: in most frames nothing is new.
  #view(slot, Type, place, length) {
    const { buffer } = call.memory, last = this.#views[slot];
    if (last?.buffer === buffer && last.byteOffset === place && last.length === length) return last;
    return (this.#views[slot] = new Type(buffer, place, length));
  }
}

const RESPONSE_KEYS = ['parents', 'mobility', 'budget', 'hinges', 'partPairs', 'rule'];
const FRAME_KEYS = ['seconds', 'place', 'morphWeights', 'weakness', 'rounds', 'ahead', 'aheadFrames', 'others', 'ground', 'planted'];
const FRAME_JOINTS = 1, FRAME_TURNED = 16, FRAME_AT_BUDGET = 17, FRAME_REMAINING = 18, FRAME_ROWS = 19;  // words of an sc_response_frame

class Response {
  #jointCount;
  #rows = listOf(ContactRow);
  #answer = { turned: 0, atBudget: 0, remaining: 0, rows: null };

  constructor(body, jointCount, dispose) {
    Object.assign(this, { body, dispose });
    this.#jointCount = jointCount;
  }

  respond(state, joints, options) {
    const response = handleOf(this, 'response'), length = JOINT_FLOATS * this.#jointCount, { morphCount } = this.body.model;
    checkKeys(options, FRAME_KEYS, 'respond()');
    const { ahead, aheadFrames = 0, others = [], planted = [], morphWeights } = options;
    if (!(state instanceof Uint32Array) || state.length !== STATE_WORDS) refuse(`state: what createResponseState() made is wanted, not ${kindOf(state)}`);
    checkJointFloats(joints, length, 'joints');
    if (ahead !== undefined) checkJointFloats(ahead, length, 'ahead');
    if ((ahead === undefined) !== (aheadFrames === 0)) refuse('ahead, aheadFrames: both are wanted, or neither');
    if (checkList(others, 'others').length > OTHERS_MAX) refuse(`others: at most ${OTHERS_MAX} bodies are wanted, not ${others.length}`);
    if (planted.length > 0) checkNumbers(planted, planted.length, 'planted', Number.isInteger);
    if (morphWeights && morphWeights.length !== morphCount) refuse(`${morphWeights.length} morph weights: the asset has ${morphCount} morphs`);
    ResponseFrame.write(responseFrame, {
      ...options, joints, aheadFrames, others, otherCount: others.length, planted, plantedCount: planted.length, morphWeightCount: morphWeights?.length,
    }, 'frame');
    responseState.write(out, state);
    const memory = words[out / 4] / 4, at = responseFrame / 4, own = words[at + FRAME_JOINTS] / 4;
    call.sc_respond(status, response, 4 * memory, responseFrame);
    check();
    state.set(words.subarray(memory, memory + STATE_WORDS));
    joints.set(floats.subarray(own, own + length));
    const answer = this.#answer;
    answer.turned = words[at + FRAME_TURNED];
    answer.atBudget = words[at + FRAME_AT_BUDGET];
    answer.remaining = floats[at + FRAME_REMAINING];
    words.copyWithin(out / 4, at + FRAME_ROWS, at + FRAME_ROWS + 2);
    answer.rows = this.#rows(words[out / 4 + 1]);
    return answer;
  }
}

function checkJointFloats(array, length, name) {
  if (!(array instanceof Float32Array) || array.length !== length) {
    refuse(`${name}: a Float32Array of ${length} is wanted, translation, rotation and scale of each joint, not ${kindOf(array)}`);
  }
}

function checkNumbers(list, length, name, isOne = Number.isFinite) {
  if (!(list?.length === length && length > 0) || !Array.prototype.every.call(list, isOne)) {
    refuse(`${name}: a number for each joint is wanted, not ${kindOf(list)}`);
  }
}

// A list of objects that are filled again each time, by what a call found: where they are, how many are there, how many there were.
function listOf(type) {
  const made = [], list = Object.assign([], { total: 0 });
  return (total = words[out / 4 + 2]) => {
    const first = words[out / 4], count = words[out / 4 + 1];
    while (made.length < count) made.push(type.make());
    list.length = count;
    list.total = total;
    for (let i = 0; i < count; ++i) list[i] = type.read(first + 4 * type.words * i, made[i]);
    return list;
  };
}

function handleOf(object, what) {
  if (!handles.has(object)) refuse(`the ${what} is disposed of`);
  return handles.get(object);
}

function writePose({ jointCount, morphCount }, palette, morphWeights, vertices = 0) {
  const length = palette?.length, morphs = morphWeights?.length;
  if (length !== 16 * jointCount && length !== 12 * jointCount && (palette || !vertices)) {
    refuse(`the palette has ${length ?? 'no'} floats: ${16 * jointCount} are wanted, 16 by columns for each of ${jointCount} joints, or ` +
      `${12 * jointCount}, 12 by rows`);
  }
  if (morphWeights && morphs !== morphCount) refuse(`${morphs} morph weights: the asset has ${morphCount} morphs`);
  Pose.write(pose, {
    bones: palette ?? undefined, boneCount: jointCount, boneLayout: layoutOf(length / jointCount), morphWeights, morphWeightCount: morphs,
    vertices, vertexCount: 0xffffffff,
  }, 'pose');
}

// Three rows of four to four columns of four.
function columnsOf(place) {
  const columns = new Float32Array(16);
  for (let i = 0; i < 12; ++i) columns[(i % 4) * 4 + Math.floor(i / 4)] = floats[place / 4 + i];
  columns[15] = 1;
  return columns;
}

// An sc_matrix_layout: by rows, or by columns.
function layoutOf(floatCount) {
  return floatCount === 12 ? 1 : 3;
}

function checkKeys(object, keys, what) {
  if (typeof object !== 'object' || object === null) refuse(`${what}: an object is wanted, not ${kindOf(object)}`);
  for (const key in object) if (!keys.includes(key)) refuse(`${what}: "${key}" is none of ${keys.join(', ')}`);
}

function checkList(value, name) {
  return Array.isArray(value) ? value : refuse(`${name}: a list is wanted, not ${kindOf(value)}`);
}

// A bit for each pair of body parts; of an even number of words.
function pairBits(pairs, count, otherCount) {
  const bits = new Uint32Array(2 * Math.ceil(count * otherCount / 64));
  for (const pair of checkList(pairs, 'partPairs')) {
    const [a, b] = pair?.length === 2 ? pair : refuse(`partPairs: two numbers of parts are wanted, not ${kindOf(pair)}`);
    if (!(a >= 0 && a < count && b >= 0 && b < otherCount)) refuse(`partPairs: [${a}, ${b}] are no two body parts`);
    const bit = a * otherCount + b;
    bits[bit >> 5] |= 1 << bit % 32;
  }
  return bits;
}

function dataOf(file) {
  if (file instanceof Uint8Array) return file;
  if (file instanceof ArrayBuffer) return new Uint8Array(file);
  const isLater = typeof file?.then === 'function' || typeof file?.arrayBuffer === 'function';
  refuse(`data: the bytes of a .sphc file are wanted, an ArrayBuffer or a Uint8Array, not ${kindOf(file)}` +
    (isLater ? `: await ${file.arrayBuffer ? 'its arrayBuffer()' : 'it'}` : ''));
}

// Floats of each joint's inverse bind matrix; 0 where none has one.
function checkJoints(joints) {
  if (!Array.isArray(joints)) {
    refuse(`joints: an array of { name, inverseBind } is wanted, not ${kindOf(joints)}; without joints ` +
      'palettes come in the order of model.bones');
  }
  if (joints.length === 0) refuse('joints: the list is empty: is the skeleton loaded?');
  joints.forEach((joint, i) => {
    if (typeof joint?.name !== 'string') refuse(`joints[${i}]: its name is ${kindOf(joint?.name)}, a string is wanted`);
  });
  const matrixOf = joint => joint.inverseBind ?? null;
  const first = joints.findIndex(joint => matrixOf(joint) !== null);
  if (first < 0) return 0;
  joints.forEach((joint, i) => {
    const matrix = matrixOf(joint), wrong = what => refuse(`joint "${joint.name}" (joints[${i}]): inverseBind ${what}`);
    if (matrix === null) wrong(`is missing, but joint "${joints[first].name}" has one`);
    if (![12, 16].includes(matrix.length) || !Array.prototype.every.call(matrix, Number.isFinite)) {
      wrong(`is ${kindOf(matrix)}: 16 numbers by columns, or 12 by rows, are wanted` + (matrix.elements ? '; pass its elements' : ''));
    }
    if (matrix.length !== matrixOf(joints[first]).length) {
      wrong(`has ${matrix.length} numbers, that of joint "${joints[first].name}" ${matrixOf(joints[first]).length}`);
    }
  });
  return matrixOf(joints[first]).length;
}

// Describes the type of a refused value: "null", "a Promise", "an Array of 2".
function kindOf(value) {
  if (typeof value === 'string') return `"${value}"`;
  if (typeof value === 'function') return 'a function';
  const name = value?.constructor?.name;
  if (typeof value !== 'object' || !name) return String(value);
  return `${/^[AEIOU]/.test(name) ? 'an' : 'a'} ${name}${value.length === undefined ? '' : ` of ${value.length}`}`;
}
