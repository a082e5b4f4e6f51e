// The scene of all trials: a unit sphere with its parallels about the axis that is up, one camera in
// perspective, one material, one light at a time; and its picture by `hshfit render`.
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect } from '../browser/browser.mjs';
import { difference, readExr } from './pictures.mjs';

export const here = dirname(fileURLToPath(import.meta.url));
export const project = resolve(here, '../../..');
const shared = resolve(project, '../shared/data');

// Materials by name; `halfway`: what the form is asked for.
export const materials = {
  paint: { spec: 'ggx:alpha=.25,F0=.9/.6/.3+lambert:kd=.05/.1/.2', halfway: ['--precision', 'half'] },
  brushed: { spec: 'ggx:ax=.2,ay=.4,F0=.9/.6/.3', halfway: ['--precision', 'half'] },
  sunflower: { spec: join(shared, 'rgl/cg_sunflower_rgb.bsdf'), halfway: ['--precision', 'half'] },
};

// Those whose data are there, or those that HSHFIT_TRIAL names, with commas.
export const names = (process.env.HSHFIT_TRIAL?.split(',') ?? Object.keys(materials)).filter(
  (name) => !materials[name].spec.startsWith('/') || existsSync(materials[name].spec),
);

// What engines are given, or that alone which HSHFIT_GIVEN names: our material, the glTF fit.
export const given = process.env.HSHFIT_GIVEN?.split(',') ?? ['ours', 'glTF'];

// z up: elevation and azimuth in degrees.
export const light = { elevation: 40, azimuth: 60, irradiance: 4 };
export const view = { theta: 75, azimuth: 0, angle: 30 };
export const picture = join(shared, 'env/rnl_probe_latlong.hdr');
export const turn = 40; // degrees about the axis that is up

const radians = Math.PI / 180;
const fromAngles = (elevation, azimuth) => [
  Math.cos(elevation * radians) * Math.cos(azimuth * radians),
  Math.cos(elevation * radians) * Math.sin(azimuth * radians),
  Math.sin(elevation * radians),
];
// +y up, right-handed.
export const upright = ([x, y, z]) => [x, z, -y];
export const towardsLight = fromAngles(light.elevation, light.azimuth);
// The sphere's outline is 0.96 of the picture's half edge (pictures/sphere.h).
const outline = 0.96;
export const reach = 1 / outline; // half a picture by parallel lines of sight
const slope = outline * Math.tan((view.angle / 2) * radians);
export const distance = Math.hypot(1, 1 / slope);
export const eye = fromAngles(90 - view.theta, view.azimuth).map((x) => distance * x);

export function run(program, ...words) {
  const found = spawnSync(program, words, { encoding: 'utf8', timeout: 300000 });
  if (found.status !== 0) throw new Error(`${program} ${words.join(' ')}: ${found.stderr ?? found.error}`);
  return found.stdout;
}

// The files of a material in `folder`: the form, and the exports of `targets`.
export function exported(hshfit, folder, name, targets) {
  mkdirSync(folder, { recursive: true });
  const { spec, halfway } = materials[name],
    form = join(folder, `${name}.json`);
  if (!existsSync(form)) run(hshfit, 'project', spec, '-o', form, '--form', 'halfway', ...halfway);
  run(hshfit, 'export', form, '-o', join(folder, name), '--target', targets, '--no-error', '--no-sampling', '--force');
  return join(folder, name);
}

// The .glb of the fit of glTF's material.
export function standard(hshfit, folder, name) {
  const path = join(folder, name, `${name}.glb`);
  if (!existsSync(path)) {
    run(hshfit, 'export', materials[name].spec, '-o', join(folder, name), '--target', 'gltf', '--name', name, '--force');
  }
  return path;
}

// The scene in the words of a page, +y up.
export const forPage = (kind) => ({
  kind,
  eye: upright(eye),
  angle: view.angle * radians,
  towards: upright(towardsLight),
  irradiance: light.irradiance,
  picture: '/shared/env/rnl_probe_latlong.hdr',
  turn,
});

// Waves of a normal map over the unit sphere: its normal in the frame along u, along v and outwards, u
// once around the axis that is up and v from its lower pole to its upper one, 0 to 1.
function bumpAt(u, v) {
  const steep = 0.3 * Math.sin(Math.PI * v) ** 2;
  const n = [-steep * Math.sin(2 * Math.PI * 14 * u), -steep * Math.sin(2 * Math.PI * 9 * v), 1];
  return n.map((x) => x / Math.hypot(...n));
}

// As a texture of bytes, row 0 at v = 0.
export function bumpTexels() {
  const [width, height] = [2048, 1024];
  const texels = Buffer.alloc(4 * width * height, 255);
  for (let row = 0; row < height; ++row)
    for (let column = 0; column < width; ++column)
      bumpAt((column + 0.5) / width, (row + 0.5) / height).forEach((x, k) => {
        texels[4 * (row * width + column) + k] = Math.round(127.5 * (x + 1));
      });
  return { width, height, texels: texels.toString('base64') };
}

// A unit sphere as a mesh, z up, as three.js' SphereGeometry has it; its normals in that frame.
export function writeBall(path, normalAt = () => [0, 0, 1]) {
  const [around, down] = [512, 256];
  const lines = [];
  for (let row = 0; row <= down; ++row)
    for (let column = 0; column <= around; ++column) {
      const [u, v] = [column / around, 1 - row / down];
      const [phi, theta] = [2 * Math.PI * u, Math.PI * (1 - v)];
      const out = [-Math.cos(phi) * Math.sin(theta), -Math.sin(phi) * Math.sin(theta), Math.cos(theta)];
      const along = [Math.sin(phi), -Math.cos(phi), 0];
      const above = [Math.cos(phi) * Math.cos(theta), Math.sin(phi) * Math.cos(theta), Math.sin(theta)];
      const [a, b, c] = normalAt(u, v);
      lines.push(`v ${out.map((x) => x.toFixed(7)).join(' ')}`, `vt ${u} ${v}`);
      lines.push(`vn ${out.map((x, k) => (a * along[k] + b * above[k] + c * x).toFixed(6)).join(' ')}`);
    }
  const corner = (row, column) => {
    const k = row * (around + 1) + column + 1;
    return `${k}/${k}/${k}`;
  };
  for (let row = 0; row < down; ++row)
    for (let column = 0; column < around; ++column) {
      const [a, b, c, d] = [corner(row, column), corner(row, column + 1), corner(row + 1, column + 1), corner(row + 1, column)];
      if (row > 0) lines.push(`f ${a} ${d} ${b}`);
      if (row < down - 1) lines.push(`f ${b} ${d} ${c}`);
    }
  writeFileSync(path, `${lines.join('\n')}\n`);
}

const lights = {
  direct: `directional:elevation=${light.elevation},azimuth=${light.azimuth},irradiance=${light.irradiance}`,
  environment: `${picture}:turn=${turn}`,
  bumps: `${picture}:turn=${turn}`,
};

// `hshfit render` of a BRDF, kept in `folder` under a name.
async function rendered(hshfit, folder, name, spec, kind, size) {
  mkdirSync(folder, { recursive: true });
  const path = join(folder, `${name}-${kind}-${size}.exr`);
  if (!existsSync(path)) {
    const words = ['--light', lights[kind], '--by', 'integration', '--view', `${view.theta},${view.azimuth}`];
    const error = kind === 'direct' ? [] : ['--error', '2%'];
    const shape = kind === 'bumps' ? ['--mesh', join(folder, 'bumps.obj'), '--up', 'z'] : ['--field-of-view', `${view.angle}`];
    if (kind === 'bumps' && !existsSync(shape[1])) writeBall(shape[1], bumpAt);
    run(hshfit, 'render', spec, ...words, ...shape, '--size', `${size}`, '--samples', '3', ...error, '-o', path);
  }
  return readExr(path);
}

// Pictures of the source, of the form and of the glTF fit, which the engines are given.
export async function references(hshfit, folder, name, kind, size) {
  const fitted = () => {
    const bytes = readFileSync(standard(hshfit, folder, name));
    const glb = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
    return glb.materials[0].extras.hshfit.spec;
  };
  return {
    source: await rendered(hshfit, folder, name, materials[name].spec, kind, size),
    ours: await rendered(hshfit, folder, `${name}-form`, join(folder, `${name}.json`), kind, size),
    glTF: given.includes('glTF') ? await rendered(hshfit, folder, `${name}-gltf`, fitted(), kind, size) : null,
  };
}

// Prints the errors of a picture against the source and against what the engine was given, and
// returns the pair for a sheet. A sky behind the sphere does not count.
export function judged(engine, { name, kind, given }, expected, found) {
  const seen = { size: found.size, pixels: found.pixels.map((value, k) => (expected.source.pixels[k - (k % 4) + 3] > 0 ? value : 0)) };
  const whole = difference(expected.source, seen),
    own = difference(expected[given], seen);
  const percent = (x) => `${(100 * x).toFixed(2)} %`;
  console.log(
    `${[engine, name, kind, given].join(', ').padEnd(44)} relative L2 ${percent(whole.l2)}; ` +
      `against what it was given ${percent(own.l2)}, gain ${own.gain.toFixed(3)}`,
  );
  // Direct light is evaluated, and differs by the mesh, the samples and single precision alone, most in narrow
  // highlights; light from all around is looked up.
  if (given === 'ours') expect(own.l2 < (kind === 'direct' ? 0.05 : 0.2), `${engine}, ${name}, ${kind} differs`);
  return { expected: expected.source, found: seen };
}

const blank = `<!DOCTYPE html><title>trial</title><canvas id="c" width="64" height="64"></canvas>
<script type="importmap">{"imports": {"three": "/three/build/three.module.js", "three/webgpu": "/three/build/three.webgpu.js",
"three/tsl": "/three/build/three.tsl.js", "three/addons/": "/three/examples/jsm/"}}</script>`;

// Answers of the local web server that withBrowser() plays: /npm/, /three/, /files/ and /shared/.
export function server(folder) {
  const types = { js: 'text/javascript', mjs: 'text/javascript', wasm: 'application/wasm', html: 'text/html' };
  return (path) => {
    if (path === '/') return { contentType: 'text/html', body: blank };
    const [, place, ...rest] = path.split('/');
    const roots = { npm: join(here, 'node_modules'), three: join(here, '../node_modules/three'), files: folder, shared };
    if (!roots[place]) return null;
    try {
      const body = readFileSync(join(roots[place], ...rest));
      return { contentType: types[path.split('.').pop()] ?? 'application/octet-stream', body };
    } catch {
      return null;
    }
  };
}

export const readJson = (path) => JSON.parse(readFileSync(path, 'utf8'));
