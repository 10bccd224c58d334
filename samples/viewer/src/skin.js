// Linear blend skinning of the mesh on the CPU, with smooth normals.
//
// Sources split vertices at seams and faces. Here a vertex is what moves alike and belongs to one surrounding region, so that
// regions have sharp borders; normals are shared by all that are in one place at rest.

const sameAs = (map, key) => {
  let id = map.get(key);
  if (id === undefined) map.set(key, (id = map.size));
  return id;
};

export class Skin {
  constructor(mesh, motion) {
    this.mesh = mesh;
    this.motion = motion;
    this.frame = -1;
    const { positions, triangles, owner, influences, joints, weights } = mesh;
    const places = new Map();
    const movers = new Map();
    const vertices = new Map();
    const source = [];
    const place = [];
    const owners = [];
    const placeOf = new Int32Array(positions.length / 3).fill(-1);
    const moverOf = new Int32Array(placeOf.length);
    this.index = new Uint32Array(triangles.length);
    for (let corner = 0; corner < triangles.length; ++corner) {
      const v = triangles[corner];
      if (placeOf[v] < 0) {
        placeOf[v] = sameAs(places, `${positions[3 * v]},${positions[3 * v + 1]},${positions[3 * v + 2]}`);
        const from = influences * v;
        const to = from + influences;
        const skin = influences > 0 ? `${joints.subarray(from, to)};${weights.subarray(from, to)}` : '';
        moverOf[v] = sameAs(movers, motion.vertices ? v : `${placeOf[v]};${skin}`);
      }
      const sphere = owner[Math.floor(corner / 3)];
      const r = sameAs(vertices, moverOf[v] * 65536 + sphere);
      if (r === source.length) {
        source.push(v);
        place.push(placeOf[v]);
        owners.push(sphere);
      }
      this.index[corner] = r;
    }
    this.source = Uint32Array.from(source);
    this.place = Uint32Array.from(place);
    this.owner = Uint16Array.from(owners);
    this.positions = new Float32Array(3 * source.length);
    this.normals = new Float32Array(3 * source.length);
    this.placeNormals = new Float32Array(3 * places.size);
  }

  // Positions and normals of a frame; true where they changed.
  pose(frame) {
    const moves = this.motion.vertices !== null || (this.mesh.influences > 0 && this.motion.bones.length > 0);
    if (this.frame === frame || (this.frame >= 0 && !moves)) return false;
    this.frame = frame;
    if (this.motion.vertices) this.take(this.motion.vertices.subarray(frame * this.mesh.positions.length));
    else if (moves) this.blend(this.motion.bones.subarray(frame * 12 * this.motion.boneCount));
    else this.take(this.mesh.positions);
    this.computeNormals();
    return true;
  }

  take(from) {
    const { source, positions } = this;
    for (let r = 0; r < source.length; ++r) {
      for (let k = 0; k < 3; ++k) positions[3 * r + k] = from[3 * source[r] + k];
    }
  }

  // v' = v + sum of w (M v - v); a bone's M is twelve floats, rows first.
  blend(bones) {
    const { source, positions } = this;
    const { influences, joints, weights, positions: rest } = this.mesh;
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
}
