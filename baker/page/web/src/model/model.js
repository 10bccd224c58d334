import { Contacts, isFault } from './contacts.js';
import { frameNumber } from '../base/format.js';
import { decode, frameLists } from './frame_lists.js';

// The page's data (see ../README.md) as the other modules use it. Lengths are in the source's units.

export const HIDDEN_LAYER = 2; // of `mask`

const words = (name) => name.replaceAll('_', ' ');

// zeta3 -> ζ3, as the paper writes it.
const chainLabel = (name) => name.replace(/^zeta/, 'ζ');

function readSpheres(data) {
  const regionNames = data.inspect.regions.map((region) => region.name);
  return data.inspect.spheres.map((sphere, i) => {
    const inTorso = sphere.side !== 'none';
    const place = inTorso ? ` ${sphere.side === 'left' ? 'L' : 'R'}${sphere.level}` : '';
    return {
      id: sphere.id,
      name: words(sphere.region) + place,
      region: regionNames.indexOf(sphere.region),
      level: inTorso ? sphere.level : null,
      side: inTorso ? sphere.side : null,
      triangles: sphere.triangles,
      rest: [...sphere.center, sphere.radius, sphere.detect_radius],
      meanF: data.spheres?.[i]?.mean_abs_f ?? null,
      maxF: data.spheres?.[i]?.max_abs_f ?? null,
      pivots: data.spheres?.[i]?.pivots ?? [],
      neighbours: new Set(),
    };
  });
}

// Named sets of spheres: chains, and the torso's levels and sides. T and D are the top and bottom level.
function readSets(inspect, spheres) {
  const chains = inspect.chains.map((chain) => ({
    kind: 'chain',
    name: chain.name,
    label: chainLabel(chain.name),
    route: chain.regions.map(words),
    spheres: new Set(chain.spheres),
    order: chain.spheres,
  }));
  const torso = spheres.filter((sphere) => sphere.level !== null);
  const levels = [...new Set(torso.map((sphere) => sphere.level))].sort((a, b) => a - b);
  const set = (kind, label, name, keep) => ({
    kind,
    label,
    name,
    spheres: new Set(torso.filter(keep).map((sphere) => sphere.id)),
  });
  const parts = levels.map((level) => set('level', `${level}`, `Torso level ${level}`, (s) => s.level === level));
  if (levels.length > 0) {
    parts.push(
      set('side', 'L', 'L: left side of the torso', (s) => s.side === 'left'),
      set('side', 'R', 'R: right side of the torso', (s) => s.side === 'right'),
      set('side', 'T', 'T: top level of the torso', (s) => s.level === levels.at(-1)),
      set('side', 'D', 'D: bottom level of the torso', (s) => s.level === levels[0]),
    );
  }
  return [...chains, ...parts];
}

function readMotion({ motion, frames }) {
  const bones = decode(motion?.bones, Float32Array);
  return {
    bones,
    animated: motion?.animated ? decode(motion.animated, Float32Array) : null, // the bones before a response corrected them
    boneCount: frames?.count > 0 ? bones.length / (12 * frames.count) : 0,
    vertices: motion?.vertices ? decode(motion.vertices, Float32Array) : null,
    morphs: (motion?.morphs ?? []).map(({ vertices, deltas, weights }) => ({
      vertices: decode(vertices, Uint32Array),
      deltas: decode(deltas, Float32Array),
      weights: decode(weights, Float32Array),
    })),
    boxes: decode(motion?.boxes, Float32Array),
    centers: decode(motion?.centers, Float32Array),
  };
}

function readRig({ rig, asset, motion }) {
  if (!rig) return null;
  const weights = decode(motion.morph_weights, Float32Array);
  const count = rig.morphs.length;
  return { ...rig, asset: asset ?? null, morphWeights: (frame) => weights.subarray(count * frame, count * (frame + 1)) };
}

// The skin's base colours; null where it has none.
function readLook(look) {
  if (!look) return null;
  const shares = decode(look.uvs?.shares, Uint16Array);
  const { low, high } = look.uvs ?? {};
  return {
    of: decode(look.of, Uint16Array),
    materials: look.materials,
    pictures: look.pictures,
    uvs: Float32Array.from(shares, (share, i) => low[i % 2] + ((high[i % 2] - low[i % 2]) * share) / 65535),
    array: null, // of decodePictures
  };
}

export function readModel(data) {
  const spheres = readSpheres(data);
  for (const { spheres: chain } of data.inspect.chains) {
    for (let i = 1; i < chain.length; ++i) {
      spheres[chain[i - 1]].neighbours.add(chain[i]);
      spheres[chain[i]].neighbours.add(chain[i - 1]);
    }
  }
  const { mesh, frames } = data;
  const count = frames?.count ?? 0;
  const moved = frames?.spheres ? decode(frames.spheres, Float32Array) : Float32Array.from(spheres.flatMap((s) => s.rest));
  const kinds = ['fit', 'detect'];
  const floats = 3 + kinds.length;
  const touching = Object.fromEntries(kinds.map((kind) => [kind, frameLists(frames?.[kind], Uint16Array)]));
  const times = decode(frames?.times, Float32Array);
  const seconds = decode(frames?.seconds, Float32Array);
  const numbers = decode(frames?.numbers, Float32Array);
  const partOf = decode(mesh.parts, Uint8Array);
  const sphereOf = decode(mesh.spheres, Uint16Array);
  const partName = (part) => data.parts[part] ?? 'other parts';
  const colliderPairs = frameLists(frames?.colliders, Uint16Array);
  const contactLists = frameLists(frames?.contacts, Uint32Array);
  const clips = data.clips?.length > 0 ? data.clips : [{ name: 'rest pose', first: 0, count: 1, own_count: 1 }];
  return {
    title: data.title,
    axes: data.axes,
    height: data.axes.height,
    inspect: data.inspect,
    report: data.report,
    validation: data.validation ?? null,
    response: data.response ?? null, // how much it changed: the page shows corrected poses
    radius: data.radius,
    parts: [...new Set(partOf)].sort((a, b) => a - b).map((part) => ({ part, name: partName(part) })),
    regions: data.inspect.regions.map((region) => ({ ...region, label: words(region.name) })),
    spheres,
    sets: readSets(data.inspect, spheres),
    kinds,
    mask: data.mask ?? null, // the page of `mask`: how much skin is hidden
    change: data.change ?? null, // the page shows one character before and after a change: where the latter begins
    mesh: {
      changed: data.change ?? null,
      positions: decode(mesh.positions, Float32Array),
      triangles: decode(mesh.triangles, Uint32Array),
      partOf,
      sphereOf,
      layerOf: data.mask ? decode(data.mask.layers, Uint8Array) : null,
      height: data.axes.height,
      unitsPerMm: 1 / (1000 * (data.inspect.source.metres_per_unit || 1)),
      influences: mesh.influences ?? 0,
      joints: decode(mesh.joints, Uint16Array),
      weights: decode(mesh.weights, Uint16Array),
    },
    look: readLook(data.look),
    motion: readMotion(data),
    rig: readRig(data), // to pose the character by hand; null: none
    edits: data.edits ?? null, // each region's coordinates, and the edits that the bake applied (editor.js)
    colliders: data.colliders ?? null, // a body's bone, and its volumes in the rest pose
    frameCount: Math.max(count, 1),
    hasSpheres: Boolean(frames?.spheres),
    refit: null, // where the page has no spheres of each frame: they follow the skin
    live: null, // in a pose that no frame has: its spheres, and what touches (posing.js)
    hasMethod: data.spheres !== undefined, // the page of `view`: what the paper's method finds
    fps: frames?.fps || 30,
    clips,
    hasPairs: Boolean(frames?.detect),
    pairCount: (kind, frame) => touching[kind].of(frame).length / 2, // spheres that touch
    contacts: new Contacts(contactLists, partOf, partName, frameLists(frames?.penetrations, Float32Array)),

    // Where the page opens: the deepest fault before a change.
    get start() {
      const isBefore = ({ key }) => Number(key.split('-')[0]) < data.change.part;
      return data.change ? (this.contacts.over(0, count).find(isBefore)?.worst ?? 0) : 0;
    },
    // Where before and after a change stand beside each other, seen from an eye to whose right is `aside` (stage.js): the way
    // from one to the other.
    apart({ showing, aside }) {
      if (!data.change || showing !== 'beside') return [0, 0, 0];
      const { left, forward } = data.axes;
      return left.map((x, k) => data.change.distance * (Math.cos(aside) * x + Math.sin(aside) * forward[k]));
    },
    // Parts that are not shown: those that the user hid, and the state before or after a change that is not looked at.
    hiddenParts({ hiddenParts, showing }) {
      if (!data.change || !['before', 'after'].includes(showing)) return hiddenParts;
      const isOther = (part) => part < data.change.part !== (showing === 'before');
      return new Set([...hiddenParts, ...data.parts.keys()].filter((part) => hiddenParts.has(part) || isOther(part)));
    },
    // Contacts that are painted in a frame: before and after a change faults alone, or the one that was gone to and faults that
    // are left.
    painted({ frame, contact, showing, hiddenParts }) {
      const hidden = this.hiddenParts({ hiddenParts, showing });
      const isAsked = ({ key, kind, parts }) => key === contact || (isFault({ kind }) && (contact === null || parts[0] >= data.change.part));
      return this.contacts.now(frame).filter((other) => !other.parts.every((part) => hidden.has(part)) && (!data.change || isAsked(other)));
    },
    clipAt: (frame) => Math.max(clips.findLastIndex(({ first }) => first <= frame), 0),
    time: (frame) => times[frame] ?? frame / (frames?.fps || 30),
    // In its clip: the clip's own number of the frame, and seconds from the clip's start.
    number: (frame) => frameNumber(numbers[frame] ?? frame),
    seconds: (frame) => seconds[frame] ?? 0,
    // The sphere in a frame: [x, y, z, radius].
    sphere(frame, i, kind) {
      const moving = this.live ?? this.refit;
      if (moving) return moving.sphere(i, kind);
      const at = (frame * spheres.length + i) * floats;
      return [moved[at], moved[at + 1], moved[at + 2], moved[at + 3 + kinds.indexOf(kind)]];
    },
    // The bodies whose colliders overlap another's.
    overlappingColliders(frame) {
      return new Set(this.live ? [] : colliderPairs.of(frame));
    },
    // How deep two spheres are in each other: a length (<= 0: apart), and as the share PD of the sum of their radii.
    depth(frame, a, b, kind) {
      const p = this.sphere(frame, a, kind);
      const q = this.sphere(frame, b, kind);
      const depth = p[3] + q[3] - Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
      return { depth, share: depth / (p[3] + q[3]) };
    },
    // Pairs of spheres that touch: [{a, b, depth, isFalse}], the deepest first, false alarms after those whose skin touches.
    spherePairs(frame, kind) {
      const skin = this.live ? this.live.pairs : contactLists.of(frame);
      const real = new Set();
      for (let i = 0; i < skin.length; i += 2) {
        const [p, q] = [sphereOf[skin[i]], sphereOf[skin[i + 1]]];
        real.add(Math.min(p, q) * 65536 + Math.max(p, q));
      }
      const pairs = this.live ? this.live.touching(kind) : touching[kind].of(frame);
      const out = [];
      for (let i = 0; i < pairs.length; i += 2) {
        const [a, b] = [pairs[i], pairs[i + 1]];
        out.push({ a, b, depth: this.depth(frame, a, b, kind).depth, isFalse: !real.has(a * 65536 + b) });
      }
      return out.sort((p, q) => p.isFalse - q.isFalse || q.depth - p.depth || p.a - q.a || p.b - q.b);
    },
  };
}
