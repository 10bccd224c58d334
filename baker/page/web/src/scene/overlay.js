import { chainColour, CONTACT, FALSE_ALARM, POINTED } from '../base/palette.js';
import { css, fitCanvas } from '../base/dom.js';

// Two-dimensional drawing over the view: chains, pivots, numbers. A name that would cover another is left out.

const LANE = 4; // pixels between chains that share spheres

// Which side of a segment is its lane's: the same for both directions, and for all chains. Turns over where few limbs point.
function laneNormal(p, q) {
  const length = Math.hypot(q.x - p.x, q.y - p.y) || 1;
  const n = { x: (p.y - q.y) / length, y: (q.x - p.x) / length };
  return n.x * 0.92 - n.y * 0.38 < 0 ? { x: -n.x, y: -n.y } : n;
}

// A polyline's points moved sideways by `offset` pixels.
function inLane(points, offset) {
  return points.map((p, i) => {
    const q = points[Math.min(i + 1, points.length - 1)];
    const n = laneNormal(points[Math.max(i - 1, 0)], q);
    return { x: p.x + n.x * offset, y: p.y + n.y * offset };
  });
}

export class Names {
  constructor(context, width, height, font) {
    Object.assign(this, { context, width, height, font, taken: [] });
  }

  // False where there is no room.
  add(text, x, y, { ink, paper, bold = false }) {
    const { context } = this;
    context.font = `${bold ? 600 : 500} 11px ${this.font}`;
    const w = context.measureText(text).width + 8;
    const box = { left: x - w / 2, top: y - 8, right: x + w / 2, bottom: y + 8 };
    if (box.left < 0 || box.top < 0 || box.right > this.width || box.bottom > this.height) return false;
    const hit = (b) => box.left < b.right && b.left < box.right && box.top < b.bottom && b.top < box.bottom;
    if (this.taken.some(hit)) return false;
    this.taken.push(box);
    context.fillStyle = paper;
    context.beginPath();
    context.roundRect(box.left, box.top, w, 16, 4);
    context.fill();
    context.fillStyle = ink;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(text, x, y + 0.5);
    return true;
  }
}

function drawChains(context, chains, halo) {
  context.lineJoin = 'round';
  context.lineCap = 'round';
  for (const [width, colour] of [[5, () => halo], [2.5, (chain) => chain.colour]]) {
    context.lineWidth = width;
    for (const chain of chains) {
      context.strokeStyle = colour(chain);
      context.beginPath();
      for (const p of chain.points) context.lineTo(p.x, p.y);
      context.stroke();
    }
  }
}

// A chain's name is past both its ends; names of chains with a common end queue up there.
function nameChains(names, chains) {
  for (const { label, colour, points } of chains) {
    if (points.length < 2) continue;
    for (const [end, next] of [[points[0], points[1]], [points.at(-1), points.at(-2)]]) {
      const length = Math.hypot(end.x - next.x, end.y - next.y) || 1;
      const past = (pixels) => [end.x + ((end.x - next.x) / length) * pixels, end.y + ((end.y - next.y) / length) * pixels];
      [22, 40, 58].some((pixels) => names.add(label, ...past(pixels), { ink: '#fff', paper: colour, bold: true }));
    }
  }
}

function drawLink(context, p, q, halo) {
  for (const [width, colour] of [[7, halo], [3.5, FALSE_ALARM]]) {
    context.lineWidth = width;
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(p.x, p.y);
    context.lineTo(q.x, q.y);
    context.stroke();
  }
}

function drawPivots(context, project, skin, model, ids, eye, ink, halo) {
  context.fillStyle = ink;
  context.strokeStyle = halo;
  context.lineWidth = 1.5;
  for (const id of ids) {
    for (const t of model.spheres[id].pivots) {
      const { corners, center } = skin.triangle(t);
      const [a, b, c] = corners;
      const u = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
      const v = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
      const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      const seen = normal[0] * (eye.x - a[0]) + normal[1] * (eye.y - a[1]) + normal[2] * (eye.z - a[2]) > 0;
      context.globalAlpha = seen ? 1 : 0.25; // the far side shows through
      context.beginPath();
      for (const corner of corners) {
        const p = project(...corner);
        context.lineTo(p.x, p.y);
      }
      context.closePath();
      context.fill();
      const dot = project(...center);
      context.beginPath();
      context.arc(dot.x, dot.y, seen ? 2.6 : 2, 0, 2 * Math.PI);
      context.fill();
      if (seen) context.stroke();
    }
  }
  context.globalAlpha = 1;
}

// Spheres are small beside their distance: the widest step along an axis is as good as a silhouette.
function radiusInPixels(model, state, project, id) {
  const [x, y, z, r] = model.sphere(state.frame, id, state.radius);
  const center = project(x, y, z);
  const { left, up, forward } = model.axes;
  const steps = [left, up, forward].map((axis) => project(x + r * axis[0], y + r * axis[1], z + r * axis[2]));
  return Math.max(...steps.map((p) => Math.hypot(p.x - center.x, p.y - center.y)));
}

// Each contact's number in the list, at its triangles.
function numberContacts(names, { model, skin, state, project }) {
  if (!state.paint) return;
  const numbers = new Map(model.contacts.now(state.frame).map(({ key }, i) => [key, i + 1]));
  for (const { key, triangles } of model.painted(state)) {
    if (triangles.every((t) => state.hiddenParts.has(model.mesh.partOf[t]))) continue;
    const [x, y, z, radius] = skin.ballOf(triangles);
    const at = project(x, y, z);
    const { up } = model.axes;
    const above = project(x + radius * up[0], y + radius * up[1], z + radius * up[2]);
    const lift = Math.min(Math.hypot(above.x - at.x, above.y - at.y), 12) + 12;
    const paper = state.contact === null || state.contact === key ? CONTACT : '#9a5257';
    [[0, -lift], [lift, 0], [-lift, 0], [0, lift]].some(([dx, dy]) => names.add(`${numbers.get(key)}`, at.x + dx, at.y + dy, { ink: '#fff', paper, bold: true }));
  }
}

export function drawOverlay(canvas, { model, skin, state, project, eye, visible }) {
  const { context, width, height } = fitCanvas(canvas);
  const [ink, halo, paper] = ['--ink', '--halo', '--label'].map(css);
  const { pointed } = state;
  const pair = state.spheres && state.alarm ? state.alarm.split('-').map(Number) : [];
  const centers = model.spheres.map((_, i) => project(...model.sphere(state.frame, i, state.radius)));
  const all = model.sets.filter((set) => set.kind === 'chain').map((set, i) => ({ ...set, colour: chainColour(i) }));
  const chosen = all.filter((chain) => state.sets.has(chain.name));
  const chains = chosen.map((chain, i) => ({
    ...chain,
    points: inLane(chain.order.map((id) => centers[id]), (i - (chosen.length - 1) / 2) * LANE),
  }));
  drawChains(context, chains, halo);
  const withPivots = visible.size > 0 ? visible : model.spheres.map(({ id }) => id);
  if (state.pivots) drawPivots(context, project, skin, model, withPivots, eye, ink, halo);
  if (pair.length > 0) drawLink(context, centers[pair[0]], centers[pair[1]], halo);

  // From the most to the least wanted.
  const names = new Names(context, width, height, css('--font'));
  const number = (id, style) => names.add(`${id}`, centers[id].x, centers[id].y, style);
  if (pointed !== null && visible.has(pointed)) {
    const above = Math.max(centers[pointed].y - radiusInPixels(model, state, project, pointed) - 12, 10);
    const name = `${pointed} ${model.spheres[pointed].name}`;
    names.add(name, centers[pointed].x, above, { ink: '#111', paper: POINTED, bold: true });
  }
  numberContacts(names, { model, skin, state, project });
  for (const id of pair) number(id, { ink: '#fff', paper: FALSE_ALARM, bold: true });
  nameChains(names, chains);
  const nearFirst = (ids) => [...ids].sort((a, b) => centers[a].depth - centers[b].depth);
  if (state.numbers) for (const id of nearFirst(withPivots)) number(id, { ink, paper });
}
