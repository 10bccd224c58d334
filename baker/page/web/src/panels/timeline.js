import { css, fitCanvas, h } from '../base/dom.js';
import { isFault } from '../model/contacts.js';
import { plural, withoutCommonStart } from '../base/format.js';
import { CONTACT, FALSE_ALARM } from '../base/palette.js';

// Play, step, scrub. A frame with a fault has a bar, as high as it is deep, and paler where a change has cured it; one in which the skin only folds or touches has a
// tick. With spheres shown, a frame with false alarms has a mark below. Clips begin at a line with their name; frames are numbered in their clip.

const INSET = 8; // half the slider's thumb: where its first and last value are
const BASE = 15; // pixels for the numbers
const TOP = 14; // and for the names of clips
const CURED = 0.35; // opacity of a bar: the depth before a change

function drawNumbers(context, { model, x, base, height, perFrame, inRange }) {
  const step = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000].find((s) => s * perFrame >= 36) ?? 10000;
  for (const { first, count } of model.clips.filter(inRange)) {
    if (count * perFrame < 30) continue;
    const end = x(first + count - 1);
    for (let frame = 0; frame < count; frame += step) {
      const left = x(first + frame);
      if (frame > 0 && end - left < 12 && first + count < model.frameCount) break;
      context.fillStyle = css('--line');
      context.fillRect(left, base, 1, 4);
      context.fillStyle = css('--muted');
      context.textAlign = frame === 0 ? 'left' : 'center';
      context.fillText(`${model.number(first + frame)}`, frame === 0 ? left - 2 : left, height);
    }
  }
}

function drawClips(context, { model, x, base, inRange }) {
  if (model.clips.length < 2) return;
  const names = withoutCommonStart(model.clips.map(({ name }) => name));
  let marked = -Infinity;
  for (const [i, { first, count }] of model.clips.entries()) {
    if (!inRange(model.clips[i])) continue;
    const left = x(first);
    if (left < marked + 4) continue; // too near to tell apart
    marked = left;
    const right = x(first + count);
    context.fillStyle = css('--muted');
    context.fillRect(left, 0, 1, base + 4);
    let text = names[i];
    while (text.length > 1 && context.measureText(text).width > right - left - 8) text = `${text.slice(0, -2)}…`;
    if (text.length < 6 && text !== names[i]) continue;
    context.textAlign = 'left';
    context.fillText(text, left + 4, 11);
  }
}

// The first and last frame of the track: of all clips, or of the one that is shown.
function range(model, { frame, oneClip }) {
  if (!oneClip) return [0, model.frameCount - 1];
  const { first, count } = model.clips[model.clipAt(frame)];
  return [first, first + count - 1];
}

function drawBars(canvas, model, state) {
  const { context, width, height } = fitCanvas(canvas);
  if (width === 0) return;
  const [from, to] = range(model, state);
  const perFrame = (width - 2 * INSET) / Math.max(to - from, 1);
  const x = (frame) => INSET + (frame - from) * perFrame;
  const inRange = ({ first, count }) => first <= to && first + count > from;
  const clip = model.clips[model.clipAt(state.frame)];
  if (model.clips.length > 1 && !state.oneClip) {
    context.fillStyle = css('--hover');
    context.fillRect(x(clip.first), 0, Math.max((clip.count - 1) * perFrame, 2), height - BASE);
  }
  if (state.loop) {
    context.fillStyle = css('--hover');
    context.fillRect(x(state.loop.first), 0, Math.max((state.loop.count - 1) * perFrame, 2), height - BASE);
  }
  const depths = Array.from({ length: model.frameCount }, (_, frame) => model.contacts.depth(frame));
  const isLeft = ({ parts }) => !model.change || parts[0] >= model.change.part;
  const most = Math.max(1, ...depths.slice(from, to + 1));
  const base = height - BASE;
  const top = model.clips.length > 1 ? TOP : 4;
  context.fillStyle = css('--line');
  context.fillRect(INSET, base, width - 2 * INSET, 1);
  context.fillStyle = CONTACT;
  const bar = Math.max(1, Math.min(14, perFrame * 0.7));
  depths.forEach((depth, frame) => {
    if (frame < from || frame > to || model.contacts.of(frame).length === 0) return;
    const high = (depth) => (depth > 0 ? 3 + (depth / most) * (base - top - 3) : 2);
    const left = model.contacts.depth(frame, isLeft);
    context.fillStyle = depth > 0 ? CONTACT : css('--muted');
    context.globalAlpha = depth > left ? CURED : 1;
    context.fillRect(x(frame) - bar / 2, base - high(depth), bar, high(depth));
    context.globalAlpha = 1;
    if (depth > left && left > 0) context.fillRect(x(frame) - bar / 2, base - high(left), bar, high(left));
  });
  if (state.spheres) {
    context.fillStyle = FALSE_ALARM;
    for (let frame = from; frame <= to; ++frame) {
      if (model.spherePairs(frame, state.radius).some(({ isFalse }) => isFalse)) context.fillRect(x(frame) - bar / 2, base + 1, bar, 3);
    }
  }
  context.font = `10px ${css('--font')}`;
  context.textBaseline = 'bottom';
  drawNumbers(context, { model, x, base, height, perFrame, inRange });
  drawClips(context, { model, x, base, inRange });
}

// "2 faults → 0": before and after a change.
function changeText(contacts, { part }) {
  const before = contacts.filter((contact) => isFault(contact) && contact.parts[0] < part).length;
  const after = contacts.filter((contact) => isFault(contact) && contact.parts[0] >= part).length;
  return before + after === 0 ? 'no fault' : `${plural(before, 'fault')} → ${after}`;
}

export function fillTimeline(panel, store, model) {
  const last = model.frameCount - 1;
  const go = (frame) => store.set({ frame: Math.min(Math.max(frame, 0), last), playing: false });
  const button = (label, text, onclick) => h('button', { type: 'button', class: 'icon', 'aria-label': label, title: label, onclick }, text);
  const play = button('Play', '▶', () => store.set({ playing: !store.state.playing }));
  const buttons = [
    button('Previous frame', '◀︎|', () => go(store.state.frame - 1)),
    play,
    button('Next frame', '|▶︎', () => go(store.state.frame + 1)),
  ];
  const bars = h('canvas', { 'aria-hidden': 'true' });
  const zoom = h('button', { type: 'button', class: 'icon', id: 'one-clip', onclick: () => store.set({ oneClip: !store.state.oneClip }) });
  if (model.clips.length > 1) buttons.push(zoom);
  const input = h('input', { type: 'range', min: 0, max: last, id: 'frame', 'aria-label': 'Frame', oninput: () => go(Number(input.value)) });
  const readout = h('output', { class: 'readout', for: 'frame' });
  for (const control of [...buttons, input]) control.disabled = last === 0;
  panel.append(h('div', { class: 'buttons' }, buttons), h('div', { class: 'track' }, bars, input), readout);

  store.watch(['playing'], ({ playing }) => {
    play.textContent = playing ? '❚❚' : '▶';
    play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    play.title = `${playing ? 'Pause' : 'Play'} (space)`;
  });
  store.watch(['frame', 'pose'], ({ frame }) => {
    const clip = model.clips[model.clipAt(frame)];
    const contacts = model.contacts.now(frame);
    const number = model.number(frame);
    const text = model.mask ? '' : model.change ? changeText(contacts, model.change) : contacts.length > 0 ? plural(contacts.length, 'contact') : 'no contact';
    input.setAttribute('aria-valuetext', [clip.name, `frame ${number}`, text].filter(Boolean).join(', '));
    readout.replaceChildren(
      last === 0 ? h('b', {}, 'One frame') : h('span', {}, 'frame ', h('b', {}, `${number}`), ` / ${clip.own_count - 1}`),
      h('span', {}, `${model.seconds(frame).toFixed(2)} s`),
      h('span', { class: contacts.some(isFault) ? 'warning' : '' }, text),
    );
  });
  const draw = () => drawBars(bars, model, store.state);
  let clip = -1;
  store.watch(['theme', 'spheres', 'radius', 'oneClip', 'loop'], draw);
  store.watch(['frame', 'oneClip'], (state) => {
    zoom.textContent = state.oneClip ? 'all clips' : 'this clip';
    zoom.title = state.oneClip ? 'All clips on the timeline' : 'Only the clip that is shown on the timeline';
    [input.min, input.max] = range(model, state);
    input.value = state.frame;
    if (clip !== (clip = model.clipAt(state.frame))) draw();
  });
  new ResizeObserver(draw).observe(bars);
  return { step: (by) => last > 0 && go(store.state.frame + by), go };
}
