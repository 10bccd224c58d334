// The spheres of a pose from its skin, where the page has no spheres of each frame: centre and radius follow the pivots as the
// runtime has it (docs/arithmetic.md, refit from vertices).
export class Refit {
  constructor(inspect, mesh, skin) {
    this.skin = skin;
    this.renderOf = new Uint32Array(mesh.positions.length / 3); // a source vertex -> the skin's
    mesh.triangles.forEach((v, corner) => (this.renderOf[v] = skin.index[corner]));
    this.spheres = inspect.spheres.map(({ radius, detect_radius: detect, pivots }) => ({ pivots, fit: radius, detect, spread: 1 }));
    this.spheres.forEach((sphere) => (sphere.spread = spreadOf(sphere.pivots, (v, k) => mesh.positions[3 * v + k]).spread || 1));
  }

  // In the frame that the skin shows: [x, y, z, radius].
  sphere(i, kind) {
    const { pivots, spread: rest, ...radii } = this.spheres[i];
    const { center, spread } = spreadOf(pivots, (v, k) => this.skin.positions[3 * this.renderOf[v] + k]);
    return [...center, (radii[kind] * spread) / rest];
  }
}

// The weighted centre of the pivots' centroids, and the root of their mean squared distance from it.
function spreadOf(pivots, at) {
  const centroids = pivots.map(({ vertices: [a, b, c] }) => [0, 1, 2].map((k) => (at(a, k) + at(b, k) + at(c, k)) / 3));
  const center = [0, 1, 2].map((k) => centroids.reduce((sum, p, i) => sum + pivots[i].weight * p[k], 0));
  const squares = centroids.reduce((sum, p) => sum + p.reduce((own, x, k) => own + (x - center[k]) ** 2, 0), 0);
  return { center, spread: Math.sqrt(squares / pivots.length) };
}
