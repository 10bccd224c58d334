// Browser helpers for tests: pages that must stay silent, pictures, and how much two pictures differ.
import assert from 'node:assert/strict';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

// Pixels are drawn by software, which takes most of the time: one sample for each takes a third of the time of four.
export const launch = (executablePath) =>
  chromium.launch({
    executablePath,
    args: [
      '--no-sandbox',
      '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader',
      '--ignore-gpu-blocklist',
      '--webgl-antialiasing-mode=none',
    ],
  });

export const SCALE = 0.35;

// Opens a page from disk; `noise` collects what no page may do: write to the console, fail, or ask for another file.
export async function open(browser, file, { width = 1280, height = 720, scheme = 'light', init } = {}) {
  const context = await browser.newContext({
    viewport: { width, height },
    deviceScaleFactor: SCALE,
    colorScheme: scheme,
    reducedMotion: 'reduce',
    hasTouch: width < 1000,
  });
  const page = await context.newPage();
  const url = pathToFileURL(file).href;
  const noise = [];
  page.on('console', (message) => noise.push(`${message.type()}: ${message.text()}`));
  page.on('pageerror', (error) => noise.push(`exception: ${error.message}`));
  page.on('request', (request) => {
    if (request.url() !== url && !request.url().startsWith('data:')) noise.push(`request: ${request.url()}`);
  });
  if (init) await page.addInitScript(init);
  await page.goto(url);
  await page.waitForFunction(() => window.spherechainViewer?.ready || document.querySelector('.template'));
  return { page, noise, close: () => context.close() };
}

export const silent = ({ noise }) => assert.deepEqual(noise, []);

// The picture of the character, after what was asked for is drawn.
export async function picture(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
  return (await page.locator('main').screenshot()).toString('base64');
}

// The share of pixels that differ, and the mean lightness of the second picture from 0 to 1.
export function compare(page, first, second) {
  return page.evaluate(
    async (pictures) => {
      const [a, b] = await Promise.all(
        pictures.map(async (base64) => {
          const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
          const bitmap = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
          const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
          context.drawImage(bitmap, 0, 0);
          return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
        }),
      );
      let differing = 0;
      let light = 0;
      for (let i = 0; i < b.length; i += 4) {
        if ([0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > 8)) ++differing;
        light += b[i] + b[i + 1] + b[i + 2];
      }
      return { differing: differing / (b.length / 4), light: light / (3 * 255 * (b.length / 4)) };
    },
    [first, second],
  );
}
