// Okabe and Ito's palette, which the colour-blind can tell apart: regions in the order of the asset, as in samples/pictures.
export const REGIONS = ['#0072b2', '#e69f00', '#56b4e9', '#cc79a7', '#009e73'];
// Contacts are also striped and numbered, so that no one needs to see them red.
export const CONTACT = '#d41f2c';
export const FALSE_ALARM = '#e59400';
export const SPHERE = '#8497ab';
export const COLLIDER = '#2f7fd6';
export const CLAY = '#c9c2b6';
export const GHOST = '#6d7278';
export const ANIMATED = '#2f6fd6'; // a ghost that lies in other skin
export const POINTED = '#f0e442';
export const LAYERS = ['#c9c2b6', '#e69f00', '#0072b2']; // of a mask: uncovered, covered, hidden
export const EDITED = { changed: '#e69f00', added: '#009e73', deleted: '#d41f2c' };
// Paul Tol's bright palette: lines over the colours above, recognised by their names at the ends too.
export const CHAINS = ['#4477aa', '#ee6677', '#228833', '#ccbb44', '#66ccee', '#aa3377'];

export const regionColour = (region) => (region < 0 ? SPHERE : REGIONS[region % REGIONS.length]);
export const chainColour = (i) => CHAINS[i % CHAINS.length];

// A lighter or darker tone, so that neighbours of one colour differ.
export function tone(colour, i) {
  const by = [1, 0.72, 1.22][i % 3];
  const channels = [1, 3, 5].map((at) => Math.min(255, Math.round(parseInt(colour.slice(at, at + 2), 16) * by)));
  return `#${channels.map((value) => value.toString(16).padStart(2, '0')).join('')}`;
}
