// Elements without a framework.
// `h('button', { class: 'chip', onclick: f }, 'Play')`: `on...` are listeners, other properties attributes; null and false
// leave a property or child out.
export function h(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return element;
}

// A command to copy, as a shell reads it: a word that holds a space or the like is quoted.
export function commandBlock(...words) {
  const quoted = words.map((word) => (/^[\w./+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`));
  return h('code', { class: 'command' }, ...quoted.flatMap((word) => [h('span', {}, word), ' ']));
}

export const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// An empty canvas of its box's size in device pixels; the context draws in CSS pixels. It is painted over with nothing: in
// Chromium 156 a second clearRect or reset in a row brings back what was drawn before.
export function fitCanvas(canvas) {
  const ratio = Math.min(window.devicePixelRatio, 2);
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  const size = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  const context = canvas.getContext('2d');
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.globalCompositeOperation = 'copy';
  context.fillStyle = 'transparent';
  context.fillRect(0, 0, width, height);
  context.globalCompositeOperation = 'source-over';
  return { context, width, height };
}
