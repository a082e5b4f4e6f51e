// page_radiance.mjs: the viewer's reader of Radiance pictures (radiance.js), in Node and without a page,
// against OpenImageIO: pictures that oiiotool writes (plain below 8 columns, else run-length encoded by
// channel), and as it reads them. Run lengths by pixel, which OpenImageIO lacks, and damage are written
// here. Ends with 77 where oiiotool is missing.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

if (spawnSync('oiiotool', ['--help']).status !== 0) {
  console.log('skipped: oiiotool (openimageio-tools) is not installed');
  process.exit(77);
}
const here = dirname(fileURLToPath(import.meta.url));
const source = readFileSync(join(here, '../../lib/hshfit/gpu/viewer/radiance.js'), 'utf8');
const { readRadiance, Refused } = new Function(`${source}; return { readRadiance, Refused };`)();

const folder = mkdtempSync(join(tmpdir(), 'hshfit-radiance-'));
let failures = 0;
function expect(condition, text) {
  if (condition) return;
  ++failures;
  console.log(`FAILED: ${text}`);
}

// Pixels as oiiotool reads them, rows from above.
function pixelsOf(path) {
  const text = execFileSync('oiiotool', ['--dumpdata', path], { encoding: 'utf8', maxBuffer: 1 << 28 });
  return [...text.matchAll(/Pixel \(\d+, \d+\): (\S+) (\S+) (\S+)/g)].flatMap((row) => row.slice(1, 4).map(Number));
}

function same(name, { width, height, values }, expected) {
  const gap = expected.reduce((most, x, k) => Math.max(most, Math.abs(x - values[k]) / Math.max(Math.abs(x), 1e-6)), 0);
  console.log(`${name}: ${width} x ${height}, ${gap.toExponential(1)}`);
  expect(expected.length === values.length && gap < 1e-6, `${name} differs`);
}

try {
  for (const [name, size, pattern] of [
    ['noise', '40x20', 'noise:type=uniform:min=0:max=4:seed=3'],
    ['constant', '300x9', 'constant:color=0.5,2,8'],
    ['checker', '129x64', 'checker:width=7:height=5:color1=0,0,0:color2=3,100,0.001'],
    ['narrow', '7x3', 'noise:type=uniform:min=0:max=2:seed=5'],
    ['widest by channel', '32767x1', 'checker:width=100:height=1'],
  ]) {
    const path = join(folder, 'picture.hdr');
    execFileSync('oiiotool', ['--pattern', pattern, size, '3', '-o', path]);
    const bytes = new Uint8Array(readFileSync(path));
    const found = readRadiance(bytes);
    same(name, found, pixelsOf(path));
    const text = Buffer.from(bytes).toString('latin1');
    const first = text.indexOf('\n', text.indexOf('\n-Y') + 1) + 1;
    const byChannel = bytes[first] === 2 && bytes[first + 1] === 2;
    expect(byChannel === found.width >= 8, `${name} is not encoded as the test supposes`);
    // Every cut is refused, none read beyond its end.
    for (let k = 1; k < bytes.length; k += Math.ceil(bytes.length / 97)) {
      let refused = false;
      try {
        readRadiance(bytes.subarray(0, k));
      } catch (error) {
        refused = error instanceof Refused;
      }
      expect(refused, `${name}, cut at ${k}: not refused`);
    }
  }

  // Run lengths by pixel: mantissas 1, 1, 1 repeat the pixel before, 3 + 256 * 1 times here.
  const head = '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 262\n';
  const row = [[10, 20, 30, 129], [1, 1, 1, 3], [1, 1, 1, 1], [200, 100, 50, 120], [7, 8, 9, 136]];
  const plain = [[10, 20, 30, 129], ...Array(259).fill([10, 20, 30, 129]), [200, 100, 50, 120], [7, 8, 9, 136]];
  const bytes = new Uint8Array([...Buffer.from(head), ...row.flat(), ...row.flat()]);
  same('by pixel', readRadiance(bytes), [...plain, ...plain].flatMap(([r, g, b, e]) => [r, g, b].map((m) => m * 2 ** (e - 136))));
  for (const [name, text, pixels] of [
    ['a run beyond its row', '-Y 1 +X 2', [1, 2, 3, 129, 1, 1, 1, 9]],
    ['a run by channel beyond its row', '-Y 1 +X 8', [2, 2, 0, 8, 128 + 9, 1]],
    ['an empty run', '-Y 1 +X 8', [2, 2, 0, 8, 0, 1]],
    ['columns first', '+X 2 -Y 1', [1, 2, 3, 4, 5, 6, 7, 8]],
    ['no pixels', '-Y 0 +X 2', []],
  ]) {
    let said = '';
    try {
      readRadiance(new Uint8Array([...Buffer.from(`#?RADIANCE\n\n${text}\n`), ...pixels]));
    } catch (error) {
      said = error instanceof Refused ? error.message : '';
    }
    expect(said, `${name} goes unnoticed`);
    console.log(`${name}: ${said}`);
  }
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures > 0 ? 1 : 0);
