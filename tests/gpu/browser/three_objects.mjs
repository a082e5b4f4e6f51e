// three_objects.mjs DRIVER PROGRAM: the target three on instances, batches and skinned meshes, in fog,
// clipped, and with the maps of three's own materials, each against a plain mesh that has to look alike;
// the plain mesh itself is proven by three_module.mjs. DRIVER webgpu: the node material.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { decoded, expect, filesOfThree, finish, withBrowser } from './browser.mjs';

const [driver, program] = [process.argv[2], resolve(process.argv[3])];
const gpu = driver === 'webgpu';
const side = 64;
const materials = [
  { name: 'ward', spec: 'ward:ax=.3,ay=.6,kd=.1/.2/.3', project: ['--outgoing', '16x16', '--order', '5'] },
  { name: 'brushed', spec: 'ggx:ax=.3,ay=.6,F0=.9/.6/.3', project: ['--form', 'halfway', '--precision', 'half'] },
];

const folder = mkdtempSync(join(tmpdir(), 'hshfit-objects-'));
const blank = `<!DOCTYPE html><title>check</title><script type="importmap">{"imports": {
  "three": "/three/build/three.module.js", "three/webgpu": "/three/build/three.webgpu.js",
  "three/tsl": "/three/build/three.tsl.js"}}</script>`;
const files = filesOfThree(folder, blank);

const eye = [0.9, 0.7, 3.4],
  fog = { colour: [0.2, 0.5, 0.1], near: 2.4, far: 3.8 },
  plane = { normal: [0.8, 0, -0.6], constant: 0.4 },
  tilt = [0.3, -0.2, 0.9327379];

// In the page: the scene as floats from the bottom row on, as Base64, and rows that the camera looks along.
async function draw({ name, gpu, side, eye, fog, plane, tilt, object, light, given, tilted, foggy, clipped }) {
  const three = await import(gpu ? 'three/webgpu' : 'three');
  const { material } = await import(`/${name}/${name}_three${gpu ? '_webgpu' : ''}.js`);
  const renderer = gpu ? new three.WebGPURenderer() : new three.WebGLRenderer();
  if (gpu) await renderer.init();
  renderer.setClearColor(0, 0);
  const texel = (rgb) => {
    const texture = new three.DataTexture(new Float32Array([...rgb, 1]), 1, 1, three.RGBAFormat, three.FloatType);
    texture.needsUpdate = true;
    return texture;
  };
  const geometry = new three.SphereGeometry(1, 256, 128);
  const { normal, uv } = geometry.attributes;
  const options = Object.fromEntries(Object.entries(given ?? {}).map(([key, value]) => [key, key.endsWith('Map') ? texel(value) : value]));
  if (options.color) options.color = new three.Color().setRGB(...options.color);
  if (tilted || options.normalMap) {
    // Tangents along the parallels; the normals as the map has them, or `tilted` in the mesh.
    const tangents = new Float32Array(4 * normal.count);
    for (let k = 0; k < normal.count; ++k) {
      const phi = 2 * Math.PI * uv.getX(k);
      const n = new three.Vector3().fromBufferAttribute(normal, k),
        t = new three.Vector3(Math.sin(phi), 0, Math.cos(phi));
      tangents.set([...t, 1], 4 * k);
      if (!tilted) continue;
      const b = n.clone().cross(t);
      const leaning = n.multiplyScalar(tilt[2]).addScaledVector(t, tilt[0]).addScaledVector(b, tilt[1]);
      normal.setXYZ(k, ...leaning);
    }
    geometry.setAttribute('tangent', new three.BufferAttribute(tangents, 4));
    options.tangents = true;
  }
  const surface = material(options);
  const turn = new three.Matrix4().makeRotationFromEuler(new three.Euler(0.4, 0.7, -0.3));
  const away = new three.Matrix4().makeTranslation(50, 0, 0);
  let mesh;
  if (object === 'instances') {
    mesh = new three.InstancedMesh(geometry, surface, 2);
    mesh.setMatrixAt(0, away);
    mesh.setMatrixAt(1, turn);
  } else if (object === 'batch') {
    mesh = new three.BatchedMesh(2, 2 * normal.count, 2 * geometry.index.count, surface);
    const ball = mesh.addGeometry(geometry);
    mesh.setMatrixAt(mesh.addInstance(mesh.addGeometry(new three.BoxGeometry())), away);
    mesh.setMatrixAt(mesh.addInstance(ball), turn);
  } else if (object === 'skin') {
    const all = (values, Type) => new three.BufferAttribute(Type.from({ length: 4 * normal.count }, (_, k) => values[k % 4]), 4);
    geometry.setAttribute('skinIndex', all([0, 1, 0, 0], Uint16Array));
    geometry.setAttribute('skinWeight', all([0.5, 0.5, 0, 0], Float32Array));
    mesh = new three.SkinnedMesh(geometry, surface);
    const bones = [new three.Bone(), new three.Bone()];
    mesh.add(...bones);
    mesh.bind(new three.Skeleton(bones));
    for (const bone of bones) bone.setRotationFromMatrix(turn);
  } else {
    mesh = new three.Mesh(geometry, surface);
    mesh.setRotationFromMatrix(turn);
  }
  const scene = new three.Scene();
  if (light === 'lamp') {
    const lamp = new three.DirectionalLight(0xffffff, 2);
    lamp.position.set(1.5, 2, 1);
    scene.add(lamp);
  } else if (light) {
    // Even light, or light with a lamp some 30 degrees wide.
    const [width, height] = [256, 128];
    const texels = new Float32Array(4 * width * height);
    for (let k = 0; k < width * height; ++k) {
      const phi = 2 * Math.PI * (((k % width) + 0.5) / width - 0.5),
        latitude = Math.PI * ((Math.floor(k / width) + 0.5) / height - 0.5);
      const across = Math.cos(latitude);
      const near = (across * Math.cos(phi) + Math.sin(latitude) + across * Math.sin(phi)) / Math.sqrt(3);
      const wide = light === 'even' ? 0 : 12 * Math.exp(20 * (near - 1));
      texels.set([1 + wide, 1 + wide, 1 + wide, 1], 4 * k);
    }
    scene.environment = new three.DataTexture(texels, width, height, three.RGBAFormat, three.FloatType);
    scene.environment.mapping = three.EquirectangularReflectionMapping;
    scene.environment.minFilter = scene.environment.magFilter = three.LinearFilter;
    scene.environment.needsUpdate = true;
  }
  if (foggy) scene.fog = new three.Fog(new three.Color().setRGB(...fog.colour), fog.near, fog.far);
  const cut = new three.Plane(new three.Vector3(...plane.normal), plane.constant);
  let root = mesh;
  if (clipped && gpu) {
    root = new three.ClippingGroup();
    root.clippingPlanes = [cut];
    root.add(mesh);
  } else if (clipped) {
    renderer.clippingPlanes = [cut];
  }
  scene.add(root);
  const camera = new three.PerspectiveCamera(38, 1, 0.1, 20);
  camera.position.set(...eye);
  camera.lookAt(0, 0, 0);
  const target = new (gpu ? three.RenderTarget : three.WebGLRenderTarget)(side, side, { type: three.FloatType });
  renderer.setRenderTarget(target);
  renderer.render(scene, camera);
  renderer.render(scene, camera);
  let pixels = new Float32Array(4 * side * side);
  if (gpu) pixels = await renderer.readRenderTargetPixelsAsync(target, 0, 0, side, side);
  else renderer.readRenderTargetPixels(target, 0, 0, side, side, pixels);
  const bytes = new Uint8Array(pixels.buffer, pixels.byteOffset, 16 * side * side);
  let text = '';
  for (let k = 0; k < bytes.length; k += 8192) text += String.fromCharCode(...bytes.subarray(k, k + 8192));
  const answer = { pixels: btoa(text), camera: camera.matrixWorld.elements };
  renderer.dispose();
  return answer;
}

// Places on the sphere of the pixels well within its outline: [pixel, point].
function points(camera) {
  const reach = Math.tan((38 * Math.PI) / 360);
  const found = [];
  for (let k = 0; k < side * side; ++k) {
    const across = ((2 * ((k % side) + 0.5)) / side - 1) * reach;
    const above = ((2 * (Math.floor(k / side) + 0.5)) / side - 1) * reach * (gpu ? -1 : 1);
    const ray = [0, 1, 2].map((i) => across * camera[i] + above * camera[4 + i] - camera[8 + i]);
    const length = Math.hypot(...ray),
      d = ray.map((x) => x / length);
    const b = dot(eye, d),
      square = b * b - dot(eye, eye) + 1;
    if (square <= 0.05) continue;
    const s = -b - Math.sqrt(square);
    found.push([k, eye.map((x, i) => x + s * d[i])]);
  }
  return found;
}
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

// Differences over the pixels within the outline, relative to the root of the squares.
function compare(title, places, found, expected, tolerance = 0.01) {
  let wrong = 0,
    all = 0;
  for (const [k, point] of places) {
    const right = expected(k, point);
    if (!right) continue;
    right.forEach((value, c) => {
      wrong += (found[4 * k + c] - value) ** 2;
      all += value * value;
    });
  }
  const error = Math.sqrt(wrong / all);
  console.log(`${title.padEnd(44)} ${error.toExponential(1)}`);
  expect(error < tolerance, `${title} differs`);
}

async function prove(page, name) {
  const seen = async (words) => {
    const answer = await page.evaluate(draw, { name, gpu, side, eye, fog, plane, tilt, ...words });
    return { ...answer, pixels: decoded(answer.pixels, Float32Array) };
  };
  const rgb = (pixels, factor = [1, 1, 1]) => (k) => [0, 1, 2].map((c) => factor[c] * pixels[4 * k + c]);
  const { pixels: plain, camera } = await seen({ light: 'lamp' });
  const { pixels: lit } = await seen({ light: 'wide' });
  const places = points(camera);
  const check = (title, found, expected, tolerance) => compare(`${name}, ${title}`, places, found.pixels, expected, tolerance);

  for (const object of ['instances', 'batch', 'skin']) {
    // The axis of a skinned mesh is that of its bones in WebGL alone.
    if (object === 'skin' && gpu) continue;
    check(object, await seen({ light: 'lamp', object }), rgb(plain));
    check(`${object}, environment`, await seen({ light: 'wide', object }), rgb(lit));
  }
  const tilts = await seen({ light: 'lamp', tilted: true });
  let moved = 0;
  for (const [k] of places) moved = Math.max(moved, Math.abs(tilts.pixels[4 * k] - plain[4 * k]));
  expect(moved > 0.1, 'tilted normals change nothing');
  const map = tilt.map((x) => (x + 1) / 2);
  check('normalMap', await seen({ light: 'lamp', given: { normalMap: map } }), rgb(tilts.pixels));
  check('normalMap, environment', await seen({ light: 'wide', given: { normalMap: map } }), rgb((await seen({ light: 'wide', tilted: true })).pixels));
  check('bumpMap, flat', await seen({ light: 'lamp', given: { bumpMap: [0.7, 0, 0] } }), rgb(plain));
  check('aoMap, lamp', await seen({ light: 'lamp', given: { aoMap: [0.4, 0, 0] } }), rgb(plain));
  check('aoMap, environment', await seen({ light: 'wide', given: { aoMap: [0.4, 0, 0] } }), rgb(lit, [0.4, 0.4, 0.4]));
  const color = [0.5, 0.25, 0.75];
  check('color, lamp', await seen({ light: 'lamp', given: { color } }), rgb(plain, color));
  check('color, environment', await seen({ light: 'wide', given: { color } }), rgb(lit, color));
  const even = await seen({ light: 'even' });
  const radiance = [0.3, 0.6, 0.9];
  const lightMap = radiance.map((x) => x * Math.PI);
  check('lightMap', await seen({ given: { lightMap } }), rgb(even.pixels, radiance));
  const both = rgb(even.pixels, radiance);
  check('lightMap, environment', await seen({ light: 'wide', given: { lightMap } }), (k) => rgb(lit)(k).map((x, c) => x + both(k)[c]));
  const thin = await seen({ light: 'lamp', given: { opacity: 0.25, transparent: true } });
  for (const [k] of places) expect(Math.abs(thin.pixels[4 * k + 3] - 0.25) < 1e-3, `opacity ${thin.pixels[4 * k + 3]}`);

  check('fog', await seen({ light: 'lamp', foggy: true }), (k, point) => {
    const depth = dot(eye.map((x, i) => x - point[i]), [8, 9, 10].map((i) => camera[i]));
    const t = Math.min(1, Math.max(0, (depth - fog.near) / (fog.far - fog.near))),
      share = t * t * (3 - 2 * t);
    return rgb(plain)(k).map((x, c) => x + share * (fog.colour[c] - x));
  });
  // What the plane cuts away shows the inside or nothing: the other side is as it was.
  const cut = await seen({ light: 'lamp', clipped: true });
  let gone = 0;
  check('clipped', cut, (k, point) => {
    const height = dot(plane.normal, point) + plane.constant;
    if (Math.abs(height) < 0.05) return null;
    if (height > 0) return rgb(plain)(k);
    ++gone;
    return [0, 0, 0];
  });
  expect(gone > 100, `${gone} pixels are clipped`);
}

await finish(async () => {
  try {
    for (const { name, spec, project } of materials) {
      execFileSync(program, ['project', spec, '-o', `${name}.json`, ...project, '--quiet'], { cwd: folder });
      execFileSync(program, ['export', `${name}.json`, '-o', name, '--target', 'three', '--no-error', '--quiet'], { cwd: folder });
    }
    for (const { name } of materials)
      await withBrowser(driver, async (page, complaints) => {
        await page.goto('http://localhost/');
        await prove(page, name);
        const real = complaints.filter((text) => !/GPU stall|Context Lost|Instance dropped/i.test(text));
        expect(real.length === 0, `console: ${real.join('; ')}`);
      }, { files });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
