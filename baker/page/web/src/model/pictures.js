// The skin's pictures, decoded by the browser into one array texture: all of one size, one after another. Where one cannot be
// decoded its layer stays white.

async function decodeOne(url, context, size) {
  context.clearRect(0, 0, size, size);
  const image = Object.assign(new Image(), { src: url });
  try {
    await image.decode();
  } catch {
    return null;
  }
  context.drawImage(image, 0, 0, size, size);
  return context.getImageData(0, 0, size, size).data;
}

export async function decodePictures({ look }) {
  if (!look || look.pictures.length === 0) return;
  const size = 512; // as page_look.cpp has it
  const canvas = Object.assign(document.createElement('canvas'), { width: size, height: size });
  const context = canvas.getContext('2d', { willReadFrequently: true });
  const layer = 4 * size * size;
  const pixels = new Uint8Array(layer * look.pictures.length).fill(255);
  for (const [i, url] of look.pictures.entries()) {
    const data = await decodeOne(url, context, size);
    if (data) pixels.set(data, i * layer);
  }
  look.array = { pixels, size, count: look.pictures.length };
}
