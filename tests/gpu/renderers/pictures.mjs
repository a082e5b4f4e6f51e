// Float pictures of the trials: read, compared and put on a sheet. A picture is
// { size, pixels: Float32Array of RGBA, rows from the bottom up }.
import { readFileSync, writeFileSync } from 'node:fs';
import { deflateSync } from 'node:zlib';

// Of an OpenEXR file; three.js gives rows from the bottom up.
export async function readExr(path) {
  const { EXRLoader } = await import('three/examples/jsm/loaders/EXRLoader.js');
  const { FloatType } = await import('three');
  const bytes = readFileSync(path);
  const loader = new EXRLoader();
  loader.setDataType(FloatType);
  const { data, width, height } = loader.parse(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  if (width !== height) throw new Error(`${path}: ${width} x ${height} pixels; a square was expected`);
  return { size: width, pixels: new Float32Array(data) };
}

// The mean of k x k pixels, of which uncovered ones are 0.
export function reduced({ size, pixels }, k) {
  const small = size / k,
    result = new Float32Array(4 * small * small);
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size; ++x) {
      const to = 4 * (Math.floor(y / k) * small + Math.floor(x / k));
      for (let c = 0; c < 4; ++c) result[to + c] += pixels[4 * (y * size + x) + c] / (k * k);
    }
  }
  return { size: small, pixels: result };
}

// The relative L2 of a picture from the one that is right, and its gain: the factor that would bring
// it nearest.
export function difference(expected, found) {
  if (expected.size !== found.size) throw new Error(`${found.size} pixels, not ${expected.size}`);
  let wrong = 0,
    all = 0,
    mixed = 0,
    own = 0;
  for (let k = 0; k < expected.pixels.length; ++k) {
    if (k % 4 === 3) continue;
    const [a, b] = [expected.pixels[k], found.pixels[k]];
    wrong += (a - b) ** 2;
    all += a * a;
    mixed += a * b;
    own += b * b;
  }
  return { l2: Math.sqrt(wrong / all), gain: mixed / own };
}

const encoded = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);

/// The checksum of PNG chunks (ISO 3309), which zlib of Node 18 does not give.
function crc32(bytes) {
  let rest = 0xffffffff;
  for (const byte of bytes) {
    rest ^= byte;
    for (let bit = 0; bit < 8; ++bit) rest = (rest >>> 1) ^ (rest & 1 ? 0xedb88320 : 0);
  }
  return ~rest >>> 0;
}

function png(width, height, rgb) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const size = Buffer.alloc(4),
      check = Buffer.alloc(4);
    size.writeUInt32BE(data.length);
    check.writeUInt32BE(crc32(body));
    return Buffer.concat([size, body, check]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const rows = [];
  // Each row as differences from the pixel to the left (filter 1), which compress better.
  for (let y = 0; y < height; ++y) {
    const row = rgb.subarray(3 * width * y, 3 * width * (y + 1));
    rows.push(Buffer.from([1]), row.map((value, k) => value - (k < 3 ? 0 : row[k - 3])));
  }
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return Buffer.concat([
    signature,
    chunk('IHDR', head),
    chunk('IDAT', deflateSync(Buffer.concat(rows), { level: 9 })),
    chunk('IEND', Buffer.alloc(0)),
  ]);
}

// The radiance below which 99 % of the lit numbers lie, as 0.9 of white.
const exposureOf = ({ pixels }) => {
  const lit = pixels.filter((value, k) => k % 4 !== 3 && value > 0).sort();
  return 0.9 / lit[Math.floor(0.99 * (lit.length - 1))];
};

// The mean difference of what is shown, both exposed as the right one: of sRGB from 0 to 1, over
// pixels that are not black in the right one.
export function shownDifference(expected, found) {
  const scale = exposureOf(expected);
  const shown = (value) => encoded(Math.min(Math.max(scale * value, 0), 1));
  let sum = 0,
    count = 0;
  expected.pixels.forEach((value, k) => {
    if (k % 4 === 3 || value <= 0) return;
    sum += Math.abs(shown(value) - shown(found.pixels[k]));
    ++count;
  });
  return sum / count;
}

// Puts a picture into 8 bits of a wide one, `left` and `top` in pixels.
function put(rgb, width, left, top, { size, pixels }, scale) {
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x)
      for (let c = 0; c < 3; ++c) {
        const value = encoded(Math.min(Math.max(scale * pixels[4 * (y * size + x) + c], 0), 1));
        rgb[3 * ((top + size - 1 - y) * width + left + x) + c] = Math.round(255 * value);
      }
}

// Pairs of { expected, found } in rows of `columns`: all found pictures, and below them those that
// are right, each pair exposed as the right one.
export function writeMosaic(path, pairs, columns) {
  const side = pairs[0].expected.size,
    width = columns * side,
    height = Math.ceil(pairs.length / columns) * side;
  const rgb = Buffer.alloc(6 * width * height);
  pairs.forEach(({ expected, found }, k) => {
    const [left, top] = [(k % columns) * side, Math.floor(k / columns) * side];
    put(rgb, width, left, top, found, exposureOf(expected));
    put(rgb, width, left, top + height, expected, exposureOf(expected));
  });
  writeFileSync(path, png(width, 2 * height, rgb));
}

// A sheet of rows of [right, found] pairs, each followed by four times the difference; exposed as the
// right one.
export function writeSheet(path, rows) {
  const side = rows[0][0].expected.size,
    width = Math.max(...rows.map((row) => row.length)) * 3 * side,
    height = rows.length * side;
  const rgb = Buffer.alloc(3 * width * height, 24);
  rows.forEach((row, r) =>
    row.forEach(({ expected, found }, column) => {
      const scale = exposureOf(expected),
        left = 3 * side * column;
      const gap = found.pixels.map((value, k) => 4 * Math.abs(value - expected.pixels[k]));
      put(rgb, width, left, r * side, expected, scale);
      put(rgb, width, left + side, r * side, found, scale);
      put(rgb, width, left + 2 * side, r * side, { size: side, pixels: gap }, scale);
    }),
  );
  writeFileSync(path, png(width, height, rgb));
}
