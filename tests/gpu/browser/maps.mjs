// maps.mjs DRIVER PROGRAM: maps of materials in a browser. With WebGL 2 the viewer of `hshfit export`:
// its shader against the values of the export, its levels against a picture of many samples a pixel;
// with the driver webgpu the WGSL shader against the same values.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { expect, finish, withBrowser } from './browser.mjs';

const [driver, program] = process.argv.slice(2);
const maps = join(dirname(fileURLToPath(import.meta.url)), '../../../examples/maps');
const coin = join(maps, 'coin.json');
const forms = [
  ['outgoing', []],
  ['low-rank', []],
  ['clusters', ['--clusters', '64']],
  ['library', ['--components', '7', '--checks', '0']],
  ['ellipse', ['--checks', '0'], join(maps, 'bumpy.json')],
  ['harmonics', ['--harmonics', '9', '--checks', '0'], join(maps, 'brushed.json')],
];

function exported(folder, form, more, description = coin, name = form) {
  const made = join(folder, name);
  execFileSync(program, ['svbrdf', description, '-o', made, '--form', form, '--quiet', ...more]);
  execFileSync(program, ['export', join(made, 'material.json'), '-o', join(made, 'out'), '--target',
    'wgsl,viewer', '--quiet']);
  const html = readFileSync(join(made, 'out', 'material_viewer.html'), 'utf8');
  const [, text] = html.match(/<script type="application\/json" id="data">(.*?)<\/script>/s);
  return {
    page: join(made, 'out', 'material_viewer.html'),
    wgsl: readFileSync(join(made, 'out', 'material_hsh.wgsl'), 'utf8'),
    data: JSON.parse(text),
  };
}

// Largest difference of values [test][channel], of the largest value, over all tests or over those at
// centres of texels, which are every third.
function gapOf(tests, found, step = 1) {
  let gap = 0, most = 0;
  tests.forEach(({ value }, k) => value.forEach((x, c) => {
    most = Math.max(most, Math.abs(x));
    const d = Math.abs(found[k][c] - x);
    if (k % step === 0) gap = Math.max(gap, d < 1e30 ? d : 1e30);
  }));
  return gap / most;
}

// In the page: WebGPU, one invocation for each test.
async function compute({ wgsl, data }) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('no WebGPU adapter');
  const device = await adapter.requestDevice();
  device.pushErrorScope('validation');
  const main = `
@group(0) @binding(6) var<storage, read_write> inputs: array<f32>;
@group(0) @binding(7) var<storage, read_write> outputs: array<f32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let k = i32(id.x);
    if (k >= ${data.tests.length}) { return; }
    let n = 12 * k;
    let q = ${data.lights.length ? 'hsh_evalRaw' : 'hsh_eval'}(vec2<f32>(inputs[n], inputs[n + 1]), inputs[n + 2],
        vec3<f32>(inputs[n + 4], inputs[n + 5], inputs[n + 6]),
        vec3<f32>(inputs[n + 8], inputs[n + 9], inputs[n + 10]));
    for (var c = 0; c < 3; c++) { outputs[3 * k + c] = q[c]; }
}`;
  const module = device.createShaderModule({ code: wgsl + main });
  const wrong = (await module.getCompilationInfo()).messages.filter(({ type }) => type === 'error');
  if (wrong.length) throw new Error(wrong.map(({ message }) => message).join('\n'));
  const pipeline = await device.createComputePipelineAsync({
    layout: 'auto',
    compute: { module, entryPoint: 'main' },
  });
  const texture = (format, bytesOfTexel, levels, layers) => {
    const made = device.createTexture({
      size: [levels[0].width, levels[0].height, layers],
      mipLevelCount: levels.length,
      format,
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
    levels.forEach(({ width, height, bytes }, mipLevel) => device.queue.writeTexture(
      { texture: made, mipLevel }, checks.bytesOf(bytes),
      { bytesPerRow: width * bytesOfTexel, rowsPerImage: height }, [width, height, layers]));
    return made.createView({ dimension: '2d-array' });
  };
  const formats = { float16: ['rgba16float', 8], unorm8: ['rgba8unorm', 4] };
  const { COPY_DST, COPY_SRC, STORAGE, MAP_READ } = GPUBufferUsage;
  const buffer = (size, usage) => device.createBuffer({ size, usage });
  const numbers = Float32Array.from(data.tests.flatMap((test) => test.numbers));
  const inputs = buffer(numbers.byteLength, STORAGE | COPY_DST);
  device.queue.writeBuffer(inputs, 0, numbers);
  const size = 12 * data.tests.length, results = buffer(size, STORAGE | COPY_SRC);
  const entries = [
    { binding: 0, resource: texture(...formats[data.number], data.levels, data.layers) },
    { binding: 6, resource: { buffer: inputs } },
    { binding: 7, resource: { buffer: results } },
  ];
  if (data.form !== 'clusters')
    entries.push({ binding: 1, resource: device.createSampler({
      minFilter: 'linear', magFilter: 'linear', mipmapFilter: 'linear' }) });
  if (data.shared)
    entries.push({ binding: 2, resource: texture('rgba32float', 16, [data.shared], 1) });
  if (data.harmonics)
    entries.push({ binding: 3, resource: texture(...formats[data.number], data.harmonics.levels,
      data.harmonics.layers) });
  const readable = buffer(size, MAP_READ | COPY_DST);
  const encoder = device.createCommandEncoder(), pass = encoder.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
  pass.dispatchWorkgroups(Math.ceil(data.tests.length / 64));
  pass.end();
  encoder.copyBufferToBuffer(results, 0, readable, 0, size);
  device.queue.submit([encoder.finish()]);
  const problem = await device.popErrorScope();
  if (problem) throw new Error(problem.message);
  await readable.mapAsync(GPUMapMode.READ);
  const values = [...new Float32Array(readable.getMappedRange())];
  device.destroy();
  return data.tests.map((_, k) => values.slice(3 * k, 3 * k + 3));
}

// In the page: a picture of the state, [pixel][R, G, B] of linear light, each pixel the mean of
// `samples` x `samples`.
function picture({ samples, ...state }) {
  const { mapPage } = window, canvas = document.getElementById('canvas');
  Object.assign(mapPage.state, state);
  const [width, height] = [160, 120];
  canvas.width = width * samples;
  canvas.height = height * samples;
  mapPage.draw();
  const gl = canvas.getContext('webgl2'), bytes = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
  const linear = Float64Array.from({ length: 256 }, (_, code) =>
    code <= 10 ? code / 255 / 12.92 : ((code / 255 + 0.055) / 1.055) ** 2.4);
  const out = new Array(3 * width * height).fill(0);
  for (let y = 0; y < canvas.height; ++y)
    for (let x = 0; x < canvas.width; ++x)
      for (let c = 0; c < 3; ++c)
        out[3 * (Math.floor(y / samples) * width + Math.floor(x / samples)) + c] +=
          linear[bytes[4 * (y * canvas.width + x) + c]] / samples ** 2;
  return out;
}

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k])) / Math.hypot(...b);

// The values of pixels whose neighbours all show the map: outlines are not smoothed.
function inside(picture, shown) {
  const background = shown.slice(0, 3), width = 160;
  const onMap = (pixel) => background.some((x, c) => Math.abs(shown[3 * pixel + c] - x) > 1e-6);
  return picture.filter((_, k) => {
    const pixel = Math.floor(k / 3);
    return [-width - 1, -width, -width + 1, -1, 0, 1, width - 1, width, width + 1]
      .every((step) => shown[3 * (pixel + step)] !== undefined && onMap(pixel + step));
  });
}

async function proveViewer(page, complaints, name, made) {
  await page.goto(pathToFileURL(made.page).href);
  await page.waitForFunction(() => window.mapPage !== undefined);
  const message = await page.evaluate(() => document.getElementById('message').textContent);
  expect(message === '', `${name}: ${message}`);
  const found = await page.evaluate(() => window.mapPage.check());
  const gap = gapOf(made.data.tests, found), centres = gapOf(made.data.tests, found, 3);
  console.log(`${name}: eval ${gap.toExponential(1)}, at centres ${centres.toExponential(1)}`);
  // A GPU may blend with weights of 8 bits; these two renderers are software.
  expect(gap <= 4e-3, `${name}: the shader differs by ${gap}`);
  expect(centres <= 1e-5, `${name}: the shader differs at centres of texels by ${centres}`);
  const near = { exposure: -0.5, samples: 1, automatic: true };
  const plane = await page.evaluate(picture, near);
  const sphere = await page.evaluate(picture, { ...near, shape: 1 });
  expect(distance(sphere, plane) > 0.1, `${name}: the sphere looks like the plane`);
  expect(sphere.every(Number.isFinite), `${name}: the sphere has no numbers`);
  expect(complaints.length === 0, `${name}: console: ${complaints.join('; ')}`);
  if (!process.env.HSHFIT_PICTURES) return;
  for (const [file, state] of [
    ['plane', { shape: 0, view: { azimuth: -90, elevation: 60, distance: 3 }, exposure: 0 }],
    ['far', { shape: 0, view: { azimuth: -90, elevation: 4, distance: 5 }, coloured: true }],
    ['sphere', { shape: 1, coloured: false, view: { azimuth: -60, elevation: 20, distance: 3.6 } }],
  ]) {
    await page.evaluate((next) => {
      Object.assign(window.mapPage.state, next);
      window.dispatchEvent(new Event('resize'));
      window.mapPage.draw();
    }, state);
    await page.waitForTimeout(500);
    await page.screenshot({ path: join(process.env.HSHFIT_PICTURES, `map_${name}_${file}.png`) });
  }
}

// A map of noise.
function noise(folder) {
  const [width, height] = [128, 128], values = Float32Array.from({ length: width * height },
    (_, k) => Math.abs(Math.sin(12.9898 * (k % width) + 78.233 * Math.floor(k / width)) * 43758.5) % 1);
  writeFileSync(join(folder, 'noise.pfm'), Buffer.concat([
    Buffer.from(`Pf\n${width} ${height}\n-1.0\n`), Buffer.from(values.buffer)]));
  const description = join(folder, 'noise.json');
  writeFileSync(description, JSON.stringify({ format: 'hshfit-svbrdf', version: 1, model: 'ggx',
    parameters: { kd: { map: 'noise.pfm' }, alpha: 0.5, ks: 0.1 } }));
  return exported(folder, 'low-rank', [], description, 'noise');
}

// Levels against many samples a pixel, far from a map: a pixel is several texels wide.
async function proveLevels(page, name, made, exposure, share) {
  await page.goto(pathToFileURL(made.page).href);
  await page.waitForFunction(() => window.mapPage !== undefined);
  const far = { exposure, view: { azimuth: -90, elevation: 50, distance: 10 } };
  const exact = await page.evaluate(picture, { ...far, samples: 8, automatic: false, level: 0 });
  const finest = await page.evaluate(picture, { ...far, samples: 1, automatic: false, level: 0 });
  const levels = await page.evaluate(picture, { ...far, samples: 1, automatic: true });
  const within = (picture) => inside(picture, finest), many = within(exact);
  expect(many.length > 300, `${name}: only ${many.length} values`);
  const [without, withLevels] = [finest, levels].map((values) => distance(within(values), many));
  console.log(`${name}: against 64 samples a pixel ${without.toFixed(4)} at level 0, `
    + `${withLevels.toFixed(4)} with levels`);
  expect(withLevels < share * without, `${name}: levels do not come nearer to many samples`);
}

await finish(async () => {
  const folder = mkdtempSync(join(tmpdir(), 'hshfit-maps-'));
  try {
    // WebGPU exists for secure origins only; localhost is one.
    const files = driver !== 'webgpu' ? null : (path) =>
      path === '/' ? { contentType: 'text/html', body: '<title>check</title>' } : null;
    await withBrowser(driver, async (page, complaints) => {
      if (driver === 'webgpu') await page.goto('http://localhost/');
      for (const [form, more, description] of forms) {
        const made = exported(folder, form, more, description);
        if (driver !== 'webgpu') {
          await proveViewer(page, complaints, form, made);
          continue;
        }
        const found = await page.evaluate(compute, made);
        const gap = gapOf(made.data.tests, found), centres = gapOf(made.data.tests, found, 3);
        console.log(`${form}: eval ${gap.toExponential(1)}, at centres ${centres.toExponential(1)}`);
        expect(gap <= 4e-3, `${form}: the shader differs by ${gap}`);
        expect(centres <= 1e-5, `${form}: the shader differs at centres by ${centres}`);
      }
      if (driver === 'webgpu') return;
      await proveLevels(page, 'noise', noise(folder), -1, 0.5);
      const [form, more, description] = forms.find(([name]) => name === 'ellipse');
      await proveLevels(page, 'bumpy', exported(folder, form, more, description, 'far'), -2,
        0.6);
    }, { files, viewport: { width: 1100, height: 760 } });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
