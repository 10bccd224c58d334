import 'uplot/dist/uPlot.min.css';
import './style.css';
import { fillAccuracyPanel } from './panels/accuracy_panel.js';
import { fillBakePanel } from './panels/bake_panel.js';
import { fillCharts } from './panels/charts.js';
import { fillClips } from './panels/clips.js';
import { fillContactPanel } from './panels/contact_panel.js';
import { ContactLayer } from './scene/contact_layer.js';
import { ColliderLayer } from './scene/collider_layer.js';
import { fillControls } from './panels/controls.js';
import { css, h } from './base/dom.js';
import { dress } from './scene/dress.js';
import { createEditor } from './editor/editor.js';
import { bindKeys } from './panels/keys.js';
import { fillMaskPanel } from './panels/mask_panel.js';
import { drawOverlay } from './scene/overlay.js';
import { followPointer } from './scene/pointer.js';
import { addPosing } from './editor/posing.js';
import { fillSphereCard, fillSpherePanel } from './panels/sphere_panel.js';
import { Refit } from './model/refit.js';
import { Skin } from './model/skin.js';
import { SkinLayer } from './scene/skin_layer.js';
import { SphereLayer } from './scene/sphere_layer.js';
import { createStage } from './scene/stage.js';
import { createStore } from './base/store.js';
import { bindTabs } from './panels/tabs.js';
import { fillTimeline } from './panels/timeline.js';

const $ = (id) => document.getElementById(id);

function bindTheme(store) {
  const toggle = () => store.set({ theme: store.state.theme === 'dark' ? 'light' : 'dark' });
  $('theme').addEventListener('click', toggle);
  store.watch(['theme'], ({ theme }) => (document.documentElement.dataset.theme = theme));
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) =>
    store.set({ theme: event.matches ? 'dark' : 'light' }),
  );
  return toggle;
}

// Before and after a change: beside each other, the old pose as a ghost over the new one, or one of them.
function addShowing(reset, store) {
  const button = (showing, label, title) => {
    const made = h('button', { type: 'button', 'data-showing': showing, title, onclick: () => store.set({ showing }) }, label);
    store.watch(['showing'], (state) => made.setAttribute('aria-pressed', state.showing === showing));
    return made;
  };
  const group = h('div', { class: 'segments', role: 'group', 'aria-label': 'Before and after' });
  group.append(
    button('beside', 'Beside', 'Before and after beside each other (O)'),
    button('ghost', 'Ghost', 'The old pose as a ghost over the new one (O)'),
    button('before', 'Before', 'The old pose alone (C)'),
    button('after', 'After', 'The new pose alone (C)'),
  );
  reset.before(group);
}

// In a narrow window the controls come and go over the picture.
function bindDrawer() {
  const button = $('show');
  button.addEventListener('click', () => {
    const open = document.body.classList.toggle('controls-open');
    button.setAttribute('aria-expanded', open);
  });
}

// The clip shown, or the loop in it, plays again and again.
function runPlayback(store, model) {
  let start = null;
  const tick = (now) => {
    if (!store.state.playing) return;
    const { frame, loop } = store.state;
    const { first, count } = loop ?? model.clips[model.clipAt(frame)];
    const isIn = frame >= first && frame < first + count;
    start ??= { clip: first, time: now - (isIn ? (1000 * (frame - first)) / model.fps : 0) };
    if (start.clip !== first) start = { clip: first, time: now };
    store.set({ frame: first + (Math.floor(((now - start.time) * model.fps) / 1000) % count) });
    requestAnimationFrame(tick);
  };
  store.watch(['playing'], ({ playing }) => {
    start = null;
    if (playing && model.frameCount > 1) requestAnimationFrame(tick);
    else if (playing) store.set({ playing: false });
  });
}

const shown = {
  skin: true,
  skinOpacity: 1,
  look: true, // its base colours
  layers: false, // of a mask, in their colours
  masked: false, // without the triangles that a mask hides
  paint: true, // on the skin: contacts, their numbers and ways out
  hiddenContacts: true,
  follow: true,
  spheres: false,
  sphereOpacity: 0.8,
  colliders: true, // where the page has some
  colliderOpacity: 0.5,
  method: false,
  regions: false, // in their colours
  patches: false, // spheres' triangles in tones
  pivots: false,
  numbers: false,
  oneClip: false, // on the timeline
  showing: 'beside', // before and after a change: or the old one as a `ghost`, or `before` or `after` alone
  aside: 0, // the angle, from the character's left to its front, of what is right in the picture
  loop: null, // frames that play in place of the clip: {first, count}
  ghost: true, // the pose as animated, over the corrected one
  hiddenParts: new Set(),
  sets: new Set(),
  posing: false, // by hand
  respond: true, // arms of a pose by hand stay out of the body
  contact: null, // the key of the contact last gone to
  alarm: null, // "a-b": the pair of spheres last gone to
  pinned: null,
  pointed: null, // the sphere under the pointer, else the one pinned
};

function bindStage(stage, store, model, layers, skin) {
  const visible = new Set();
  let eye = null;
  stage.onDraw(
    (from) => {
      eye = from;
      layers.sphereLayer.upload(eye);
      layers.contactLayer.shared.ratio.value = stage.pixelRatio();
      layers.editor?.draw(eye);
    },
    (project) => {
      if (store.state.editing) {
        layers.editor.overlay(project);
      } else {
        drawOverlay($('overlay'), { model, skin, state: store.state, project, eye, visible });
        layers.posing?.place(project);
      }
    },
  );
  store.watch(['theme'], () => stage.setInk(css('--ink')));
  store.watch(Object.keys(store.state), () => {
    dress(model, store.state, layers, visible);
    stage.invalidate();
  });
  followPointer($('view'), store, model, stage, visible);
  for (const button of document.querySelectorAll('[data-view]')) {
    button.addEventListener('click', () => stage.view(button.dataset.view));
  }
}

// Shows a model in the page. Returns what other parts of a page need of it; `listed` are keys that they bind (keys.js).
export function start(model, listed = []) {
  document.title = `${model.title} · spherechain`;
  $('title').textContent = model.title;
  // Where spheres are no method to study, the skin shows through them.
  const startState = { ...shown, radius: model.radius, ...(model.hasMethod ? {} : { sphereOpacity: 0.4 }), layers: model.mask !== null };
  const theme = matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  const store = createStore({ ...startState, frame: model.start, playing: false, theme, pose: 0, joint: null, editing: false });
  const toggleTheme = bindTheme(store);
  const skin = new Skin(model.mesh, model.motion, model.look);
  if (!model.hasSpheres) model.refit = new Refit(model.inspect, model.mesh, skin);
  let most = 0;
  for (let frame = 0; frame < model.frameCount; ++frame) most = Math.max(most, model.contacts.count(frame));
  const layers = {
    skinLayer: new SkinLayer(skin, model.look),
    ghostLayer: model.response ? new SkinLayer(new Skin(model.mesh, { ...model.motion, bones: model.motion.animated }), null, true) : null,
    sphereLayer: new SphereLayer(model.spheres.length),
    contactLayer: new ContactLayer(skin, most),
    colliderLayer: model.colliders ? new ColliderLayer(model.colliders, model.motion) : null,
  };
  skin.pose(model.start);
  const stage = createStage($('view'), model, store, layers);
  if (stage) bindStage(stage, store, model, layers, skin);
  else $('no-webgl').hidden = false;
  layers.posing = addPosing({ model, skin, store, stage, toolbar: $('reset'), canvas: $('view') });

  const flyToSpheres = (a, b) => {
    const { frame, radius } = store.state;
    stage?.flyToSpheres(model.sphere(frame, a, radius), model.sphere(frame, b, radius));
  };
  // `camera`: from where it is seen, where that is known.
  const flyToContact = (key, camera = null, room = 1) => {
    const contact = model.contacts.now(store.state.frame).find((other) => other.key === key);
    const side = model.change ? (contact?.parts[0] < model.change.part ? -1 : 1) : 0;
    if (contact) stage?.flyToContact(skin.ballOf(contact.triangles), camera, side, room);
  };
  const flyToTriangles = (triangles, camera) => stage?.flyToContact(skin.ballOf(triangles), camera);
  if (model.change) addShowing($('reset'), store);
  fillClips($('clip'), store, model);
  fillControls($('controls'), store, model);
  const deepest = model.mask ? null : fillContactPanel($('contacts'), store, model, flyToContact);
  if (model.mask) {
    $('tab-contacts').textContent = 'Mask';
    fillMaskPanel($('contacts'), store, model);
  }
  fillSpherePanel($('spheres'), store, model, flyToSpheres);
  fillSphereCard($('sphere'), store, model);
  const timeline = fillTimeline($('timeline'), store, model);
  fillCharts($('charts'), store, model);
  fillAccuracyPanel($('accuracy'), store, model, flyToSpheres);
  layers.editor = createEditor({ model, skin, store, stage, layers, canvas: $('view'), overlay: $('overlay') });
  if (model.hasMethod) fillBakePanel($('bake'), model);
  else $('tab-bake').remove();
  bindTabs(store);
  bindDrawer();
  const reset = () => {
    store.set(layers.editor?.asReset(startState) ?? startState);
    stage?.view('front');
  };
  $('reset').addEventListener('click', reset);
  $('help-button').addEventListener('click', () => $('help').showModal());
  $('licences').textContent = LICENCES;
  const chains = model.sets.filter((set) => set.kind === 'chain').map((set) => set.name);
  bindKeys(store, { timeline, stage, help: $('help'), toggleTheme, reset, deepest, chains, hasMethod: model.hasMethod, hasChange: model.change !== null, hasResponse: model.response !== null, hasColliders: model.colliders !== null, hasMask: model.mask !== null, posing: layers.posing, editor: layers.editor, listed });
  runPlayback(store, model);

  window.spherechainViewer = Object.freeze({
    get frame() {
      return store.state.frame;
    },
    setFrame: (frame) => timeline.go(frame),
    contacts: () =>
      model.contacts.now(store.state.frame).map(({ name, pairs, triangles, kind, depth }) => ({ name, pairs, triangles: [...triangles], kind, depth })),
    camera: () => stage?.camera() ?? null,
    hovered: () => store.state.pointed,
    posing: layers.posing,
    edits: () => layers.editor?.read() ?? null,
    ready: true,
  });
  return { store, flyToContact, flyToTriangles, skinLayer: layers.skinLayer, redraw: () => stage?.invalidate() };
}
