// SPDX-License-Identifier: MIT
// spherechain: where a skinned character penetrates itself. The C++ runtime as WebAssembly.
//
//   const spherechain = await load();
//   const asset = spherechain.open(bytes);             // a baked character, .sphc
//   const character = asset.createCharacter(joints);   // joints: your skeleton's; allocates here
//   character.setPalette(palette);                     // each frame: what your skinning shader gets
//   for (const found of character.penetrations()) ...  // part names, depth, direction
//
// Lengths are in the source file's units; multiply by `metresPerUnit` for metres. Positions and directions are in the
// space of the palette: give world matrices and results are in world space.
//
// Views and lists. Methods of a Character return typed arrays that look into WebAssembly's memory, and arrays of objects
// that it owns. Both are overwritten by the next call of the same method, whatever the pose, and nothing is allocated
// for them in a frame. A typed array becomes empty (length 0) when the memory grows: when an asset is opened, a
// character is made, or a frame has more contacts than any frame before. After dispose() it shows whatever comes to lie
// there. So take views and lists anew each frame, and copy what you keep, and what a worker posts: `array.slice()`,
// `structuredClone(penetrations)`. A spread (`{...penetration}`) is no copy: its arrays would still be filled again.
//
// Errors are thrown as SpherechainError with the runtime's sentence. Whatever the bytes of an asset and the numbers of a
// palette are, nothing worse happens.

/** Compiles the module: once a page, some tens of milliseconds. Every call gives the same object. Needs WebAssembly with SIMD:
 * Chromium 93, Firefox 92, Safari 16.4, Node 18, or newer. */
export function load(): Promise<Spherechain>;

export interface Spherechain {
  /** Of the library: "0.1.0". */
  readonly version: string;
  /** Copies the bytes of a .sphc file and opens them. Throws if they are no asset, cut short, structurally damaged, or of
   * another format version ("bake it again"). There is no checksum: a changed number may go unseen. */
  open(bytes: Uint8Array | ArrayBuffer): Asset;
}

/** What was refused, and why, in its message. */
export class SpherechainError extends Error {}

/** The character's own left or right; null: neither. */
export type Side = 'left' | 'right' | null;

/** A bone that moves the skin: a joint of the source's skeleton, or of the automatic rig. */
export interface Bone {
  /** The joint's, as the source file has it; "" where the file gives none. Where no bone moves some vertices, a last bone
   * stands for them. Its name is "" too, and it needs no joint. */
  readonly name: string;
  /** From the rest pose to the bone's space: 16 floats by columns, as in glTF and three.js. */
  readonly inverseBind: Float32Array;
}

/** A body part as people call it: "right hand". Every triangle belongs to one. */
export interface Part {
  readonly name: string;
  readonly side: Side;
  /** The bone that it follows; -1 where no bone moves it. */
  readonly bone: number;
  /** The part that it hangs on; -1: none. */
  readonly parent: number;
}

/** A sphere in the rest pose. */
export interface RestSphere {
  readonly center: readonly [number, number, number];
  /** The fit radius, and the detect radius, at which spheres are tested. */
  readonly radius: number;
  readonly detectRadius: number;
  /** Of a torso sphere: the half that it stands for. */
  readonly side: Side;
  /** Index into `regions`. */
  readonly region: number;
  /** Of a torso sphere: its height, from the bottom up; else -1. */
  readonly level: number;
}

/** A baked character. Any number of Characters may share it. */
export interface Asset {
  readonly bones: readonly Bone[];
  readonly parts: readonly Part[];
  readonly spheres: readonly RestSphere[];
  /** Names: what chains run along: "left arm", "torso". */
  readonly regions: readonly string[];
  readonly morphs: readonly string[];
  /** The character's own axes at rest; unit vectors, left x up = forward. */
  readonly origin: readonly [number, number, number];
  readonly left: readonly [number, number, number];
  readonly up: readonly [number, number, number];
  readonly forward: readonly [number, number, number];
  /** In the source's units. */
  readonly height: number;
  readonly metresPerUnit: number;
  /** Of the source. Character.vertices() may be fewer. */
  readonly vertexCount: number;
  readonly triangleCount: number;
  readonly sourceFile: string;
  /** Of the skin that is tested, three indices into Character.vertices() for each triangle of the source, in its order: an
   * index buffer. A triangle that the asset leaves out has three times 0. Empty where the asset has no triangles. */
  readonly triangles: Uint32Array;

  /** Working memory for one character at a time. With `joints`, palettes come in the order of these; each bone of the
   * asset must be there by name, as the source file has it. Give inverse bind matrices (16 floats by columns, or 12 by
   * rows; for all joints or for none) where you have them: another rest pose, unit or axis convention is then refused.
   * Without `joints`, palettes come in the order of `bones`. */
  createCharacter(joints?: readonly Joint[]): Character;

  /** Frees the memory, of its characters too. What is not disposed of stays until the page goes. */
  dispose(): void;
}

export interface Joint {
  /** The source file's. three.js changes some names: give `bone.userData.name ?? bone.name`. */
  name: string;
  /** three.js: `skeleton.boneInverses[i].elements`. */
  inverseBind?: ArrayLike<number>;
}

/** 'detect' (the larger: spheres are tested at it) or 'fit' (the paper's). */
export type Radius = 'detect' | 'fit';

/** 'apart': without the folds of neighbouring spheres at elbows and knees; 'neighbours': these alone; 'all'. */
export type Scope = 'apart' | 'neighbours' | 'all';

/** What a person would call it; docs/concepts.md has the rules. 'penetration' and 'deep_fold' are faults. */
export type Kind = 'rest' | 'shell' | 'touch' | 'fold' | 'deep_fold' | 'penetration';

/** Two body parts whose skins intersect. */
export interface PartContact {
  /** Indices into Asset.parts, partA <= partB; equal where a part meets itself. */
  partA: number;
  partB: number;
  trianglePairs: number;
  /** A box around the triangles that intersect. */
  low: Float32Array;
  high: Float32Array;
}

/** Pairs of triangles that intersect. */
export interface TriangleContacts {
  count: number;
  /** A view; 12 words for each pair: triangleA, triangleB (the source's numbers, A < B), sphereA, sphereB, partA, partB, and
   * six that `segments` shows. */
  pairs: Uint32Array;
  /** A view of the same memory as floats, 12 for each pair: at 6 to 8 and 9 to 11 the ends of the segment in which the two
   * triangles cross. */
  segments: Float32Array;
}

/** A point on the skin. */
export interface SkinPoint {
  position: Float32Array;
  /** The source's number. */
  triangle: number;
  /** Of the triangle's corners; their sum is 1. */
  weights: Float32Array;
}

/** Two body parts that intersect, and how deep. The kind follows from the measurements: `depth`, and those from `visible` on. */
export interface Penetration {
  /** Indices into Asset.parts: `part` goes into `other`. It is the more mobile of the two, a hand in a thigh; of two alike
   * the smaller. Both are the same where a part meets itself. */
  part: number;
  other: number;
  /** Index into Asset.bones of the bone that moves `part`; -1 where none does. */
  bone: number;
  kind: Kind;
  /** > 0, in the palette's units: the shortest way out. `depth / metre` is in metres. */
  depth: number;
  /** Moved so far along `direction`, `part` no longer intersects `other`: `depth`, or up to a quarter more where the last
   * call's direction is kept. */
  distance: number;
  /** x, y, z; unit length. It moves `part`. */
  direction: Float32Array;
  /** Of the line in which the parts cross. */
  centre: Float32Array;
  /** A box around that line. */
  low: Float32Array;
  high: Float32Array;
  /** The points of `part` and `other` that part last: deepestOther - deepest = distance * direction. */
  deepest: SkinPoint;
  deepestOther: SkinPoint;
  /** Of the one part inside the other, in cubed units. Null where the line in which the parts cross does not close, and if
   * quick. */
  volume: number | null;
  /** Of the line in which the parts cross. */
  contourLength: number;
  /** 0 to 1: the share of that line that can be seen from outside; 1 where it was not looked at. */
  visible: number;
  /** 0 to 1: the share of that line that touches at rest. */
  touching: number;
  /** -1 to 1: 1 where the sides lie flat on each other. */
  facing: number;
  /** Between the two spots at rest, a share of the height; Infinity where they are of two characters. */
  restDistance: number;
  /** Of the thinner part, there; null where it is not known. */
  thickness: number | null;
  /** depth / thickness * visible length / side of a square like the smaller part; null where it is not known, because the kind
   * does not depend on it. */
  swallowed: number | null;
  /** How long the character's height and a metre are in the palette's units: `depth / metre` is the depth in metres. */
  height: number;
  metre: number;
  /** How the two parts hang together: 'joined', one hangs on the other; 'siblings', both hang on the same third part; 'near',
   * one hangs on a part that hangs on the other. */
  relation: 'apart' | 'near' | 'siblings' | 'joined' | 'two_bodies';
  /** Whether the two spots are of one piece of skin. */
  isOnePiece: boolean;
}

/** One character in a pose. All answers are of the palette that was set last; they are worked out when asked for. */
export interface Character {
  readonly asset: Asset;
  /** Joints, or bones, a palette has. */
  readonly jointCount: number;

  /** Takes a frame's palette: for each joint the skinning matrix, world matrix times inverse bind matrix. 16 floats each by
   * columns (three.js: Skeleton.boneMatrices; glTF), or 12 each by rows. The values are copied. `morphWeights`: as many as
   * Asset.morphs; none: nothing morphs. Throws where the length is neither, and where a number that moves the skin is not
   * finite: then no palette is set. */
  setPalette(palette: Float32Array, morphWeights?: Float32Array): void;

  /** For the first run, while the character stands in its bind pose: throws, and names a bone, where the palette does not
   * move all bones alike: wrong strides, missing inverse bind matrices, another rest pose. Stand the character off the
   * origin and turned: where the model's matrix is the identity, a wrong layout does not show. Wrong orders of joints never
   * show in this pose: give `joints` by name. */
  checkRest(): void;

  /** Where the spheres are: a view, 4 floats for each of Asset.spheres: x, y, z, radius. */
  refit(radius?: Radius): Float32Array;

  /** Which spheres touch: a view, two indices for each pair, sorted. Refits first. A cheap alarm with false ones; contacts()
   * is exact. */
  detect(radius?: Radius): Uint32Array;

  /** The pairs of body parts whose skins intersect, exactly, sorted. Folds cost forty times as much as the rest. */
  contacts(scope?: Scope): PartContact[];

  /** Which triangles: after contacts() of this pose, whose answer it details; else it asks contacts('apart') first. */
  triangleContacts(): TriangleContacts;

  /** How deep, which way out, and what kind, for what contacts() found; asks contacts('apart') first where it was not
   * asked. `quick` (the default, for games): one direction is tried, without volume and visibility; likely faults alone are
   * measured in full. With false, all is measured in full, which takes longer, and a fault's direction stays from call to
   * call while it is about as good as the shortest. Both find the same faults. */
  penetrations(quick?: boolean): Penetration[];

  /** The pairs of body parts where this skin intersects another character's: partA is of this one, partB of `other`; nothing
   * is swapped or left out. Both need a palette, in one space. */
  contactsWith(other: Character): PartContact[];

  /** How deep, which way out, and what kind, for what contactsWith() finds: `part` is of this one, Penetration.other of `other`.
   * Kinds are 'shell', 'touch' and 'penetration'; they compare with this asset's height and unit. `quick`: as of
   * penetrations(). */
  penetrationsWith(other: Character, quick?: boolean): Penetration[];

  /** Where the skin's vertices are in this pose: a view, x, y, z each. They are numbered by the asset, which merges the source's
   * duplicates at seams: their count is `length / 3`. Asset.triangles has their triangles. */
  vertices(): Float32Array;

  /** Frees the memory. Every later call throws. */
  dispose(): void;
}
