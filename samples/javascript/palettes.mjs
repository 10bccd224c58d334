// SPDX-License-Identifier: MIT
// Reads what samples/csharp/write_palettes wrote: an engine's joints, and its palettes.

// `bytes`: an ArrayBuffer. Matrices are 16 floats by columns.
export function readPalettes(bytes) {
  const view = new DataView(bytes);
  let at = 0;
  const number = () => view.getInt32((at += 4) - 4, true);
  const text = () => {
    const length = number();
    return new TextDecoder().decode(new Uint8Array(bytes, (at += length) - length, length));
  };
  const floats = count => new Float32Array(bytes.slice((at += 4 * count) - 4 * count, at));

  const jointCount = number(), frameCount = number();
  const joints = Array.from({ length: jointCount }, () => ({ name: text(), inverseBind: floats(16) }));
  const rest = floats(16 * jointCount);
  const frames = Array.from({ length: frameCount }, () => floats(16 * jointCount));
  return { joints, rest, frames };
}
