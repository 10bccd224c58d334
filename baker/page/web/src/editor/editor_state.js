// Edits of a person: spheres that move, grow, come and go, and ignored pairs of body parts; as a file of edits
// (docs/formats.md#edits). States are immutable: each edit makes a new one, so undo goes back to an earlier state.
//
// A sphere is {id, region, origin, to, deleted}. `origin` is its place where nobody edits it (null: it was added), `to` its own
// place (null: as in `origin`). Places are in the region's coordinates, in parts of its length.

const NEAR = 1e-3; // of a region's length: a sphere of the asset and the place that an edit gave it are the same
const DIGITS = 7;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const rounded = (x) => Number(x.toPrecision(DIGITS));

export const placeOf = ({ start, axes, length }, center, radius, detect) => {
  const from = center.map((x, k) => x - start[k]);
  const [along, ...across] = axes.map((axis) => rounded(dot(from, axis) / length));
  return { along, across, radius: rounded(radius / length), detect_radius: rounded(Math.max(detect, radius) / length) };
};

// [x, y, z] in source units.
export const pointOf = ({ start, axes, length }, { along, across }) =>
  start.map((x, k) => x + length * (along * axes[0][k] + across[0] * axes[1][k] + across[1] * axes[2][k]));

export const distance = (a, b) => Math.hypot(a.along - b.along, a.across[0] - b.across[0], a.across[1] - b.across[1]);

// The page's data: `regions` with their axes; `baked`, the file that the asset was baked with, or null. `spheres` are the asset's.
export function startState({ regions, baked }, names, spheres) {
  const file = baked ?? { spheres: [], ignored_parts: [] };
  const out = spheres.map(({ id, region, rest: [x, y, z, radius, detect] }) => ({
    id,
    region,
    origin: placeOf(regions[region], [x, y, z], radius, detect),
    to: null,
    deleted: false,
  }));
  const missed = []; // edits that the bake could not apply
  for (const edit of file.spheres ?? []) {
    const region = names.indexOf(edit.region);
    const place = edit.to;
    const found = place ? out.find((s) => s.region === region && s.to === null && distance(s.origin, place) < NEAR) : null;
    const isAgain = edit.from && !place && region >= 0 && !out.some((s) => s.region === region && distance(s.origin, edit.from) < NEAR);
    if (found) Object.assign(found, { origin: edit.from ?? null, to: place });
    else if (isAgain) out.push({ id: out.length, region, origin: edit.from, to: null, deleted: true });
    else missed.push(edit);
  }
  return { spheres: out, ignored: (file.ignored_parts ?? []).map((pair) => [...pair]), missed };
}

// Where a sphere is now.
export const placeNow = ({ origin, to }) => to ?? origin;
export const isEdited = ({ origin, to, deleted }) => deleted ? origin !== null : to !== null;
export const kindOf = ({ origin, deleted }) => (deleted ? 'deleted' : origin === null ? 'added' : 'changed');

const replaced = (state, id, patch) => ({ ...state, spheres: state.spheres.map((s) => (s.id === id ? { ...s, ...patch } : s)) });
export const place = (state, id, to) => replaced(state, id, { to, deleted: false });
export const remove = (state, id) => replaced(state, id, { deleted: true });
// As if nobody had edited it.
export const restore = (state, id) => {
  const sphere = state.spheres.find((s) => s.id === id);
  return replaced(state, id, sphere.origin === null ? { deleted: true } : { to: null, deleted: false });
};
// A copy of a sphere, beside it along the region.
export function addBeside(state, id) {
  const beside = state.spheres.find((s) => s.id === id);
  const now = placeNow(beside);
  const along = rounded(now.along + (now.along < 0.5 ? 1 : -1) * now.radius);
  const added = { id: state.spheres.length, region: beside.region, origin: null, to: { ...now, along }, deleted: false };
  return { ...state, spheres: [...state.spheres, added] };
}
// A region keeps its last sphere.
export const mayRemove = (state, id) => {
  const { region } = state.spheres.find((s) => s.id === id);
  return state.spheres.filter((s) => s.region === region && !s.deleted).length > 1;
};

const isPair = ([a, b]) => ([p, q]) => (a === p && b === q) || (a === q && b === p);
export const isIgnored = (state, pair) => state.ignored.some(isPair(pair));
export const ignore = (state, pair) => (isIgnored(state, pair) ? state : { ...state, ignored: [...state.ignored, pair] });
export const unignore = (state, pair) => ({ ...state, ignored: state.ignored.filter((other) => !isPair(pair)(other)) });
export const forget = (state, edit) => ({ ...state, missed: state.missed.filter((other) => other !== edit) });

export function fileOf(state, names) {
  const spheres = state.spheres.filter(isEdited).map(({ region, origin, to, deleted }) => ({
    region: names[region],
    ...(origin ? { from: origin } : {}),
    ...(deleted ? {} : { to }),
  }));
  return { spherechain_edits: 1, spheres: [...spheres, ...state.missed], ignored_parts: state.ignored };
}
