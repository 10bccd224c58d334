// Browser helpers for tests: pages that must stay silent, pictures, and how much two pictures differ.
import assert from 'node:assert/strict';
import { after } from 'node:test';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

// One browser for all files. It draws by software: one sample a pixel takes a third of the time of four. Without OpenGL for
// all but the character, a page opens in half the time.
let running = null;
export const launch = (executablePath) =>
  (running ??= chromium.launch({
    executablePath,
    args: [
      '--no-sandbox',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--ignore-gpu-blocklist',
      '--webgl-antialiasing-mode=none',
      '--disable-gpu-compositing',
    ],
  }));
after(async () => (await running)?.close());

export const SCALE = 0.5;

// Runs in a page before its scripts: what was drawn stays in the canvas, so that picture() can read it, and hold() works.
export function keepDrawings() {
  const next = window.requestAnimationFrame.bind(window);
  let held = null;
  window.requestAnimationFrame = (draw) => (held ? held.push(draw) : next(draw));
  window.holdPictures = (isHeld) => {
    held?.forEach((draw) => next(draw));
    held = isHeld ? [] : null;
  };
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function (kind, settings) {
    return getContext.call(this, kind, kind === 'webgl2' ? { ...settings, preserveDrawingBuffer: true } : settings);
  };
}

// Whether the page waits with its pictures: for keys and fields that do the same whether one is drawn after each or not.
export const hold = (page, isHeld) => page.evaluate((is) => window.holdPictures(is), isHeld);

// A browser that puts pages together without OpenGL reads each picture of WebGL back, and warns of it in the page's console.
export const isOfBrowser = (text) => text.includes('GPU stall due to ReadPixels');

// Opens a page from disk; `noise` collects what no page may do: write to the console, fail, or ask for another file. `show`
// opens another file in its place, which takes half as long as opening it beside; what was not saved is lost.
export async function open(browser, file, { width = 1280, height = 720, scheme = 'light', init = keepDrawings } = {}) {
  const context = await browser.newContext({
    viewport: { width, height },
    deviceScaleFactor: SCALE,
    colorScheme: scheme,
    reducedMotion: 'reduce',
    hasTouch: width < 1000,
  });
  const page = await context.newPage();
  const noise = [];
  let url;
  page.on('console', (message) => isOfBrowser(message.text()) || noise.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => noise.push(`exception: ${error.message}`));
  page.on('request', (request) => {
    if (request.url() !== url && !request.url().startsWith('data:')) noise.push(`request: ${request.url()}`);
  });
  await page.addInitScript(init);
  const show = async (other) => {
    const leave = (dialog) => dialog.accept();
    page.on('dialog', leave);
    url = pathToFileURL(other).href;
    await page.goto(url);
    page.off('dialog', leave);
    await page.waitForFunction(() => window.spherechainViewer?.ready || document.querySelector('.template'));
  };
  await show(file);
  return { page, noise, show, close: () => context.close() };
}

export const silent = ({ noise }) => assert.deepEqual(noise, []);

// The picture of the character, after what was asked for is drawn: what its canvases hold, over the page's colour. To read
// them takes a quarter of the time of a screenshot.
export async function picture(page) {
  const text = await page.evaluate(async () => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const { width, height } = document.getElementById('view');
    const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
    context.fillStyle = getComputedStyle(document.body).backgroundColor;
    context.fillRect(0, 0, width, height);
    for (const id of ['view', 'overlay']) context.drawImage(document.getElementById(id), 0, 0, width, height);
    const reader = new FileReader();
    const read = new Promise((done) => (reader.onload = done));
    reader.readAsDataURL(new Blob([context.getImageData(0, 0, width, height).data]));
    await read;
    return reader.result;
  });
  return Buffer.from(text.slice(text.indexOf(',') + 1), 'base64');
}

// The share of pixels in which two pictures of one size differ.
export function compare(first, second) {
  assert.equal(first.length, second.length);
  let differing = 0;
  for (let i = 0; i < first.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs(first[i + k] - second[i + k]) > 8)) ++differing;
  }
  return differing / (first.length / 4);
}
