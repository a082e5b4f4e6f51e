// three.mjs DRIVER FOLDER: three.js loads the exported files and draws with the snippet.
import { readFileSync } from 'node:fs';
import { join, normalize } from 'node:path';
import { decoded, differences, expect, finish, here, readJson, withBrowser } from './browser.mjs';

const [driver, folder] = process.argv.slice(2);
const types = { html: 'text/html', js: 'text/javascript', json: 'application/json' };

// http://localhost/three/… is the package, /files/… the export.
function files(path) {
  if (path === '/') return { contentType: 'text/html', body: page };
  const roots = {
    '/three/': join(here, '../node_modules/three'),
    '/files/': join(folder, 'three'),
  };
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

const page = `<!DOCTYPE html><title>three</title>
<script type="importmap">{"imports": {"three": "/three/build/three.module.js",
  "three/addons/": "/three/examples/jsm/"}}</script>
<script type="module">
import * as THREE from 'three';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
Object.assign(window, { THREE, EXRLoader, KTX2Loader, ready: true });
</script>`;

// In the page: how each file becomes a texture array of half floats.
function setLoaders() {
  const arrayOf = (halves, { width, height, layers }) => {
    const texture = new THREE.DataArrayTexture(halves, width, height, layers);
    texture.format = THREE.RGBAFormat;
    texture.type = THREE.HalfFloatType;
    texture.minFilter = texture.magFilter = THREE.LinearFilter;
    texture.needsUpdate = true;
    return texture;
  };
  // EXRLoader reverses rows; in a strip that reverses the layers too.
  const strip = async (file, shape, unflip) => {
    const { data, width, height } = (await new EXRLoader().loadAsync(file)).image;
    const halves = new Uint16Array(data.length);
    for (let y = 0; y < height; ++y) {
      const from = unflip ? height - 1 - y : y;
      halves.set(data.subarray(4 * width * from, 4 * width * (from + 1)), 4 * width * y);
    }
    return arrayOf(halves, shape);
  };
  window.loaders = {
    bin: async (file, shape) =>
      arrayOf(new Uint16Array(await (await fetch(file)).arrayBuffer()), shape),
    js: async (file, shape) => {
      const module = await import(file);
      if (module.metadata.format !== 'hshfit-gpu') throw new Error('no metadata');
      return arrayOf(module.coefficients, shape);
    },
    exr: (file, shape) => strip(file, shape, true),
    'exr as loaded': (file, shape) => strip(file, shape, false),
  };
}

// In the page: every pair a pixel, evalRaw of the snippet, with a renderer of its own.
async function draw({ loader, file, shape, snippet, inputs, side }) {
  const renderer = new THREE.WebGLRenderer();
  const texture = await window.loaders[loader](file, shape);
  const values = new Float32Array(Uint8Array.from(atob(inputs), (c) => c.charCodeAt(0)).buffer);
  const vectors = (first) => {
    const data = Float32Array.from({ length: 4 * side * side }, (_, i) =>
      i % 4 === 3 ? 0 : values[6 * (i >> 2) + first + (i % 4)],
    );
    const made = new THREE.DataTexture(data, side, side, THREE.RGBAFormat, THREE.FloatType);
    made.needsUpdate = true;
    return made;
  };
  const material = new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3,
    depthTest: false,
    uniforms: {
      hsh_coefficients: { value: texture },
      wos: { value: vectors(0) },
      wis: { value: vectors(3) },
    },
    vertexShader: 'in vec3 position; void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: `${snippet}
      uniform highp sampler2D wos, wis;
      out vec4 result;
      void main() {
        ivec2 at = ivec2(gl_FragCoord.xy);
        result = vec4(hsh_evalRaw(texelFetch(wos, at, 0).xyz, texelFetch(wis, at, 0).xyz), 1.0);
      }`,
  });
  const scene = new THREE.Scene().add(new THREE.Mesh(new THREE.PlaneGeometry(2, 2), material));
  const target = new THREE.WebGLRenderTarget(side, side, { type: THREE.FloatType });
  renderer.setRenderTarget(target);
  renderer.render(scene, new THREE.Camera());
  const pixels = new Float32Array(4 * side * side);
  renderer.readRenderTargetPixels(target, 0, 0, side, side, pixels);
  const error = renderer.getContext().getError();
  renderer.dispose();
  renderer.forceContextLoss();
  if (error) throw new Error(`WebGL error ${error}`);
  return [...pixels];
}

await finish(() =>
  withBrowser(
    driver,
    async (on, complaints) => {
      const sidecar = readJson(join(folder, 'three/material.hsh.json'));
      const job = readJson(join(folder, 'case1.json'));
      const expected = decoded(job.expected, Float64Array);
      const { width, height, layers } = job.coefficients;
      // The snippet without the main that the other checks put around it.
      const snippet = readFileSync(join(folder, 'three/material_hsh.glsl'), 'utf8');
      await on.goto('http://localhost/');
      await on.waitForFunction(() => window.ready);
      await on.evaluate(setLoaders);
      const pathOf = (suffix) => {
        const found = sidecar.files.map(({ path }) => path).find((path) => path.endsWith(suffix));
        return `/files/${found}`;
      };
      const outputs = 2 * job.channels + job.lights;
      const differenceOf = async (loader, suffix) => {
        const pixels = await on.evaluate(draw, {
          loader,
          file: pathOf(suffix),
          snippet,
          inputs: job.inputs,
          shape: { width, height, layers },
          side: job.side,
        });
        const found = new Float32Array(expected.length),
          known = expected.slice();
        for (let k = 0; k < pixels.length / 4; ++k) {
          for (let c = 0; c < job.channels; ++c) found[k * outputs + c] = pixels[4 * k + c];
          known.fill(NaN, k * outputs + job.channels, (k + 1) * outputs);
        }
        return differences(job, known, found).eval;
      };
      expect(sidecar.map.size[0] === width && width !== height, 'the map is square');
      for (const [loader, suffix] of [
        ['bin', '.bin'],
        ['js', '.js'],
        ['exr', '.exr'],
      ]) {
        const d = await differenceOf(loader, suffix);
        console.log(`${loader.padEnd(16)} ${d.toExponential(1)}`);
        expect(d <= 2e-6, `${loader}: differs by ${d}`);
      }
      const d = await differenceOf('exr as loaded', '.exr');
      console.log(
        `${'exr as loaded'.padEnd(16)} ${d.toExponential(1)}, as it has to be`,
      );
      expect(d > 1e-2, 'rows turned round go unnoticed');
      const kind = await on.evaluate(async (path) => {
        const renderer = new THREE.WebGLRenderer();
        const loader = new KTX2Loader();
        loader.detectSupport(renderer);
        try {
          const texture = await loader.loadAsync(path);
          return texture.isDataArrayTexture ? 'an array' : `a ${texture.constructor.name}`;
        } catch (error) {
          return `refused: ${error.message ?? error}`;
        }
      }, pathOf('.ktx2'));
      console.log(`KTX2Loader makes of the array: ${kind}`);
      complaints
        .filter((text) => !/GPU stall|Context Lost/i.test(text))
        .forEach((text) => console.log(text));
    },
    { files },
  ),
);
