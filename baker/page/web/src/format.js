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
