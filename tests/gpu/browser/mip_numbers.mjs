// The texels of a filtered map (docs/explanation/filtered_maps.md) as the parameters of an engine's own
// material, in double precision.

const half = (bits) => {
  const [e, m] = [(bits >> 10) & 31, bits & 1023];
  return (bits & 0x8000 ? -1 : 1) * (e === 0 ? m * 2 ** -24 : (1 + m / 1024) * 2 ** (e - 15));
};

export const levelSize = ({ pixelWidth, pixelHeight }, level) => [
  Math.max(1, pixelWidth >> level),
  Math.max(1, pixelHeight >> level),
];

// The numbers of a level's texels that the target ktx2 writes: of a texel, and then of their place.
export function levelNumbers(file, level) {
  const [width, height] = levelSize(file, level);
  const words = new Uint16Array(file.levels[level].levelData.slice().buffer);
  return (texel) => (k) => half(words[(Math.floor(k / 4) * width * height + texel) * 4 + (k % 4)]);
}

// The widths of the lobe together with twice the variance of slopes, and the angle of the longer one.
// Both are stored as deviations along x and y with their correlation between.
export function widths(number) {
  const squares = (first) => [number(first) ** 2, number(first) * number(first + 1) * number(first + 2), number(first + 2) ** 2];
  const [spread, lobe] = [squares(5), squares(8)];
  const [xx, xy, yy] = spread.map((value, k) => lobe[k] + 2 * value);
  const middle = (xx + yy) / 2,
    apart = Math.hypot((xx - yy) / 2, xy);
  const width = (square) => Math.sqrt(Math.min(1, Math.max(0, square)));
  return { longer: width(middle + apart), shorter: width(middle - apart), angle: Math.atan2(xy, (xx - yy) / 2) / 2 };
}

// The unit normal of a texel.
export function normalOf(number) {
  const n = [0, 1, 2].map(number);
  return n.map((value) => value / Math.hypot(...n));
}
