// Which triangles of the skin touch in a frame, by pairs of body parts.

export const CLASSES = ['as at rest', 'shell', 'touch', 'fold', 'deep fold', 'penetration', 'inside'];
export const MEANINGS = [
  'The same spots are this near in the rest pose, too.',
  'Another layer of the same place (clothes), or hidden inside.',
  'Shallow, or little of the smaller part goes in.',
  'Neighbours of a joint that bends, or spots that lie close at rest.',
  'A joint whose skin is far inside itself. A fault.',
  'One part goes into another. A fault.',
  'Most of one part is inside another, or it goes through it. A fault.',
];
const SHELL = 1;
const HIDDEN = 0.3; // less of the contour is visible
const DEEP_FOLD = 4; // from here on a person sees a fault
const INSIDE = 6;

// The same for both orders of the parts.
export const keyOf = (parts) => [...parts].sort((a, b) => a - b).join('-');

// Measurements of the runtime, by the contact's key; each has so many numbers (../README.md).
function measured(list, width) {
  const out = new Map();
  for (let i = 0; i < list.length; i += width) {
    const [part, other, kind, depth, dx, dy, dz, x, y, z, visible, volume, swallowed, through] = list.slice(i, i + width);
    const parts = [part, other];
    out.set(keyOf(parts), { parts, kind, depth, direction: [dx, dy, dz], at: [x, y, z], visible, volume, swallowed, through: through === 1 });
  }
  return out;
}

// A shell is either clothes or out of sight.
export const isHidden = ({ kind, visible }) => kind === SHELL && visible >= 0 && visible < HIDDEN;
// "goes through, inside 60 %": how much of the first part is in the second.
export const insideText = ({ swallowed, through }) => `${through ? 'goes through, ' : ''}inside${swallowed > 0 ? ` ${Math.round(100 * swallowed)} %` : ''}`;
export const className = (contact) => (isHidden(contact) ? 'hidden' : contact.kind === INSIDE ? insideText(contact) : CLASSES[contact.kind]);
export const isFault = ({ kind }) => kind >= DEEP_FOLD;
export const millimetres = (depth) => `${depth < 9.95 ? depth.toFixed(1) : Math.round(depth)} mm`;
const rank = (contact) => (isFault(contact) ? contact.kind : 0);
const worseFirst = (a, b) => b.kind - a.kind || b.depth - a.depth || a.name.localeCompare(b.name);

// On a page of two, names start with the character's: said once.
function beside(first, second) {
  const own = first.slice(0, first.indexOf(': ') + 2);
  return first.includes(': ') && second.startsWith(own) ? second.slice(own.length) : second;
}

// A frame's contacts: [{key, parts, name, pairs, triangles, sides, kind, depth, direction, at, visible, volume, swallowed,
// through}], the worst class first, then the deepest. The first part goes into the second: moved by `depth` mm along
// `direction`, the first is free; `at` is its deepest point. `pairs` counts the pairs of triangles that intersect, as `play`
// does. `triangles` are those that touch, each once, or all of a part that is wholly inside; `sides` says of each whether it is
// of the first part (1) or the second (2). Parts that nobody measured stand in the order of their numbers.
function group(pairs, partOf, nameOf, measures) {
  const groups = new Map();
  for (let i = 0; i < pairs.length; i += 2) {
    const ends = [pairs[i], pairs[i + 1]];
    if (partOf[ends[0]] > partOf[ends[1]]) ends.reverse();
    const parts = ends.map((t) => partOf[t]);
    const key = keyOf(parts);
    if (!groups.has(key)) groups.set(key, { key, parts, pairs: 0, side: new Map() });
    const { side } = groups.get(key);
    ++groups.get(key).pairs;
    ends.forEach((t, end) => side.has(t) || side.set(t, parts[0] === parts[1] ? 1 : end + 1));
  }
  for (const [key, { parts, kind }] of measures) {
    if (kind !== INSIDE || groups.has(key)) continue;
    const side = new Map();
    partOf.forEach((part, t) => part === parts[0] && side.set(t, 1));
    groups.set(key, { key, parts, pairs: 0, side });
  }
  const name = ([a, b]) => (a === b ? `${nameOf(a)} with itself` : `${nameOf(a)}, ${beside(nameOf(a), nameOf(b))}`);
  const unmeasured = { kind: 0, depth: 0, direction: [0, 0, 0], at: [0, 0, 0], visible: 0, volume: -1, swallowed: 0, through: false };
  return [...groups.values()]
    .map(({ key, parts: byNumber, pairs, side }) => {
      const { parts, ...measure } = measures.get(key) ?? { parts: byNumber, ...unmeasured };
      const sides = [...side.values()];
      return {
        key,
        parts,
        name: name(parts),
        pairs,
        triangles: [...side.keys()],
        sides: parts[0] === byNumber[0] ? sides : sides.map((end) => 3 - end),
        ...measure,
      };
    })
    .sort(worseFirst);
}

export class Contacts {
  constructor(lists, partOf, nameOf, measures) {
    Object.assign(this, { lists, partOf, nameOf, measures, groups: [], live: null });
  }

  // Contacts of a pose that no frame has take the place of the frame's; null: the frame's own again.
  show(found) {
    this.live = found && group(found.pairs, this.partOf, this.nameOf, found.measures);
  }

  // Contacts that are shown in a frame.
  now(frame) {
    return this.live ?? this.of(frame);
  }

  of(frame) {
    return (this.groups[frame] ??= group(this.lists.of(frame), this.partOf, this.nameOf, measured(this.measures.of(frame), this.measures.width)));
  }

  // Triangles that touch in a frame.
  count(frame) {
    return this.of(frame).reduce((sum, { triangles }) => sum + triangles.length, 0);
  }

  // Depth of the deepest fault in a frame that `counts`, mm; 0 where there is none.
  depth(frame, counts = () => true) {
    return this.of(frame).filter(isFault).filter(counts).reduce((most, { depth }) => Math.max(most, depth), 0);
  }

  // Pairs of body parts over a run of frames: [{key, name, frames, worst, kind, depth, visible, swallowed, through}], the
  // worst class first, then the deepest. A pair that is a fault in some frame counts only in the frames in which it is one.
  over(first, count) {
    const found = new Map();
    for (let frame = first; frame < first + count; ++frame) {
      for (const contact of this.of(frame)) {
        const { key, name, kind, depth, visible, swallowed, through } = contact;
        const known = found.get(key);
        if (known && isFault(known) && !isFault(contact)) continue;
        const isFirst = !known || (isFault(contact) && !isFault(known));
        const entry = isFirst ? { key, name, frames: [], kind: 0, depth: -1 } : known;
        entry.frames.push(frame);
        if ((rank(contact) - rank(entry) || depth - entry.depth) > 0) Object.assign(entry, { worst: frame, kind, depth, visible, swallowed, through });
        found.set(key, entry);
      }
    }
    return [...found.values()].sort(worseFirst);
  }
}
