// node read_ktx2.mjs FILE…: reads KTX2 files with ktx-parse (node_modules of tests/gpu), writes
// the level of each to FILE.raw, and prints what its header says, JSON on a line.
import { readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const require = createRequire(new URL('../package.json', import.meta.url));
const { read } = await import(require.resolve('ktx-parse'));
for (const file of process.argv.slice(2)) {
  const texture = read(new Uint8Array(readFileSync(file)));
  writeFileSync(`${file}.raw`, texture.levels[0].levelData);
  const { vkFormat, typeSize, pixelWidth, pixelHeight, pixelDepth } = texture;
  const { layerCount, faceCount } = texture;
  const [descriptor] = texture.dataFormatDescriptor;
  const sidecar = new TextDecoder().decode(texture.keyValue['hshfit:sidecar']);
  console.log(JSON.stringify({
    vkFormat, typeSize, pixelWidth, pixelHeight, pixelDepth, layerCount, faceCount,
    levels: texture.levels.length, scheme: texture.supercompressionScheme,
    colorModel: descriptor.colorModel, colorPrimaries: descriptor.colorPrimaries,
    transferFunction: descriptor.transferFunction, bytesPlane0: descriptor.bytesPlane[0],
    samples: descriptor.samples.length, orientation: texture.keyValue.KTXorientation,
    sidecar: sidecar.replace(/\0$/, ''),
  }));
}
