// Numbers as text.

// Four significant digits at most, no exponent where people would not write one.
export function number(value) {
  if (typeof value !== 'number') return '–';
  if (Number.isInteger(value)) return value.toLocaleString('en');
  return Math.abs(value) < 1e-4 ? value.toExponential(2) : `${Number(value.toPrecision(4))}`;
}

// A frame's number: one that lies between two has a fraction.
export const frameNumber = (value) => (Number.isInteger(value) ? `${value}` : value.toFixed(2));

export const percent = (share) => `${(100 * share).toFixed(2)} %`;

// A length: in source units, and as a share of the character's height.
export const length = (value, height) => (value === null ? '–' : `${number(value)} · ${percent(value / height)}`);

export const plural = (count, word) => `${count.toLocaleString('en')} ${word}${count === 1 ? '' : 's'}`;

// Names without what all of them begin with, up to its last separator. A short start stays.
export function withoutCommonStart(names) {
  const differ = names[0].split('').findIndex((letter, i) => names.some((name) => name[i] !== letter));
  const start = names[0].slice(0, Math.max(differ, 0)).match(/^.*[^\p{L}\p{N}]/u)?.[0] ?? '';
  return start.length < 8 || names.includes(start) ? names : names.map((name) => name.slice(start.length));
}
