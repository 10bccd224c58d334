// SPDX-License-Identifier: MIT
// spherechain: where a skinned character penetrates itself. The C++ runtime as WebAssembly.
//
//   const spherechain = await load();
//   const model = spherechain.createModel(bytes, joints);  // a baked character, .sphc; your skeleton's joints
//   const body = model.createBody();                       // all of its memory
//   body.setPose(palette);                                 // each frame: what your skinning shader gets
//   for (const found of body.penetrations()) ...           // part, depth, direction: the faults, the worst first
//
// Lengths are in the source file's units. Positions and directions are in the space of the palette: give world matrices, and
// results are in world space. Numbers of parts, bones and joints are -1 where there is none.
//
// Views and lists. Methods of a Body return typed arrays that look into WebAssembly's memory, and objects that the body fills again.
// Both are overwritten by the next call of the same method, and a view by the next pose or question. In a frame nothing is allocated
// in WebAssembly. A view becomes empty (length 0) when the memory grows: when a model or body is made, or `previous` or ignored parts
// are first given. After dispose() it shows other data. Copy what you keep, and what a worker posts: `array.slice()`,
// `structuredClone(penetrations)`. A spread (`{...penetration}`) is no copy: its arrays are filled again.
//
// A SpherechainError with a sentence is thrown for each refusal. After it the module still works.

/** Compiles the module: once a page, some tens of milliseconds. Every call gives the same object. Needs WebAssembly with SIMD:
 * Chromium 93, Firefox 92, Safari 16.4, Node 18, or newer. */
export function load(): Promise<Spherechain>;

export class SpherechainError extends Error {}

export interface Spherechain {
  /** The library's: "0.1.0". */
  readonly version: string;
  /** All classes, for `Query.classes`. */
  readonly classes: readonly PenetrationClass[];
  readonly defaultRule: Readonly<Rule>;
  /** Copies the bytes of a .sphc file and opens them. It throws if they are no asset, cut short, damaged, or of another format version
   * ("bake it again"). There is no checksum: a changed number may go unseen.
   * With `joints`, palettes come in their order. Each bone of the asset must be there by name. Give inverse bind matrices (for all
   * joints or for none) where you have them: another rest pose, unit or axis convention is then refused. Without `joints`, palettes
   * come in the order of `Model.bones`. */
  createModel(bytes: Uint8Array | ArrayBuffer, joints?: readonly Joint[]): Model;
  /** A state holds what a response remembers of one character's frames before: nothing at first. `fill(0)` forgets it, where the
   * animation cuts or the character is moved elsewhere. A copy (`slice()`) replays the same, bit for bit, on every machine. */
  createResponseState(): Uint32Array;
  /** The class of measurements: those that were found quickly by the rule that they were found with, full ones by any. */
  classify(measures: Measures, rule?: Partial<Rule>): PenetrationClass;
}

export interface Joint {
  /** The source file's. three.js changes some names: give `bone.userData.name ?? bone.name`. */
  name: string;
  /** 16 floats by columns, or 12 by rows. three.js: `skeleton.boneInverses[i].elements`. */
  inverseBind?: ArrayLike<number>;
}

/** The character's own left or right; null: neither. */
export type Side = 'left' | 'right' | null;

/** A baked character and your joints. It never changes. Any number of bodies share it. */
export interface Model {
  /** A joint of the source's skeleton, or of the automatic rig. The name is "" where the file gives none; where no bone moves some
   * vertices, a last bone of that name stands for them, and needs no joint. `inverseBind`: 16 floats by columns. */
  readonly bones: readonly { readonly name: string; readonly inverseBind: Float32Array }[];
  /** Body parts as people call them: "right hand". `bone`: that it follows; `joint`: yours that moves it; `parent`: the part that it hangs
   * on. Where two parts intersect, the one with more `mobility` goes into the other. */
  readonly parts: readonly {
    readonly name: string; readonly side: Side; readonly bone: number; readonly joint: number; readonly parent: number; readonly mobility: number;
  }[];
  /** The spheres at rest, with the radii of the two `Radius`. A torso sphere has a side and a level, from the bottom up; others null and -1. */
  readonly spheres: readonly {
    readonly center: Float32Array; readonly radius: number; readonly detectRadius: number; readonly side: Side; readonly region: number;
    readonly level: number; readonly part: number;
  }[];
  /** Names: what chains run along: "left arm", "torso". */
  readonly regions: readonly string[];
  readonly morphs: readonly string[];
  readonly boneCount: number;
  readonly partCount: number;
  readonly sphereCount: number;
  readonly regionCount: number;
  readonly morphCount: number;
  /** Matrices of a palette. */
  readonly jointCount: number;
  /** The source file's counts. */
  readonly vertexCount: number;
  readonly triangleCount: number;
  /** The character's own axes at rest; unit vectors, left x up = forward. */
  readonly origin: Float32Array;
  readonly left: Float32Array;
  readonly up: Float32Array;
  readonly forward: Float32Array;
  readonly height: number;
  readonly metresPerUnit: number;
  readonly writer: string;
  readonly settings: string;
  readonly sourceFile: string;
  readonly sourceSha256: string;
  /** An index buffer for `Body.vertices()`: three indices for each triangle of the source; three times 0 where the skin leaves it out. */
  readonly triangles: Uint32Array;

  /** Where a triangle of the source belongs; null where the skin leaves it out. */
  triangle(number: number): { part: number; region: number; sphere: number } | null;
  /** A length in the units of a pose that has the asset's scale. */
  millimetres(length: number): number;
  /** For the first run, with the palette of the bind pose: throws, and names a bone, where the matrices do not move all bones alike:
   * wrong strides, missing inverse bind matrices, another rest pose. Stand the character off the origin and turned: where the model's
   * matrix is the identity, a wrong layout does not show. Wrong orders of joints never show in this pose: give `joints`. */
  checkRest(palette: Float32Array): void;
  /** `largestOther`: of all models that the body will meet; none is larger than its own if it is left out. `findsSteps`: for steps(); it
   * needs much memory. `maxTriangles`: room for pairs of triangles; half of the triangles, and at least 4,096, if left out.
   * `maxPenetrations`: 128 if left out. */
  createBody(options?: { largestOther?: Model; findsSteps?: boolean; maxTriangles?: number; maxPenetrations?: number }): Body;
  createIgnoredPairs(): IgnoredPairs;
  /** Frees the memory, of its bodies and ignored pairs too. What is not disposed of stays until the page goes. */
  dispose(): void;
}

/** The pairs of spheres that a question about one body leaves out: the asset's own at first. */
export interface IgnoredPairs {
  /** `isIgnored` false reports the pair, also where the asset ignores it. */
  ignorePair(a: number, b: number, isIgnored?: boolean): void;
  /** Each pair of a sphere of one body part with a sphere of the other; the same part twice: the pairs within it. */
  ignoreParts(part: number, other: number, isIgnored?: boolean): void;
  dispose(): void;
}

/** A model in a pose. Answers are of the last pose. */
export interface Body {
  readonly model: Model;
  /** The new pose; the old one becomes the pose before. `palette`: for each joint the skinning matrix, world matrix times inverse bind
   * matrix: 16 floats each by columns (three.js: Skeleton.boneMatrices; glTF), or 12 each by rows; null with vertices alone. `place`
   * moves it into the world, where other bodies are: scale, rotation (a quaternion, x, y, z, w), translation. `vertices`: the source's
   * deformed ones, x, y, z. All is copied. Throws where a length is wrong, and where a number that moves the skin is not finite: then
   * the body has no pose. */
  setPose(palette: Float32Array | null, options?: {
    morphWeights?: Float32Array; vertices?: Float32Array;
    place?: { translation?: ArrayLike<number>; rotation?: ArrayLike<number>; scale?: ArrayLike<number> };
  }): void;

  /** Which body parts are inside each other, how deep, and which way out: by class, faults first, then the deepest first. */
  penetrations(query?: Query): Results<Penetration>;
  /** The same of two bodies in one space: `part` is of this one. */
  penetrations(other: Body, query?: Query): Results<Penetration>;
  /** Which parts are below a plane, whose points p have up . p = height: `other` is -1. `up`: of unit length; y if left out. */
  below(ground: { up?: ArrayLike<number>; height?: number }, query?: Query): Results<Penetration>;
  /** Which body parts' skins intersect, exactly; with `full` which spheres and triangles, too. Sorted, each once. */
  contacts(query?: Query): Contacts;
  contacts(other: Body, query?: Query): Contacts;
  /** Where the spheres are, and which overlap: a cheap alarm, with false ones. `spheres`: x, y, z, radius each; `pairs`: two indices each. */
  spherePairs(query?: Query): { spheres: Float32Array; pairs: Uint32Array; total: number };
  /** The body parts that touch on the way from the pose before to this one; the body must be made with `findsSteps`. */
  steps(query?: Query): Results<StepContact>;
  steps(other: Body, query?: Query): Results<StepContact>;
  /** A box that holds all of the skin. */
  bounds(): { low: Float32Array; high: Float32Array };
  /** Where the skin is: a view, x, y, z each. The asset merges the source's duplicates at seams: `length / 3` vertices, in an order of their
   * own, of which Model.triangles are. The first call allocates. */
  vertices(): Float32Array;
  /** Collision response: joint rotations in, corrected ones out. It sets the pose of this body, and serves any number of characters of the
   * model in turn. `parents`: of each of your joints, before or after it; -1: none. `mobility`: how easily each joint turns, from 0, never,
   * to 1; arms and hands if left out; at most 16 may turn. `budget`: the most that each is turned, in radians, up to 2; 1.05, 60 degrees, if
   * left out. `hinges`: the axis about which each joint bends, three numbers in its parent's space; zeros: about all alike; elbows' own if
   * left out. `partPairs`: the pairs of body parts that are kept apart; those that a turn can move against each other if left out. */
  createResponse(options: {
    parents: ArrayLike<number>; mobility?: ArrayLike<number>; budget?: ArrayLike<number>; hinges?: ArrayLike<number>; partPairs?: readonly (readonly [number, number])[];
    rule?: Partial<Rule>;
  }): Response;
  /** Frees the memory, of its responses too. Every later call throws. */
  dispose(): void;
}

/** Keeps hands and arms out of the body, of other bodies and of the ground. */
export interface Response {
  readonly body: Body;
  /** One frame. `joints`: where each joint is in its parent's space, as animated, ten floats each: translation, rotation (a quaternion, x, y,
   * z, w), scale. The rotations of those that turn are replaced, and `state` is changed. When it throws, both are as they were. The answer is
   * overwritten by the next call. */
  respond(state: Uint32Array, joints: Float32Array, options: ResponseOptions): Responded;
  /** Frees the memory; its body stays. */
  dispose(): void;
}

export interface ResponseOptions {
  /** Since the last frame; 0 is a pause, in which nothing turns on. */
  seconds: number;
  /** The place of the roots in the world. */
  place?: { translation?: ArrayLike<number>; rotation?: ArrayLike<number>; scale?: ArrayLike<number> };
  morphWeights?: Float32Array;
  /** From 0, the full response, to 1, none: to fade it. */
  weakness?: number;
  /** The most times that contacts are looked for, up to 16; 3 if left out. */
  rounds?: number;
  /** Where the joints will be `aheadFrames` later, from 1 to 3: the response then sets in before the contact. Give both in every frame of a
   * state, or in none. */
  ahead?: Float32Array;
  aheadFrames?: number;
  /** Other characters and props to stay out of, in their poses; at most 8, always in this order. */
  others?: readonly Body[];
  ground?: { up?: ArrayLike<number>; height?: number };
  /** Joints that stay where they are animated, at most 4. Those that turn themselves keep their direction, too. */
  planted?: ArrayLike<number>;
}

export interface Responded {
  /** How many joints were turned; 0: the joints are as they were, bit for bit. */
  turned: number;
  /** How many were not turned as far as wanted. */
  atBudget: number;
  /** The sum of Penetration.faultDepth that is left, as far as it is known. */
  remaining: number;
  /** In the corrected pose. */
  rows: Results<ContactRow>;
}

/** Two spots that are to stay apart: for a solver of your own. If a joint at o turns by the small vector w, the gap grows by
 * w . ((at - o) x normal) if the joint moves `part`, and shrinks by w . ((atOther - o) x normal) if it moves `other`. */
export interface ContactRow {
  part: number;
  /** -1: the ground. */
  other: number;
  /** 0: `other` is a part of the character's own; k: of others[k - 1]. */
  body: number;
  /** On the skin of each, in the world. */
  at: Float32Array;
  atOther: Float32Array;
  /** From `other` to `part`, of unit length. */
  normal: Float32Array;
  /** Their distance along `normal`; negative: so deep. */
  gap: number;
  /** How deep they may be before it is a fault. */
  allowed: number;
}

/** The options of a question. Without any it asks what a game asks; `spherechain play` and `check` look at layers, too. */
export interface Query {
  /** 'apart', if left out: without the folds of neighbouring spheres at elbows and knees, and without layers of one place; 'layers': with these; 'neighbours': the folds alone, 40 times dearer. */
  scope?: 'apart' | 'neighbours' | 'all' | 'layers';
  /** Penetrations that are no faults are measured in full, too. The faults are the same. Contacts list spheres and triangles. */
  full?: boolean;
  ignoredPairs?: IgnoredPairs;
  /** Parts that meet nothing, in questions about two bodies and the ground: a hand that holds the other. */
  ignoredParts?: readonly number[];
  ignoredPartsOfOther?: readonly number[];
  /** The pairs of parts that are asked about, in questions about contacts and penetrations; all if left out. */
  partPairs?: readonly (readonly [number, number])[];
  /** The limits of classes. Those that are left out are the default rule's. */
  rule?: Partial<Rule>;
  /** Which penetrations are listed; none, or left out: faults. */
  classes?: readonly PenetrationClass[];
  /** The worst so many penetrations; 0, or left out: as many as there is room for. */
  limit?: number;
  /** The answer of the frame before: directions of faults then stay steady. A list that was not overwritten yet, or a copy. */
  previous?: readonly Penetration[];
  /** How exact steps() is: a share of the height; 0.0001 if left out. */
  tolerance?: number;
  /** The radius of spherePairs(): 'detect', if left out, is the larger one; 'fit' is the paper's. */
  radius?: 'detect' | 'fit';
}

/** `total` is larger than `length` where there was no room, or the query has a limit. */
export type Results<T> = T[] & { total: number };

/** The class of a contact, in a person's words; docs/concepts.md has the rule. The last three are faults, the last the worst. */
export type PenetrationClass = 'rest' | 'shell' | 'touch' | 'fold' | 'deep_fold' | 'penetration' | 'inside';

/** Two body parts that intersect. */
export interface Penetration {
  /** `part` goes into `other`: the more mobile of the two, a hand into a thigh; of two alike the smaller. Both are the same where a part
   * meets itself. */
  part: number;
  other: number;
  /** Your joint that moves `part`. */
  joint: number;
  kind: PenetrationClass;
  /** Unit length. `part`, moved by distance * direction, no longer intersects `other`. */
  direction: Float32Array;
  /** How much deeper than the rule allows, less where little of it is seen. 0: not deeper. */
  faultDepth: number;
  /** Measures.depth, or while a part goes inside one of two ways out. With `previous`, up to 1.5 times as much where the direction of the last frame is kept. */
  distance: number;
  /** Centre of the line in which the parts cross, and a box around that line. For the ground: a box of the skin below it, and its centre. */
  centre: Float32Array;
  low: Float32Array;
  high: Float32Array;
  /** The points of `part` and `other` that part last: deepestOther - deepest = distance * direction. */
  deepest: SkinPoint;
  deepestOther: SkinPoint;
  measures: Measures;
}

/** A point on the skin, in a triangle of the source; the sum of the weights of its corners is 1. */
export interface SkinPoint { position: Float32Array; triangle: number; weights: Float32Array }

/** The measurements that the class follows from. Null: not known. */
export interface Measures {
  /** > 0: the way out. `depth / metre` is in metres, also where the palette scales the character. */
  depth: number;
  /** Volume of one part inside the other, in cubed units. */
  volume: number | null;
  /** Length of the line in which the parts cross: 0 where a part is wholly inside the other. */
  contourLength: number;
  /** Shares of that line: that can be seen from outside (1 where it was not looked at); that touches at rest. */
  visible: number;
  touching: number;
  /** -1 to 1: 1 where the sides lie flat on each other. */
  facing: number;
  /** Between the two spots at rest, a share of the height; Infinity of two bodies, and where no line crosses. */
  restDistance: number;
  /** Thickness of the thinner part at the contact. */
  thickness: number | null;
  /** depth / thickness * visible length / side of a square like the smaller part. */
  extent: number | null;
  /** The character's height, and a metre, in the palette's units. */
  height: number;
  metre: number;
  /** How the parts hang together: 'joined', one on the other; 'siblings', both on a third; 'near', one on a part that hangs on the other. */
  relation: 'apart' | 'near' | 'siblings' | 'joined' | 'two_bodies';
  /** Whether the two spots are of one piece of skin. */
  isOnePiece: boolean;
  /** 0 to 1: the share of `part` that is inside `other`; 0 where it was not looked at. */
  swallowed: number;
  /** `part` is inside, and comes out again on the other side. */
  through: boolean;
}

/** The limits of a class, as sc_rule in rule.h explains them. */
export type Rule = Record<'version' | 'touchDepth' | 'touchMetres' | 'touchMin' | 'touchMax' | 'touchTimes' | 'extent' | 'atRest' | 'hidden' |
  'shell' | 'fold' | 'neighbours' | 'foldDepth' | 'looseDepth' | 'inside', number>;

export interface Contacts {
  /** partA <= partB of one body; of two, partB is of the other one. Low and high: a box around the triangles that intersect. */
  parts: Results<{ partA: number; partB: number; trianglePairs: number; low: Float32Array; high: Float32Array }>;
  /** A view: two indices of spheres for each pair. */
  spheres: Uint32Array;
  sphereTotal: number;
  /** A view; 12 words for each pair: triangleA, triangleB (the source's numbers), sphereA, sphereB, partA, partB, and six that
   * `segments` shows. */
  triangles: Uint32Array;
  /** The same memory as floats, 12 for each pair: at 6 to 8 and 9 to 11 the ends of the segment in which the two triangles cross. */
  segments: Float32Array;
  triangleTotal: number;
}

/** Two body parts that touch in a step. Times are shares of the step: the first and the last at which they touch. */
export interface StepContact {
  partA: number;
  partB: number;
  atStart: boolean;
  atEnd: boolean;
  begin: number;
  end: number;
  /** The triangles that touch first, and where; -1 and zeros with atStart. */
  triangleA: number;
  triangleB: number;
  at: Float32Array;
}
