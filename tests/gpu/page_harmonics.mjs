// page_harmonics.mjs PROGRAM: the viewer's rotation and projection of light (harmonics.js), in Node
// and without a page, against those of the program, to 1e-6 of the largest coefficient.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const source = readFileSync(join(here, '../../lib/hshfit/gpu/viewer/harmonics.js'), 'utf8');
const { multiplied, projectLatlong, rotated, turnAndTilt } = new Function(
  `${source}; return { multiplied, projectLatlong, rotated, turnAndTilt };`,
)();

const program = resolve(process.argv[2]);
const folder = mkdtempSync(join(tmpdir(), 'hshfit-harmonics-'));
const run = (...words) => execFileSync(program, [...words, '--quiet'], { cwd: folder });
// [slot][R, G, B], of a file's [channel][slot].
const coefficientsOf = (name) => {
  const channels = JSON.parse(readFileSync(join(folder, name), 'utf8')).coefficients;
  return channels[0].flatMap((_, j) => channels.map((one) => one[j]));
};
let failures = 0;
function close(name, found, expected) {
  const most = Math.max(...expected.map(Math.abs));
  const gap = Math.max(...expected.map((x, k) => Math.abs(x - found[k]))) / most;
  console.log(`${name}: ${gap.toExponential(1)} of the largest`);
  if (!(gap < 1e-6) || found.length !== expected.length) {
    console.log(`FAILED: ${name}`);
    ++failures;
  }
}

const rad = Math.PI / 180;
const aboutZ = (a) => turnAndTilt(a * rad, 0);
const aboutX = (a) => turnAndTilt(0, a * rad);
// About y: x to z and z to x by quarter turns about x before and after.
const aboutY = (a) => multiplied(aboutX(-90), multiplied(aboutZ(a), aboutX(90)));

try {
  for (const [order, light] of [
    [10, 'panel:elevation=20,azimuth=200,width=60,height=30,radiance=5/1/2'],
    [4, 'directional:elevation=33,azimuth=71,irradiance=1/2/4'],
    [2, 'sky:type=12,elevation=40,azimuth=70,radiance=2/3/5'],
  ]) {
    run('light', light, '--order', String(order), '-o', 'light.json');
    const given = coefficientsOf('light.json');
    for (const [a, b, c] of [
      [30, 0, 0],
      [10, 50, -80],
      [0, 90, 0],
      [170, 180, 25],
      [-120, 3, 95],
    ]) {
      run('rotate', 'light.json', '-o', 'turned.json', '--force', `--euler=${a},${b},${c}`);
      const matrix = multiplied(aboutZ(a), multiplied(aboutY(b), aboutZ(c)));
      close(`order ${order}, Euler ${a}, ${b}, ${c}`, rotated(order, matrix, given),
        coefficientsOf('turned.json'));
    }
    rmSync(join(folder, 'light.json'));
    rmSync(join(folder, 'turned.json'));
  }

  // A picture of unrelated pixels, Radiance without run lengths: mantissas with one exponent.
  for (const [width, order] of [
    [2, 5],
    [32, 10],
    [200, 7],
  ]) {
    const height = width / 2,
      head = `#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`;
    const pixels = Buffer.alloc(4 * width * height);
    let state = 12345;
    for (let k = 0; k < pixels.length; ++k) {
      state = (state * 1103515245 + 12345) % 2147483648;
      pixels[k] = k % 4 === 3 ? 129 : 3 + (state >> 16) % 250;
    }
    writeFileSync(join(folder, 'noise.hdr'), Buffer.concat([Buffer.from(head), pixels]));
    run('light', 'noise.hdr:layout=latlong', '--order', String(order), '-o', 'noise.json');
    const values = Float64Array.from({ length: 3 * width * height }, (_, k) =>
      pixels[4 * Math.floor(k / 3) + (k % 3)] / 128,
    );
    close(`${width} x ${height} pixels, order ${order}`,
      projectLatlong(order, width, height, values, 3), coefficientsOf('noise.json'));
    rmSync(join(folder, 'noise.json'));
  }
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures > 0 ? 1 : 0);
