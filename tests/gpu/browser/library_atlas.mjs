// library_atlas.mjs DRIVER PROGRAM LIBRARY LIGHT.hdr FOLDER: a sphere of each material of a library in
// one draw call, by `library export --target three`, under a picture of light. Prints bytes, draw calls and the
// processor time of a frame beside three's own MeshPhysicalMaterial in its place, and the differences
// of the spheres from `hshfit render`, which needs seconds for each. DRIVER webgpu: the node material. FOLDER has the export, also for a second
// run, and library_atlas.png: above by three.js, below by `render`.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, statSync } from 'node:fs';
import { basename, join, normalize, resolve } from 'node:path';
import { decoded, expect, finish, here, readJson, withBrowser } from './browser.mjs';
import { difference, readExr, shownDifference, writeMosaic } from '../renderers/pictures.mjs';

const [driver, program, library, light, folder] = process.argv.slice(2).map((word, k) => (k ? resolve(word) : word));
const name = basename(library).replace(/\.[^.]*$/, '');
const side = 56,
  columns = 12,
  elevation = 75, // of the direction to the viewer, degrees from the zenith
  frames = 10;

const blank = `<!DOCTYPE html><title>atlas</title><script type="importmap">{"imports": {
  "three": "/three/build/three.module.js", "three/webgpu": "/three/build/three.webgpu.js",
  "three/tsl": "/three/build/three.tsl.js", "three/addons/": "/three/examples/jsm/"}}</script>`;

function files(path) {
  if (path === '/') return { contentType: 'text/html', body: blank };
  if (path === '/light.hdr') return { contentType: 'application/octet-stream', body: readFileSync(light) };
  if (path.includes('..')) return null;
  const root = path.startsWith('/three/') ? join(here, '../node_modules') : folder;
  const body = readFileSync(normalize(join(root, path)));
  return { contentType: path.endsWith('.js') ? 'text/javascript' : 'application/octet-stream', body };
}

// In the page: spheres in a grid across parallel lines of sight, as floats.
async function draw({ name, gpu, side, columns, elevation }) {
  const three = await import(gpu ? 'three/webgpu' : 'three');
  const { HDRLoader } = await import('three/addons/loaders/HDRLoader.js');
  const { material, materials } = await import(`/${name}_three${gpu ? '_webgpu' : ''}.js`);
  const rows = Math.ceil(materials.length / columns);
  const renderer = gpu ? new three.WebGPURenderer() : new three.WebGLRenderer();
  if (gpu) await renderer.init();
  renderer.setSize(columns * side, rows * side, false);
  const scene = new three.Scene();
  scene.environment = await new HDRLoader().setDataType(three.FloatType).loadAsync('/light.hdr');
  scene.environment.mapping = three.EquirectangularReflectionMapping;
  const angle = (elevation * Math.PI) / 180;
  const towards = new three.Vector3(Math.sin(angle), Math.cos(angle), 0);
  const up = new three.Vector3(-Math.cos(angle), Math.sin(angle), 0),
    right = new three.Vector3(0, 0, -1);
  const geometry = new three.SphereGeometry(1, 40, 24);
  geometry.setAttribute('materialIndex',
    new three.InstancedBufferAttribute(Float32Array.from(materials.keys()), 1));
  const mesh = new three.InstancedMesh(geometry, material({ indices: true }), materials.length);
  materials.forEach((_, k) => {
    const place = new three.Vector3();
    place.addScaledVector(right, 2 * (k % columns) + 1 - columns);
    place.addScaledVector(up, rows - 1 - 2 * Math.floor(k / columns));
    mesh.setMatrixAt(k, new three.Matrix4().setPosition(place));
  });
  scene.add(mesh);
  const lamp = new three.DirectionalLight(0xffffff, 3);
  lamp.visible = false;
  lamp.position.set(3, 4, 2);
  scene.add(lamp);
  const camera = new three.OrthographicCamera(-columns, columns, rows, -rows, 1, 40);
  camera.position.copy(towards).multiplyScalar(20);
  camera.lookAt(0, 0, 0);

  const [width, height] = [columns * side, rows * side];
  const target = new (gpu ? three.RenderTarget : three.WebGLRenderTarget)(width, height, { type: three.FloatType });
  const read = async (across, up) => {
    if (gpu) return renderer.readRenderTargetPixelsAsync(target, 0, 0, across, up);
    const found = new Float32Array(4 * across * up);
    renderer.readRenderTargetPixels(target, 0, 0, across, up, found);
    return found;
  };
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  renderer.render(scene, camera); // the first prefilters the light, too
  const { render } = renderer.info;
  const calls = { calls: gpu ? render.drawCalls : render.calls, triangles: render.triangles };
  const found = await read(width, height);
  // Rows of WebGPU come from above, and are padded.
  const pixels = new Float32Array(4 * width * height),
    row = gpu ? Math.ceil((16 * width) / 256) * 64 : 4 * width;
  for (let y = 0; y < height; ++y)
    pixels.set(found.subarray(y * row, y * row + 4 * width), 4 * width * (gpu ? height - 1 - y : y));

  if (!gpu) renderer.setRenderTarget(null);
  const sky = scene.environment,
    gl = gpu ? null : renderer.getContext(),
    surfaces = {
      library: mesh.material,
      MeshPhysicalMaterial: new three[gpu ? 'MeshPhysicalNodeMaterial' : 'MeshPhysicalMaterial']({ roughness: 0.4, metalness: 1 }),
      MeshBasicMaterial: new three[gpu ? 'MeshBasicNodeMaterial' : 'MeshBasicMaterial'](),
    };
  // Draws under the environment, a lamp or both, for as many frames.
  window.drawFrames = async ({ surface, environment, lit, frames }) => {
    mesh.material = surfaces[surface];
    scene.environment = environment ? sky : null;
    lamp.visible = lit;
    for (let k = 0; k < frames; ++k) {
      renderer.render(scene, camera);
      if (gpu) await read(1, 1);
      else gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
  };
  const bytes = new Uint8Array(pixels.buffer);
  let text = '';
  for (let k = 0; k < bytes.length; k += 8192) text += String.fromCharCode(...bytes.subarray(k, k + 8192));
  return {
    pixels: btoa(text),
    ...calls,
    materials,
  };
}

// Seconds of processor time of the browser so far, which other work on the machine does not change.
function processorTime() {
  const parents = new Map(),
    ticks = new Map();
  for (const entry of readdirSync('/proc').filter((word) => /^\d+$/.test(word))) {
    try {
      const fields = readFileSync(`/proc/${entry}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');
      parents.set(+entry, +fields[1]);
      ticks.set(+entry, +fields[11] + +fields[12]);
    } catch {
      // It has ended.
    }
  }
  const ours = (id) => id === process.pid || (parents.has(id) && ours(parents.get(id)));
  let sum = 0;
  for (const [id, count] of ticks) if (id !== process.pid && ours(id)) sum += count;
  return sum / 100;
}

// A tile of the atlas without what is near the outline, rows from the bottom up.
function tileOf(atlas, k, rows) {
  const pixels = new Float32Array(4 * side * side);
  const left = (k % columns) * side,
    bottom = (rows - 1 - Math.floor(k / columns)) * side;
  for (let y = 0; y < side; ++y)
    for (let x = 0; x < 4 * side; ++x)
      pixels[4 * y * side + x] = atlas[4 * ((bottom + y) * columns * side + left) + x];
  return { size: side, pixels };
}

function inner({ size, pixels }) {
  return {
    size,
    pixels: pixels.map((value, k) => {
      const x = (Math.floor(k / 4) % size) + 0.5,
        y = Math.floor(k / 4 / size) + 0.5;
      return Math.hypot(x - size / 2, y - size / 2) < 0.95 * (size / 2) ? value : 0;
    }),
  };
}

await finish(async () => {
  mkdirSync(folder, { recursive: true });
  if (!existsSync(join(folder, `${name}_three.js`)))
    execFileSync(program, ['library', 'export', library, '--target', 'three', '-o', folder, '--quiet']);
  const drawn = await withBrowser(driver, async (page) => {
    await page.goto('http://localhost/');
    const answer = await page.evaluate(draw, { name, gpu: driver === 'webgpu', side, columns, elevation });
    for (const surface of ['library', 'MeshPhysicalMaterial', 'MeshBasicMaterial']) {
      for (const [light, environment, lit] of [['the environment', true, false], ['a lamp', false, true], ['both', true, true]]) {
        const job = { surface, environment, lit };
        await page.evaluate((given) => window.drawFrames(given), { ...job, frames: 2 });
        const before = processorTime();
        await page.evaluate((given) => window.drawFrames(given), { ...job, frames });
        const time = (1000 * (processorTime() - before)) / frames;
        console.log(`${surface} under ${light}: ${time.toFixed(0)} ms of processor time a frame`);
      }
    }
    return answer;
  }, { files });
  const { materials, calls, triangles } = drawn;
  const sizeOf = (file) => statSync(join(folder, file)).size;
  const { table } = readJson(join(folder, `${name}.hsh.json`));
  const perMaterial = sizeOf(`${name}.coef.f16.bin`) / materials.length;
  console.log(`${materials.length} materials, ${calls} draw calls of ${triangles} triangles in all`);
  console.log(`bytes: a material ${perMaterial} and 1024 of lookups, table of the functions ${table?.bytes ?? 0}, ` +
    `modules ${sizeOf(`${name}_three.js`)} and ${sizeOf(`${name}_three_data.js`)}`);

  const rows = Math.ceil(materials.length / columns);
  const atlas = decoded(drawn.pixels, Float32Array);
  const tiles = [],
    found = [];
  for (const [k, material] of materials.entries()) {
    const picture = join(folder, `${k}.exr`);
    if (!existsSync(picture))
      execFileSync(program, ['render', `${library}:${material}`, '--light', light, '--by', 'integration', '--error', '20%',
        '--samples', '1', '--size', `${side}`, '--view', `${elevation},0`, '-o', picture, '--quiet']);
    const expected = await readExr(picture);
    tiles.push({ expected, found: tileOf(atlas, k, rows) });
    const pair = [inner(expected), inner(tiles[k].found)];
    found.push({ material, l2: difference(...pair).l2, shown: shownDifference(...pair) });
  }
  for (const [measure, words] of [['l2', 'relative L2'], ['shown', 'mean difference of sRGB from 0 to 1']]) {
    found.sort((a, b) => a[measure] - b[measure]);
    const at = (share) => found[Math.floor(share * (found.length - 1))][measure].toFixed(3);
    const worst = found.slice(-5).map((row) => `${row.material} ${row[measure].toFixed(3)}`);
    console.log(`${words} from render: median ${at(0.5)}, of three quarters of the materials at most ${at(0.75)}, ` +
      `largest: ${worst.join(', ')}`);
  }
  writeMosaic(join(folder, 'library_atlas.png'), tiles, columns);
  expect(found[Math.floor(found.length / 2)].shown < 0.03, 'the spheres differ');
});
