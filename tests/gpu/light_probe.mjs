// light_probe.mjs PROGRAM: three.js' own LightProbe, given the numbers of the program, against the
// irradiance that the program states; relative to the mean to 1e-5. Ends with 77 where the npm
// packages are missing.
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const three = join(dirname(fileURLToPath(import.meta.url)), 'node_modules/three');
if (!existsSync(three)) {
  console.log('skipped: the npm packages are not installed: npm ci --ignore-scripts in tests/gpu');
  process.exit(77);
}
const { LightProbe, SphericalHarmonics3, Vector3 } = await import(
  pathToFileURL(join(three, 'build/three.module.js'))
);

// Real spherical harmonics in our world, +z up.
function functions(x, y, z) {
  const root = Math.sqrt;
  const k0 = root(1 / (4 * Math.PI));
  const k1 = root(3 / (4 * Math.PI));
  const k2 = root(15 / (4 * Math.PI));
  const k3 = root(5 / (16 * Math.PI));
  return [k0, k1 * y, k1 * z, k1 * x, k2 * x * y, k2 * y * z, k3 * (3 * z * z - 1), k2 * x * z,
    (k2 / 2) * (x * x - y * y)];
}

const lights = ['sky:type=12,elevation=40,azimuth=70,radiance=2/3/5',
  'panel:elevation=-20,azimuth=200,width=60,height=30,radiance=5/1/2',
  'directional:elevation=10,azimuth=-50,irradiance=1/2/3'];
let worst = 0;
for (const light of lights) {
  const answer = JSON.parse(execFileSync(process.argv[2],
    ['irradiance', light, '--convention', 'three', '--normals', '64', '--json']));
  const sh = new SphericalHarmonics3();
  sh.fromArray(answer.conventions[0].values.flat());
  const probe = new LightProbe(sh);
  const mean = answer.irradiance[0].reduce((a, b) => a + b) / 3 * Math.sqrt(1 / (4 * Math.PI));
  for (let k = 0; k < 200; ++k) {
    const z = 1 - (2 * k + 1) / 200;
    const s = Math.sqrt(1 - z * z);
    const [x, y] = [s * Math.cos(2.4 * k), s * Math.sin(2.4 * k)];
    const values = functions(x, y, z);
    const ours = [0, 1, 2].map((c) => values.reduce((sum, v, i) => sum + v * answer.irradiance[i][c], 0));
    // +z up to +y up: (x, z, -y).
    const theirs = probe.sh.getIrradianceAt(new Vector3(x, z, -y), new Vector3()).toArray();
    ours.forEach((value, c) => { worst = Math.max(worst, Math.abs(value - theirs[c]) / mean); });
  }
}
console.log(`largest difference ${worst.toExponential(2)} of the mean irradiance`);
process.exit(worst < 1e-5 ? 0 : 1);
