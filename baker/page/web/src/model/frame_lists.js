// Arrays of the page's data, and lists of a frame each that lie in one array.

export function decode(base64, Type) {
  const text = atob(base64 ?? '');
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return new Type(bytes.buffer);
}

// Entries of the same `width`: pairs of numbers, or more. `of(frame)` is [a, b, a, b, ...].
export function frameLists(data, Type) {
  const counts = decode(data?.counts, Uint32Array);
  const entries = decode(data?.entries, Type);
  const width = entries.length / Math.max(1, counts.reduce((sum, count) => sum + count, 0));
  const ends = [];
  let end = 0;
  for (const count of counts) ends.push((end += width * count));
  return { width, of: (frame) => entries.subarray(frame > 0 ? ends[frame - 1] : 0, ends[frame] ?? 0) };
}
