// node read_levels.mjs FILE LEVEL X Y: the halves of a texel in every layer of a KTX2 file, as
// ktx-parse (node_modules of tests/gpu) finds its levels, and the sizes of all: JSON.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const require = createRequire(new URL('../gpu/package.json', import.meta.url));
const { read } = await import(require.resolve('ktx-parse'));
const [file, level, x, y] = process.argv.slice(2);
const texture = read(new Uint8Array(readFileSync(file)));
const data = texture.levels[level].levelData;
const width = Math.max(1, texture.pixelWidth >> level);
const height = Math.max(1, texture.pixelHeight >> level);
const view = new DataView(data.buffer, data.byteOffset, data.byteLength);
const half = (bits) => {
  const sign = bits >> 15 ? -1 : 1, exponent = (bits >> 10) & 31, part = bits & 1023;
  return sign * (exponent ? 2 ** (exponent - 15) * (1 + part / 1024) : 2 ** -24 * part);
};
const numbers = [];
for (let layer = 0; layer < texture.layerCount; ++layer) {
  const texel = (layer * height + Number(y)) * width + Number(x);
  for (let lane = 0; lane < 4; ++lane)
    numbers.push(half(view.getUint16(8 * texel + 2 * lane, true)));
}
console.log(JSON.stringify({
  vkFormat: texture.vkFormat, width: texture.pixelWidth, height: texture.pixelHeight,
  bytes: texture.levels.map((each) => each.levelData.byteLength), numbers,
}));
