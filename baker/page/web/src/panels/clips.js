import { h } from '../base/dom.js';
import { withoutCommonStart } from '../base/format.js';

// The clip that plays, and where there are several the list to choose from.
export function fillClips(box, store, model) {
  const { clips } = model;
  if (clips.length < 2) {
    box.append(h('span', { class: 'clip-name' }, clips[0].name));
    return;
  }
  const touching = ({ first, count }) => {
    let frames = 0;
    for (let frame = first; frame < first + count; ++frame) frames += model.contacts.of(frame).length > 0 ? 1 : 0;
    return frames;
  };
  const names = withoutCommonStart(clips.map(({ name }) => name));
  const note = (clip) => (model.mask ? '' : ` · skin touches in ${touching(clip)} of ${clip.count} frames`);
  const option = (clip, i) => h('option', { value: i, title: clip.name }, names[i] + note(clip));
  const choose = () => store.set({ frame: clips[select.value].first, contact: null });
  const select = h('select', { id: 'clips', 'aria-label': 'Clip', onchange: choose }, clips.map(option));
  box.append(select);
  store.watch(['frame'], ({ frame }) => (select.value = model.clipAt(frame)));
}
