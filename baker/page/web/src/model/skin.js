// Morphs and linear blend skinning of the mesh on the CPU, with smooth normals.
//
// Sources split vertices at seams and faces. Here a vertex is what moves alike and belongs to one zone (a sphere's triangles of
// one body part, of one material and layer), so that zones have sharp borders; normals are shared by all that are in one place at rest.

const sameAs = (map, key) => {
  let id = map.get(key);
  if (id === undefined) map.set(key, (id = map.size));
  return id;
};

export class Skin {
  constructor(mesh, motion, look = null) {
    this.mesh = mesh;
    this.motion = motion;
    this.frame = -1;
    const { positions, triangles, partOf, sphereOf, layerOf, influences, joints, weights } = mesh;
    this.apart = [0, 0, 0]; // from before to after a change
    const isBefore = (triangle) => mesh.changed !== null && triangle < mesh.changed.triangle;
    const before = []; // of each vertex
    const ownPath = new Uint8Array(positions.length / 3).fill(motion.vertices ? 1 : 0);
    for (const { vertices } of motion.morphs) for (const v of vertices) ownPath[v] = 1;
    const places = new Map();
    const movers = new Map();
    const zones = new Map();
    const vertices = new Map();
    const source = [];
    const place = [];
    const zone = [];
    const placeOf = new Int32Array(positions.length / 3).fill(-1);
    const moverOf = new Int32Array(placeOf.length);
    this.index = new Uint32Array(triangles.length);
    for (let corner = 0; corner < triangles.length; ++corner) {
      const v = triangles[corner];
      if (placeOf[v] < 0) {
        const who = isBefore(Math.floor(corner / 3)) ? 'before ' : '';
        placeOf[v] = sameAs(places, `${who}${positions[3 * v]},${positions[3 * v + 1]},${positions[3 * v + 2]}`);
        const from = influences * v;
        const to = from + influences;
        const skin = influences > 0 ? `${joints.subarray(from, to)};${weights.subarray(from, to)}` : '';
        const uv = look?.uvs.length > 0 ? `;${look.uvs[2 * v]},${look.uvs[2 * v + 1]}` : '';
        moverOf[v] = sameAs(movers, ownPath[v] ? v : `${placeOf[v]};${skin}${uv}`);
      }
      const triangle = Math.floor(corner / 3);
      const layer = layerOf?.[triangle] ?? 0;
      const z = sameAs(zones, ((layer * 65536 + sphereOf[triangle]) * 256 + partOf[triangle]) * 65536 + (look?.of[triangle] ?? 0));
      const r = sameAs(vertices, moverOf[v] * 65536 + z);
      if (r === source.length) {
        source.push(v);
        place.push(placeOf[v]);
        zone.push(z);
        before.push(isBefore(triangle) ? 1 : 0);
      }
      this.index[corner] = r;
    }
    this.source = Uint32Array.from(source);
    this.place = Uint32Array.from(place);
    this.zone = Float32Array.from(zone);
    this.before = Uint8Array.from(before);
    this.zones = [...zones.keys()].map((key, z) => ({
      isBefore: before[zone.indexOf(z)] === 1,
      layer: Math.floor(key / 2 ** 40),
      sphere: Math.floor(key / 2 ** 24) % 65536,
      part: Math.floor(key / 65536) % 256,
      material: look?.materials[key % 65536] ?? null,
    }));
    this.changedTo = mesh.changed && this.findChanged();
    this.positions = new Float32Array(3 * source.length);
    this.normals = new Float32Array(3 * source.length);
    this.placeNormals = new Float32Array(3 * places.size);
    this.morphed = motion.morphs.length > 0 ? Float32Array.from(positions) : positions;
  }

  // For each vertex before a change: the same vertex after it. -1: the vertex belongs to the state after.
  findChanged() {
    const count = this.mesh.positions.length / 6;
    const after = new Map();
    this.source.forEach((v, r) => v >= count && after.set(v - count, r));
    return Int32Array.from(this.source, (v) => (v < count ? (after.get(v) ?? -1) : -1));
  }

  // How far a change has moved the vertex whose place begins at `i`; 0 where it is one after.
  moved(i) {
    const p = this.positions;
    const j = 3 * this.changedTo[i / 3];
    return j < 0 ? 0 : Math.hypot(p[i] - p[j], p[i + 1] - p[j + 1], p[i + 2] - p[j + 2]);
  }

  // Moves before and after a change apart by `step`, half of it each. They lie over each other where it is 0.
  moveApart(step) {
    if (step.every((x, k) => x === this.apart[k])) return;
    this.apart = step;
    this.frame = -1;
  }

  // How far that moves a triangle.
  shiftOf(t) {
    if (!this.mesh.changed) return [0, 0, 0];
    return this.apart.map((x) => (t < this.mesh.changed.triangle ? -x : x) / 2);
  }

  shift() {
    const { before, positions } = this;
    const step = this.shiftOf(0);
    for (let r = 0; r < before.length; ++r) {
      for (let k = 0; k < 3; ++k) positions[3 * r + k] += before[r] ? step[k] : -step[k];
    }
  }

  // Positions and normals of a frame; true where they changed.
  pose(frame) {
    const { vertices, bones, boneCount, morphs } = this.motion;
    const blends = this.mesh.influences > 0 && bones.length > 0;
    const moves = vertices !== null || blends || morphs.length > 0;
    if (this.frame === frame || (this.frame >= 0 && !moves)) return false;
    this.frame = frame;
    if (vertices) {
      this.take(vertices.subarray(frame * this.mesh.positions.length));
    } else {
      this.morph(frame);
      if (blends) this.blend(bones.subarray(frame * 12 * boneCount));
      else this.take(this.morphed);
    }
    if (this.apart.some((x) => x !== 0)) this.shift();
    this.computeNormals();
    return true;
  }

  morph(frame) {
    if (this.motion.morphs.length > 0) this.morphed.set(this.mesh.positions);
    for (const { vertices, deltas, weights } of this.motion.morphs) {
      const w = weights[frame];
      if (w === 0) continue;
      vertices.forEach((v, i) => {
        for (let k = 0; k < 3; ++k) this.morphed[3 * v + k] += w * deltas[3 * i + k];
      });
    }
  }

  take(from) {
    const { source, positions } = this;
    for (let r = 0; r < source.length; ++r) {
      for (let k = 0; k < 3; ++k) positions[3 * r + k] = from[3 * source[r] + k];
    }
  }

  // v' = v + sum of w (M v - v); a bone's M is twelve floats, rows first.
  blend(bones) {
    const { source, positions, morphed: rest } = this;
    const { influences, joints, weights } = this.mesh;
    for (let r = 0; r < source.length; ++r) {
      const v = source[r];
      const x = rest[3 * v];
      const y = rest[3 * v + 1];
      const z = rest[3 * v + 2];
      let dx = 0;
      let dy = 0;
      let dz = 0;
      for (let k = influences * v; k < influences * (v + 1); ++k) {
        const w = weights[k] / 65535;
        if (w === 0) continue;
        const m = 12 * joints[k];
        dx += w * (bones[m] * x + bones[m + 1] * y + bones[m + 2] * z + bones[m + 3] - x);
        dy += w * (bones[m + 4] * x + bones[m + 5] * y + bones[m + 6] * z + bones[m + 7] - y);
        dz += w * (bones[m + 8] * x + bones[m + 9] * y + bones[m + 10] * z + bones[m + 11] - z);
      }
      positions[3 * r] = x + dx;
      positions[3 * r + 1] = y + dy;
      positions[3 * r + 2] = z + dz;
    }
  }

  // A place's normal is the sum of its triangles' normals, by area.
  computeNormals() {
    const { index, positions: p, place, normals, placeNormals: sums } = this;
    sums.fill(0);
    for (let t = 0; t < index.length; t += 3) {
      const a = 3 * index[t];
      const b = 3 * index[t + 1];
      const c = 3 * index[t + 2];
      const ux = p[b] - p[a];
      const uy = p[b + 1] - p[a + 1];
      const uz = p[b + 2] - p[a + 2];
      const vx = p[c] - p[a];
      const vy = p[c + 1] - p[a + 1];
      const vz = p[c + 2] - p[a + 2];
      const nx = uy * vz - uz * vy;
      const ny = uz * vx - ux * vz;
      const nz = ux * vy - uy * vx;
      for (let k = t; k < t + 3; ++k) {
        const s = 3 * place[index[k]];
        sums[s] += nx;
        sums[s + 1] += ny;
        sums[s + 2] += nz;
      }
    }
    for (let r = 0; r < place.length; ++r) {
      const s = 3 * place[r];
      const scale = 1 / (Math.hypot(sums[s], sums[s + 1], sums[s + 2]) || 1);
      for (let k = 0; k < 3; ++k) normals[3 * r + k] = sums[s + k] * scale;
    }
  }

  // A triangle's centroid and corners as posed.
  triangle(t) {
    const corners = [0, 1, 2].map((k) => {
      const r = 3 * this.index[3 * t + k];
      return [this.positions[r], this.positions[r + 1], this.positions[r + 2]];
    });
    return { corners, center: [0, 1, 2].map((k) => (corners[0][k] + corners[1][k] + corners[2][k]) / 3) };
  }

  // A ball around some triangles as posed: [x, y, z, radius].
  ballOf(triangles) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const t of triangles) {
      for (const corner of this.triangle(t).corners) {
        corner.forEach((x, k) => {
          low[k] = Math.min(low[k], x);
          high[k] = Math.max(high[k], x);
        });
      }
    }
    return [...low.map((x, k) => (x + high[k]) / 2), Math.hypot(...low.map((x, k) => high[k] - x)) / 2];
  }

  // 1 where triangles turn counter-clockwise to who looks from outside, else -1: the sign of the volume.
  winding() {
    const { index, positions: p } = this;
    let volume = 0;
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
      volume +=
        p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]) +
        p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]) +
        p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
    }
    return volume < 0 ? -1 : 1;
  }
}
