// Which triangles of the skin touch in a frame, by pairs of body parts.

// A frame's contacts: [{key, parts, name, pairs, triangles, sides}], the one of most pairs first. `pairs` counts the pairs of
// triangles that intersect, as `play` does. `triangles` are those that touch, each once; `sides` says of each whether it is of
// the first part (1) or the second (2).
function group(pairs, partOf, nameOf) {
  const groups = new Map();
  for (let i = 0; i < pairs.length; i += 2) {
    const ends = [pairs[i], pairs[i + 1]];
    if (partOf[ends[0]] > partOf[ends[1]]) ends.reverse();
    const parts = ends.map((t) => partOf[t]);
    const key = parts.join('-');
    if (!groups.has(key)) groups.set(key, { key, parts, pairs: 0, side: new Map() });
    const { side } = groups.get(key);
    ++groups.get(key).pairs;
    ends.forEach((t, end) => side.has(t) || side.set(t, parts[0] === parts[1] ? 1 : end + 1));
  }
  const name = ([a, b]) => (a === b ? `${nameOf(a)} with itself` : `${nameOf(a)}, ${nameOf(b)}`);
  return [...groups.values()]
    .map(({ key, parts, pairs, side }) => ({ key, parts, name: name(parts), pairs, triangles: [...side.keys()], sides: [...side.values()] }))
    .sort((a, b) => b.pairs - a.pairs || a.name.localeCompare(b.name));
}

export class Contacts {
  constructor(lists, partOf, nameOf) {
    Object.assign(this, { lists, partOf, nameOf, groups: [] });
  }

  of(frame) {
    return (this.groups[frame] ??= group(this.lists.of(frame), this.partOf, this.nameOf));
  }

  // Triangles that touch in a frame.
  count(frame) {
    return this.of(frame).reduce((sum, { triangles }) => sum + triangles.length, 0);
  }

  // Pairs of body parts over a run of frames: [{key, name, frames, worst, most}], longest first. `worst` is the frame of most
  // pairs of triangles.
  over(first, count) {
    const found = new Map();
    for (let frame = first; frame < first + count; ++frame) {
      for (const { key, name, pairs } of this.of(frame)) {
        if (!found.has(key)) found.set(key, { key, name, frames: [], worst: frame, most: 0 });
        const entry = found.get(key);
        entry.frames.push(frame);
        if (pairs > entry.most) Object.assign(entry, { worst: frame, most: pairs });
      }
    }
    return [...found.values()].sort((a, b) => b.frames.length - a.frames.length || b.most - a.most || a.name.localeCompare(b.name));
  }
}
