// How far the character has turned about its up axis since the rest pose, in radians: by the skin of its hips, else by all of its
// skin. 0 where the skin does not tell.

const TOLD = 0.1; // the least share of the skin's extent that is left when it is laid on the ground

export function createHeading(model, skin) {
  const { partOf, positions } = model.mesh;
  const { left, forward } = model.axes;
  const hips = model.parts.find(({ name }) => /(^|: )hips$/.test(name))?.part;
  const vertices = [...new Set(skin.index.filter((_, corner) => hips === undefined || partOf[Math.floor(corner / 3)] === hips))];
  const along = (axis, from, v) => axis[0] * from[3 * v] + axis[1] * from[3 * v + 1] + axis[2] * from[3 * v + 2];
  const centred = (list) => {
    const mean = list.reduce((sum, x) => sum + x, 0) / list.length;
    return list.map((x) => x - mean);
  };
  const ground = (from, indices) => [left, forward].map((axis) => centred(indices.map((v) => along(axis, from, v))));
  const [restX, restZ] = ground(positions, vertices.map((v) => skin.source[v]));
  const extent = restX.reduce((sum, x, i) => sum + x * x + restZ[i] * restZ[i], 0);

  return () => {
    const [x, z] = ground(skin.positions, vertices);
    let same = 0;
    let turned = 0;
    for (let i = 0; i < x.length; ++i) {
      same += restX[i] * x[i] + restZ[i] * z[i];
      turned += restZ[i] * x[i] - restX[i] * z[i];
    }
    return Math.hypot(same, turned) > TOLD * extent ? Math.atan2(turned, same) : 0;
  };
}
