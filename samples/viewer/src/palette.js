// Okabe and Ito's palette, which the colour-blind can tell apart: regions in the order of the asset, as in samples/pictures.
export const REGIONS = ['#0072b2', '#e69f00', '#56b4e9', '#cc79a7', '#009e73'];
// Stands off from all five; contacts are also striped, ringed and numbered, so that no one needs to see it red.
export const WARNING = '#d41f2c';
export const POINTED = '#f0e442';
// Paul Tol's bright palette: lines over the colours above, told apart by their names at the ends too.
export const CHAINS = ['#4477aa', '#ee6677', '#228833', '#ccbb44', '#66ccee', '#aa3377'];

const NEUTRAL = '#9a9a9a';
export const regionColour = (region) => REGIONS[region] ?? NEUTRAL;
export const chainColour = (i) => CHAINS[i % CHAINS.length];
