// The page's data (see README.md) as the other modules use it. Lengths are in the source's units.

function decode(base64, Type) {
  const text = atob(base64 ?? '');
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return new Type(bytes.buffer);
}

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
      regionName: words(sphere.region),
      level: inTorso ? sphere.level : null,
      side: inTorso ? sphere.side : null,
      triangles: sphere.triangles,
      rest: [...sphere.center, sphere.radius, sphere.detect_radius],
      meanF: data.sphere_f?.[i]?.mean_abs_f ?? null,
      maxF: data.sphere_f?.[i]?.max_abs_f ?? null,
      pivots: data.pivot_triangles?.[i] ?? [],
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

export function readModel(text) {
  const data = JSON.parse(text);
  if (data === null) return null;
  const spheres = readSpheres(data);
  for (const { spheres: chain } of data.inspect.chains) {
    for (let i = 1; i < chain.length; ++i) {
      spheres[chain[i - 1]].neighbours.add(chain[i]);
      spheres[chain[i]].neighbours.add(chain[i - 1]);
    }
  }
  const { mesh, frames } = data;
  const count = frames?.count ?? 0;
  const floats = count > 0 ? (frames.sphere_floats ?? 5) : 5;
  const moved = count > 0 ? decode(frames.spheres, Float32Array) : Float32Array.from(spheres.flatMap((s) => s.rest));
  const kinds = ['fit', 'detect', 'cover'].slice(0, floats - 3);
  return {
    title: data.title,
    motion: data.motion,
    axes: data.frame,
    height: data.frame.height,
    inspect: data.inspect,
    report: data.report,
    validation: data.validation ?? null,
    radius: data.radius,
    regions: data.inspect.regions.map((region) => ({ ...region, label: words(region.name) })),
    spheres,
    sets: readSets(data.inspect, spheres),
    kinds,
    mesh: {
      positions: decode(mesh.positions, Float32Array),
      triangles: decode(mesh.triangles, Uint32Array),
      owner: decode(mesh.owner, Uint16Array),
      influences: mesh.influences ?? 0,
      joints: decode(mesh.joints, Uint16Array),
      weights: decode(mesh.weights, Uint16Array),
    },
    motionData: {
      boneCount: data.bones?.length ?? 0,
      bones: decode(frames?.bones, Float32Array),
      vertices: frames?.vertices ? decode(frames.vertices, Float32Array) : null,
    },
    frameCount: Math.max(count, 1),
    fps: frames?.fps || 30,
    play: frames?.play ?? [],

    // The sphere in a frame: [x, y, z, radius].
    sphere(frame, i, kind) {
      const at = (frame * spheres.length + i) * floats;
      return [moved[at], moved[at + 1], moved[at + 2], moved[at + 3 + kinds.indexOf(kind)]];
    },
    pairs(frame) {
      return this.play[frame]?.pairs ?? [];
    },
    // How deep two spheres are in each other: a length (<= 0: apart), and as the share PD of the sum of their radii.
    depth(frame, a, b, kind) {
      const p = this.sphere(frame, a, kind);
      const q = this.sphere(frame, b, kind);
      const depth = p[3] + q[3] - Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
      return { depth, share: depth / (p[3] + q[3]) };
    },
  };
}
