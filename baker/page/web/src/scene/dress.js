import { css } from '../base/dom.js';
import { ANIMATED, CLAY, CONTACT, FALSE_ALARM, GHOST, LAYERS, POINTED, regionColour, SPHERE, tone } from '../base/palette.js';
import { HIDDEN_LAYER } from '../model/model.js';
import { looks } from './skin_layer.js';

const MOVED = 0.01; // so far, as a share of the height, and its ghost is seen in full

function dressSkin(model, state, skinLayer) {
  skinLayer.group.visible = state.skin;
  skinLayer.setOpacity(state.skinOpacity);
  skinLayer.skin.moveApart(model.apart(state));
  if (!state.editing) skinLayer.pose(state.frame); // else it stands at rest
  const plain = state.regions || state.patches || state.layers || !state.look;
  skinLayer.uniforms.pictured.value = plain ? 0 : 1;
  const hidden = model.hiddenParts(state);
  const isGhost = model.change && state.showing === 'ghost';
  if (model.change) skinLayer.show((i) => (isGhost ? skinLayer.skin.moved(i) / (MOVED * model.height) : 0));
  skinLayer.skin.zones.forEach(({ layer, sphere, part, material, isBefore }, zone) => {
    const region = model.spheres[sphere]?.region ?? -1;
    const base = state.layers ? LAYERS[layer] : state.regions || state.patches ? regionColour(region) : (!plain && material?.colour) || CLAY;
    if (hidden.has(part) || (state.masked && layer === HIDDEN_LAYER)) skinLayer.setLook(zone, base, looks.HIDDEN);
    else if (isGhost && isBefore) skinLayer.setLook(zone, GHOST, looks.GHOST);
    else if (state.method && sphere === state.pointed) skinLayer.setLook(zone, POINTED, looks.POINTED);
    else skinLayer.setLook(zone, state.patches ? tone(base, sphere) : base, looks.PLAIN);
  });
}

// The pose as animated, where the response has moved it.
function dressGhost(model, state, { skin }, ghostLayer) {
  ghostLayer.group.visible = state.skin && state.ghost && !state.posing && !state.editing;
  if (!ghostLayer.group.visible) return;
  ghostLayer.pose(state.frame);
  ghostLayer.skin.zones.forEach(({ part }, zone) => ghostLayer.setLook(zone, ANIMATED, state.hiddenParts.has(part) ? looks.HIDDEN : looks.GHOST));
  const p = skin.positions, q = ghostLayer.skin.positions;
  ghostLayer.show((i) => Math.hypot(p[i] - q[i], p[i + 1] - q[i + 1], p[i + 2] - q[i + 2]) / (MOVED * model.height));
}

function dressSpheres(model, state, sphereLayer, visible) {
  const marked = new Set(model.sets.filter((set) => state.sets.has(set.name)).flatMap((set) => [...set.spheres]));
  const alarms = new Map();
  visible.clear();
  sphereLayer.group.visible = state.spheres && !state.editing; // else the editor has its own
  if (!sphereLayer.group.visible) return;
  for (const { a, b, isFalse } of model.spherePairs(state.frame, state.radius)) {
    for (const id of [a, b]) if (!isFalse || !alarms.has(id)) alarms.set(id, isFalse ? FALSE_ALARM : CONTACT);
  }
  sphereLayer.rimColour.set(css('--rim'));
  model.spheres.forEach(({ region }, id) => {
    const item = sphereLayer.items[id];
    const faded = marked.size > 0 && !marked.has(id);
    const alarm = alarms.get(id);
    item.sphere = model.sphere(state.frame, id, state.radius);
    item.colour.set(alarm ?? (state.regions ? regionColour(region) : SPHERE));
    item.alpha = faded ? 0.1 : alarm ? Math.max(state.sphereOpacity, 0.9) : state.sphereOpacity;
    item.rim = id === state.pointed ? 0.3 : alarm && !faded ? 0.16 : 0;
    if (!faded) visible.add(id);
  });
}

// Brings the layers to what the state says; `visible` becomes the spheres that are seen.
export function dress(model, state, { skinLayer, ghostLayer, sphereLayer, contactLayer, colliderLayer }, visible) {
  dressSkin(model, state, skinLayer);
  if (ghostLayer) dressGhost(model, state, skinLayer, ghostLayer);
  dressSpheres(model, state, sphereLayer, visible);
  if (colliderLayer) {
    colliderLayer.group.visible = state.colliders && !state.editing;
    colliderLayer.pose(state.frame, model.overlappingColliders(state.frame), state.colliderOpacity);
  }
  contactLayer.group.visible = state.paint;
  contactLayer.hidden.visible = state.hiddenContacts;
  contactLayer.fill(model.painted(state), state.contact, model.hiddenParts(state));
}
