import 'uplot/dist/uPlot.min.css';
import './style.css';
import { fillAccuracyPanel } from './accuracy_panel.js';
import { fillBakePanel } from './bake_panel.js';
import { fillCharts } from './charts.js';
import { fillContacts } from './contacts.js';
import { fillControls } from './controls.js';
import { css, h } from './dom.js';
import { bindKeys } from './keys.js';
import { readModel } from './model.js';
import { drawOverlay } from './overlay.js';
import { POINTED, regionColour, WARNING } from './palette.js';
import { followPointer } from './pointer.js';
import { fillSpherePanel } from './sphere_panel.js';
import { Skin } from './skin.js';
import { looks, SkinLayer } from './skin_layer.js';
import { SphereLayer } from './sphere_layer.js';
import { createStage } from './stage.js';
import { createStore } from './store.js';
import { fillTimeline } from './timeline.js';

const $ = (id) => document.getElementById(id);

function bindTheme(store) {
  const apply = () => {
    document.documentElement.dataset.theme = store.state.theme;
  };
  const button = $('theme');
  const toggle = () => store.set({ theme: store.state.theme === 'dark' ? 'light' : 'dark' });
  button.addEventListener('click', toggle);
  store.watch(['theme'], apply);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) =>
    store.set({ theme: event.matches ? 'dark' : 'light' }),
  );
  return toggle;
}

function bindTabs() {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const choose = (tab) => {
    for (const other of tabs) {
      other.setAttribute('aria-selected', other === tab);
      other.tabIndex = other === tab ? 0 : -1;
      $(other.getAttribute('aria-controls')).hidden = other !== tab;
    }
  };
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => choose(tab));
    tab.addEventListener('keydown', (event) => {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!by) return;
      event.stopPropagation();
      const next = tabs[(i + by + tabs.length) % tabs.length];
      choose(next);
      next.focus();
    });
  });
}

// A lighter or darker tone, so that surrounding regions of neighbours differ.
function tone(colour, i) {
  const by = [1, 0.72, 1.22][i % 3];
  const channels = [1, 3, 5].map((at) => Math.min(255, Math.round(parseInt(colour.slice(at, at + 2), 16) * by)));
  return `#${channels.map((value) => value.toString(16).padStart(2, '0')).join('')}`;
}

// Brings the layers to what the state says.
function dress(model, store, skinLayer, sphereLayer, touching, visible) {
  const { state } = store;
  const marked = new Set(model.sets.filter((set) => state.sets.has(set.name)).flatMap((set) => [...set.spheres]));
  touching.clear();
  for (const id of model.pairs(state.frame).flat()) touching.add(id);
  visible.clear();
  skinLayer.group.visible = state.skin;
  skinLayer.uniforms.opacity.value = state.skinOpacity;
  skinLayer.setLook(model.spheres.length, '#9a9a9a', looks.PLAIN);
  sphereLayer.group.visible = state.spheres;
  sphereLayer.rimColour.set(css('--rim'));
  skinLayer.pose(state.frame);
  model.spheres.forEach(({ region }, id) => {
    const hidden = state.hiddenRegions.has(region);
    const base = regionColour(region);
    if (hidden) skinLayer.setLook(id, base, looks.HIDDEN);
    else if (id === state.pointed) skinLayer.setLook(id, POINTED, looks.POINTED);
    else if (touching.has(id)) skinLayer.setLook(id, WARNING, looks.TOUCHING);
    else skinLayer.setLook(id, state.patches ? tone(base, id) : base, looks.PLAIN);

    const item = sphereLayer.items[id];
    const faded = marked.size > 0 && !marked.has(id);
    item.sphere = model.sphere(state.frame, id, state.radius);
    item.colour.set(touching.has(id) ? WARNING : base);
    item.alpha = hidden ? 0 : faded ? 0.1 : touching.has(id) ? Math.max(state.sphereOpacity, 0.9) : state.sphereOpacity;
    item.rim = hidden ? 0 : id === state.pointed ? 0.3 : touching.has(id) && !faded ? 0.16 : 0;
    if (state.spheres && !hidden && !faded) visible.add(id);
  });
}

function runPlayback(store, model) {
  let start = null;
  const tick = (now) => {
    if (!store.state.playing) return;
    start ??= now - (1000 * store.state.frame) / model.fps;
    store.set({ frame: Math.floor(((now - start) * model.fps) / 1000) % model.frameCount });
    requestAnimationFrame(tick);
  };
  store.watch(['playing'], ({ playing }) => {
    start = null;
    if (playing && model.frameCount > 1) requestAnimationFrame(tick);
    else if (playing) store.set({ playing: false });
  });
}

function start(model) {
  document.title = `${model.title} · spherechain`;
  $('title').textContent = model.title;
  $('motion').textContent =
    `${model.motion} · ${model.frameCount} frame${model.frameCount === 1 ? '' : 's'} · pairs at the ${model.radius} radius`;
  const shown = {
    skin: true,
    skinOpacity: 0.3,
    spheres: true,
    sphereOpacity: 0.8,
    radius: model.radius,
    patches: false,
    pivots: false,
    numbers: false,
    hiddenRegions: new Set(),
    sets: new Set(),
    pinned: null,
    pointed: null, // the sphere under the pointer, else the one pinned
    pair: null, // "a-b": the pair last flown to
  };
  const store = createStore({
    ...shown,
    frame: 0,
    playing: false,
    theme: matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light',
  });
  const toggleTheme = bindTheme(store);
  const skin = new Skin(model.mesh, model.motionData);
  const skinLayer = new SkinLayer(skin, model.spheres.length);
  const sphereLayer = new SphereLayer(model.spheres.length);
  const stage = createStage($('view'), model, [sphereLayer, skinLayer]);
  const touching = new Set();
  const visible = new Set();

  if (stage) {
    let eye = null;
    stage.onDraw(
      (from) => {
        eye = from;
        sphereLayer.upload(eye);
        skinLayer.uniforms.ratio.value = stage.pixelRatio();
      },
      (project) => drawOverlay($('overlay'), { model, skin, state: store.state, project, eye, visible, touching }),
    );
    store.watch(['theme'], () => stage.setInk(css('--ink')));
    store.watch(Object.keys(store.state), () => {
      dress(model, store, skinLayer, sphereLayer, touching, visible);
      stage.invalidate();
    });
    followPointer($('view'), store, model, stage, visible);
    for (const button of document.querySelectorAll('[data-view]')) {
      button.addEventListener('click', () => stage.view(button.dataset.view));
    }
  } else {
    $('no-webgl').hidden = false;
  }

  fillControls($('controls'), store, model);
  const flyTo = (a, b) => {
    const { frame, radius } = store.state;
    stage?.flyTo(model.sphere(frame, a, radius), model.sphere(frame, b, radius));
  };
  fillContacts($('contacts'), store, model, flyTo);
  fillSpherePanel($('sphere'), store, model);
  const timeline = fillTimeline($('timeline'), store, model);
  fillCharts($('charts'), store, model);
  fillAccuracyPanel($('accuracy'), store, model, flyTo);
  fillBakePanel($('bake'), model);
  bindTabs();
  const reset = () => {
    store.set(shown);
    stage?.view('front');
  };
  $('reset').addEventListener('click', reset);
  $('help-button').addEventListener('click', () => $('help').showModal());
  $('licences').textContent = LICENCES;
  const chains = model.sets.filter((set) => set.kind === 'chain').map((set) => set.name);
  bindKeys(store, { timeline, stage, help: $('help'), toggleTheme, reset, chains });
  runPlayback(store, model);

  window.spherechainViewer = Object.freeze({
    get frame() {
      return store.state.frame;
    },
    setFrame: (frame) => timeline.go(frame),
    pairs: () => model.pairs(store.state.frame),
    hovered: () => store.state.pointed,
    ready: true,
  });
}

const model = readModel($('spherechain-data').textContent);
if (model) start(model);
else document.body.replaceChildren(h('p', { class: 'template' }, 'This is the template of `spherechain view`: it has no character in it yet.'));
