// materials.mjs DRIVER PROGRAM FOLDER: three.js loads exported .glb files and lights them with one
// directional light; its values of f cos(theta_i) against the program's own of glTF's formula.
// three.js departs from that formula in three places, which are put back for the strict check and
// measured as they are for the printed one: Schlick's power is an exp2, facets that scatter twice
// are compensated for, and the roughness grows with the curvature of a pixel.
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join, normalize } from 'node:path';
import { expect, finish, here, withBrowser } from './browser.mjs';

const [driver, program, folder] = process.argv.slice(2);
const own = join(folder, `materials_${driver}`);
const types = { html: 'text/html', js: 'text/javascript' };

function files(path) {
  if (path === '/') return { contentType: 'text/html', body: page };
  const roots = { '/three/': join(here, '../node_modules/three'), '/files/': own };
  for (const [start, root] of Object.entries(roots)) {
    if (!path.startsWith(start) || path.includes('..')) continue;
    try {
      const body = readFileSync(normalize(join(root, path.slice(start.length))));
      return { contentType: types[path.split('.').pop()] ?? 'application/octet-stream', body };
    } catch {
      return null;
    }
  }
  return null;
}

const page = `<!DOCTYPE html><title>materials</title>
<script type="importmap">{"imports": {"three": "/three/build/three.module.js",
  "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
Object.assign(window, { THREE, GLTFLoader, ready: true });
</script>`;

// In the page: puts the formula of the specification in place of three.js' shortcuts.
function setFormula() {
  const chunk = THREE.ShaderChunk;
  const replaced = (name, from, to) => {
    if (!chunk[name].includes(from)) throw new Error(`three.js has changed: ${name}`);
    return chunk[name].replaceAll(from, to);
  };
  window.strictly = (material) => {
    const parts = {
      common: replaced('common', 'exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH )',
        'pow( max( 1.0 - dotVH, 0.0 ), 5.0 )'),
      lights_physical_pars_fragment: replaced('lights_physical_pars_fragment',
        '* material.multiScatteringCompensation;', ';'),
      lights_physical_fragment: replaced('lights_physical_fragment',
        'oughness += geometryRoughness', 'oughness += 0.0'),
    };
    material.onBeforeCompile = (shader) => {
      for (const [name, text] of Object.entries(parts))
        shader.fragmentShader = shader.fragmentShader.replace(`#include <${name}>`, text);
    };
    material.customProgramCacheKey = () => 'strict';
    return material;
  };
}

// In the page: f cos(theta_i) of a plane for each pair.
async function plane({ file, pairs, strict }) {
  const { scene: loaded } = await new GLTFLoader().loadAsync(file);
  let material;
  loaded.traverse((node) => { if (node.isMesh) material = node.material; });
  if (strict) material = window.strictly(material.clone());
  const renderer = new THREE.WebGLRenderer();
  const geometry = new THREE.PlaneGeometry(20, 20);
  geometry.setAttribute('tangent', new THREE.Float32BufferAttribute(
    Array.from({ length: 4 }, () => [1, 0, 0, 1]).flat(), 4));
  const light = new THREE.DirectionalLight(0xffffff, 1);
  const scene = new THREE.Scene().add(new THREE.Mesh(geometry, material), light);
  const camera = new THREE.OrthographicCamera(-0.001, 0.001, 0.001, -0.001, 0.1, 100);
  const target = new THREE.WebGLRenderTarget(2, 2, { type: THREE.FloatType });
  const pixels = new Float32Array(16), values = [];
  for (const [wi, wo] of pairs) {
    light.position.fromArray(wi).multiplyScalar(10);
    camera.position.fromArray(wo).multiplyScalar(10);
    camera.up.set(wo[2] > 0.9 ? 1 : 0, 0, wo[2] > 0.9 ? 0 : 1);
    camera.lookAt(0, 0, 0);
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
    renderer.readRenderTargetPixels(target, 0, 0, 2, 2, pixels);
    values.push([...pixels.slice(0, 3)]);
  }
  renderer.dispose();
  renderer.forceContextLoss();
  return { values, type: material.type };
}

// In the page: the file's own mesh, seen from +z, lit from `wi`; the pixels of those places.
async function mesh({ file, wi, size, strict, places }) {
  const { scene: loaded } = await new GLTFLoader().loadAsync(file);
  loaded.traverse((node) => {
    if (node.isMesh && strict) node.material = window.strictly(node.material.clone());
  });
  const renderer = new THREE.WebGLRenderer();
  const light = new THREE.DirectionalLight(0xffffff, 1);
  light.position.fromArray(wi).multiplyScalar(10);
  const scene = new THREE.Scene().add(loaded, light);
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 100);
  camera.position.set(0, 0, 10);
  const target = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType });
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  const pixels = new Float32Array(4 * size * size);
  renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels);
  renderer.dispose();
  renderer.forceContextLoss();
  return places.map((at) => [...pixels.slice(4 * at, 4 * at + 3)]);
}

const unit = (v) => v.map((x) => x / Math.hypot(...v));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0]];

// The program's f cos(theta_i).
function evaluated(spec, pairs) {
  const rows = pairs.map(([wi, wo]) => [...wi, ...wo].join(','));
  const input = join(own, 'pairs.csv'), output = join(own, 'values.csv');
  writeFileSync(input, `wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n${rows.join('\n')}\n`);
  rmSync(output, { force: true });
  execFileSync(program, ['eval', spec, '--pairs', input, '-o', output, '--cosine', '--quiet']);
  const [head, ...lines] = readFileSync(output, 'utf8').trim().split('\n');
  const names = head.split(',');
  const columns = ['r', 'g', 'b'].map((name) => names.indexOf(name));
  const grey = names.length - 1;
  return lines.map((line) => {
    const cells = line.split(',').map(Number);
    return columns.map((at) => cells[at < 0 ? grey : at]);
  });
}

// Largest and mean relative difference; values below a thousandth of the largest count as that.
function compared(found, expected) {
  const most = Math.max(...expected.flat());
  let largest = 0, sum = 0, squares = 0, energy = 0;
  expected.forEach((row, k) => row.forEach((value, c) => {
    const gap = Math.abs(found[k][c] - value);
    largest = Math.max(largest, gap / Math.max(value, 1e-3 * most));
    sum += gap / Math.max(value, 1e-3 * most);
    squares += gap * gap, energy += value * value;
  }));
  return { largest, mean: sum / expected.length / 3, l2: Math.sqrt(squares / energy) };
}

const pairs = [];
for (let k = 0; k < 240; ++k) {
  const at = (i, z0) => {
    const z = z0 + (1 - z0) * ((k * (i ? 0.754877666 : 0.569840291) + 0.5) % 1), s = Math.sqrt(1 - z * z);
    return [s * Math.cos(2.4 * k * (i + 1)), s * Math.sin(2.4 * k * (i + 1)), z];
  };
  const wo = at(0, 0.15);
  // A third of the pairs near the mirror direction.
  const wi = k % 3 ? at(1, 0.15) : unit([-wo[0] + 0.05 * Math.sin(k), -wo[1], wo[2]]);
  pairs.push([wi, wo]);
}

const cases = [
  ['dielectric', 'gltf-pbr:baseColorFactor=.8/.4/.1,metallicFactor=0,roughnessFactor=.35', true],
  ['metal', 'gltf-pbr:baseColorFactor=.9/.6/.2,roughnessFactor=.5', true],
  ['between', 'gltf-pbr:baseColorFactor=.9/.6/.2,metallicFactor=.4,roughnessFactor=.7', true],
  ['ior, specular',
    'gltf-pbr:baseColorFactor=.3/.5/.7,metallicFactor=0,roughnessFactor=.3,ior=2,specularFactor=.6',
    true],
  ['anisotropy',
    'gltf-pbr:baseColorFactor=.9/.6/.2,roughnessFactor=.4,anisotropyStrength=.7,' +
    'anisotropyRotation=.6', true],
  ['clearcoat',
    'gltf-pbr:baseColorFactor=.2/.05/.05,metallicFactor=0,roughnessFactor=.6,clearcoatFactor=.9,' +
    'clearcoatRoughnessFactor=.2', false],
  ['sheen',
    'gltf-pbr:baseColorFactor=.2/.1/.3,metallicFactor=0,roughnessFactor=.8,' +
    'sheenColorFactor=.5/.4/.6,sheenRoughnessFactor=.5', false],
];

await finish(() =>
  withBrowser(
    driver,
    async (on, complaints) => {
      rmSync(own, { recursive: true, force: true });
      mkdirSync(own, { recursive: true });
      await on.goto('http://localhost/');
      await on.waitForFunction(() => window.ready);
      await on.evaluate(setFormula);
      // Rasterisers move vertices to sixteenths of a pixel, hence large ones.
      const size = 512, step = 5, wi = unit([0.5, 0.4, 0.8]);
      // Pixels at which the sphere of the file is seen well inside its silhouette.
      const places = [], local = [];
      for (let y = 0; y < size; y += step)
        for (let x = 0; x < size; x += step) {
          const p = [(2 * x + 1) / size - 1, (2 * y + 1) / size - 1];
          const z2 = 1 - p[0] ** 2 - p[1] ** 2;
          if (z2 < 0.1) continue;
          const n = [p[0], p[1], Math.sqrt(z2)];
          if (dot(n, wi) < 0.1 || Math.abs(n[1]) > 0.95) continue;
          const t = unit([n[2], 0, -n[0]]), b = cross(n, t);
          const frame = (w) => [dot(w, t), dot(w, b), dot(w, n)];
          places.push(y * size + x);
          local.push([frame(wi), frame([0, 0, 1])]);
        }
      for (const [name, spec, strict] of cases) {
        const file = name.replaceAll(/[, ]+/g, '_');
        execFileSync(program, ['export', spec, '-o', own, '--target', 'gltf', '--name', file]);
        const expected = evaluated(spec, pairs), onSphere = evaluated(spec, local);
        const results = {};
        for (const mode of [true, false]) {
          const drawn = await on.evaluate(plane, { file: `/files/${file}.glb`, pairs, strict: mode });
          const seen = await on.evaluate(mesh,
            { file: `/files/${file}.glb`, wi, size, strict: mode, places });
          results[mode] = compared(drawn.values, expected);
          results[`sphere ${mode}`] = compared(seen, onSphere);
        }
        const percent = (x) => `${(100 * x).toFixed(2)} %`.padStart(9);
        const { true: formula, false: asIs } = results;
        console.log(`${name.padEnd(14)} formula: largest ${percent(formula.largest)}, sphere ` +
          `${percent(results['sphere true'].largest)}; as three draws it: largest ` +
          `${percent(asIs.largest)}, l2 ${percent(asIs.l2)}, sphere l2 ` +
          `${percent(results['sphere false'].l2)}`);
        if (!strict) continue;
        expect(formula.largest <= 0.01, `${name}: the formula differs by ${formula.largest}`);
        expect(results['sphere true'].largest <= 0.01,
          `${name}: on the file's sphere by ${results['sphere true'].largest}`);
      }
      // A file of another roughness has to be told apart.
      const other = evaluated('gltf-pbr:baseColorFactor=.9/.6/.2,roughnessFactor=.52', pairs);
      const drawn = await on.evaluate(plane, { file: '/files/metal.glb', pairs, strict: true });
      expect(compared(drawn.values, other).largest > 0.03, 'another roughness goes unnoticed');
      complaints
        .filter((text) => !/GPU stall|Context Lost/i.test(text))
        .forEach((text) => console.log(text));
    },
    { files },
  ),
);
