import { h } from './base/dom.js';
import { readModel } from './model/model.js';
import { decodePictures } from './model/pictures.js';
import { addTab } from './panels/tabs.js';
import { fillFixPanel, fixKeys } from './report/fix_panel.js';
import { start } from './viewer.js';

const data = JSON.parse(document.getElementById('spherechain-data').textContent);

// A link to a frame: `#frame=12`, or `#clip=walk&frame=12` with the clip's own number. Others are left alone.
function openLinked(model, store) {
  const words = new URLSearchParams(location.hash.slice(1));
  const clip = words.has('clip') ? model.clips.find(({ name }) => name === words.get('clip')) : { first: 0, count: model.frameCount };
  const places = Array.from({ length: clip?.count ?? 0 }, (_, i) => clip.first + i);
  const place = places.find((frame) => model.number(frame) === words.get('frame') || (!words.has('frame') && words.has('clip')));
  if (place !== undefined) store.set({ frame: place, playing: false });
}

if (data) {
  const model = readModel(data);
  decodePictures(model).then(() => {
    const panel = model.change ? addTab('Events') : null;
    const viewer = start(model, panel ? fixKeys : []);
    const { store } = viewer;
    if (panel) fillFixPanel(panel, { model, ...viewer });
    addEventListener('hashchange', () => openLinked(model, store));
    openLinked(model, store);
  });
} else document.body.replaceChildren(h('p', { class: 'template' }, 'This is the template of `spherechain view`: it has no character in it yet.'));
