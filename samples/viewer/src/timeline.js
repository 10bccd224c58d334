import { css, fitCanvas, h } from './dom.js';
import { plural } from './format.js';
import { WARNING } from './palette.js';

// Play, step, scrub. A frame with pairs has a bar, as high as it has pairs.

const INSET = 8; // half the slider's thumb: where its first and last value are

function drawBars(canvas, model) {
  const { context, width, height } = fitCanvas(canvas);
  const last = Math.max(model.frameCount - 1, 1);
  const x = (frame) => INSET + (frame / last) * (width - 2 * INSET);
  const counts = Array.from({ length: model.frameCount }, (_, frame) => model.pairs(frame).length);
  const most = Math.max(1, ...counts);
  const base = height - 15;
  context.fillStyle = css('--line');
  context.fillRect(INSET, base, width - 2 * INSET, 1);
  context.fillStyle = WARNING;
  const bar = Math.max(1, Math.min(14, ((width - 2 * INSET) / last) * 0.7));
  counts.forEach((count, frame) => {
    if (count > 0) context.fillRect(x(frame) - bar / 2, base - (count / most) * (base - 4), bar, (count / most) * (base - 4));
  });
  const step = [1, 2, 5, 10, 20, 50, 100, 200].find((s) => (s / last) * width >= 36) ?? 500;
  context.font = `10px ${css('--font')}`;
  context.textBaseline = 'bottom';
  for (let frame = 0; frame < model.frameCount; frame += step) {
    context.fillStyle = css('--line');
    context.fillRect(x(frame), base, 1, 4);
    context.fillStyle = css('--muted');
    context.textAlign = frame === 0 ? 'left' : 'center';
    context.fillText(`${frame}`, frame === 0 ? INSET - 2 : x(frame), height);
  }
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
  const input = h('input', { type: 'range', min: 0, max: last, id: 'frame', 'aria-label': 'Frame', oninput: () => go(Number(input.value)) });
  const readout = h('output', { class: 'readout', for: 'frame' });
  for (const control of [...buttons, input]) control.disabled = last === 0;
  panel.append(h('div', { class: 'buttons' }, buttons), h('div', { class: 'track' }, bars, input), readout);

  store.watch(['playing'], ({ playing }) => {
    play.textContent = playing ? '❚❚' : '▶';
    play.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    play.title = `${playing ? 'Pause' : 'Play'} (space)`;
  });
  store.watch(['frame'], ({ frame }) => {
    input.value = frame;
    const pairs = model.pairs(frame).length;
    const time = model.play[frame]?.time ?? frame / model.fps;
    input.setAttribute('aria-valuetext', `frame ${frame}, ${plural(pairs, 'pair')}`);
    readout.replaceChildren(
      last === 0 ? h('b', {}, 'One frame') : h('span', {}, 'frame ', h('b', {}, `${frame}`), ` of 0–${last}`),
      h('span', {}, `${time.toFixed(2)} s`),
      h('span', { class: pairs > 0 ? 'warning' : '' }, pairs > 0 ? plural(pairs, 'pair') : 'no pairs'),
    );
  });
  store.watch(['theme'], () => drawBars(bars, model));
  new ResizeObserver(() => drawBars(bars, model)).observe(bars);
  return { step: (by) => last > 0 && go(store.state.frame + by), go };
}
