// Arrays of the page's data, and lists of a frame each that lie in one array.

export function decode(base64, Type) {
  const text = atob(base64 ?? '');
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return new Type(bytes.buffer);
}

// Pairs of numbers: `of(frame)` is [a, b, a, b, ...]; or entries of another `width`.
export function pairLists(data, Type, width = 2) {
  const counts = decode(data?.counts, Uint32Array);
  const entries = decode(data?.entries, Type);
  const ends = [];
  let end = 0;
  for (const count of counts) ends.push((end += width * count));
  return { of: (frame) => entries.subarray(frame > 0 ? ends[frame - 1] : 0, ends[frame] ?? 0) };
}
