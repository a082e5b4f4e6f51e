// three_module.mjs DRIVER PROGRAM: the target three in three.js. A sphere, turned, under one
// directional light, one point light and light from all around, read back as floats and compared pixel
// by pixel with `hshfit eval` of the same file; DRIVER webgpu: the node material, else the
// ShaderMaterial. Then the page.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, normalize, resolve } from 'node:path';
import { encoded, expect, finish, here, withBrowser } from './browser.mjs';

const [driver, program] = [process.argv[2], resolve(process.argv[3])];
const gpu = driver === 'webgpu';
const side = 48;

const cases = [
  { name: 'ward', spec: 'ward:ax=.3,ay=.6,kd=.1/.2/.3', project: ['--outgoing', '24x24', '--order', '6'] },
  {
    name: 'cosine',
    spec: 'phong:exponent=8,kd=.3',
    project: ['--outgoing', '16', '--order', '6', '--cosine', '--condon-shortley'],
  },
  {
    name: 'bytes',
    spec: 'ward:ax=.3,ay=.6,kd=.1/.2/.3',
    project: ['--outgoing', '24x24', '--order', '4'],
    export: ['--number', 'unorm16'],
    tangents: true,
  },
  {
    name: 'halfway',
    sampled: true,
    spec: 'ggx:alpha=.4,F0=.9/.6/.3',
    project: ['--form', 'halfway', '--halfway', '8,4,3', '--precision', 'half'],
  },
  {
    name: 'texture',
    sampled: true,
    spec: 'ggx:alpha=.4,F0=.9/.6/.3',
    project: ['--form', 'halfway', '--halfway', '6,3,3', '--precision', 'unorm16'],
    export: ['--storage', 'texture', '--allow-loss'],
  },
  { name: 'basis', sampled: true, spec: 'phong:exponent=4,kd=.3', project: ['--form', 'basis', '--order', '5'] },
];

// Libraries of three materials, of which one is drawn, its number from `from`.
const libraries = { atlas: 0.05, sums: 0 }; // the table's largest error
const [grey, gold, paint] = ['lambert:kd=.5', 'ggx:alpha=.3,F0=.9/.6/.3', 'ggx:alpha=.2,F0=.05,kd=.4/.3/.1'];
const nameOf = (spec) => spec.replace(/[:,/]/g, '_');
const members = [
  { name: 'atlas', spec: gold, from: 'number', kinds: ['directional', 'picture'] },
  { name: 'atlas', spec: paint, from: 'name', kinds: ['point'] },
  { name: 'atlas', spec: gold, from: 'instance', kinds: ['point'] },
  { name: 'atlas', spec: paint, from: 'vertex', kinds: ['directional', 'picture'] },
  { name: 'sums', spec: gold, from: 'number', kinds: ['directional'] },
];

const folder = mkdtempSync(join(tmpdir(), 'hshfit-three-'));
const run = (...words) => execFileSync(program, [...words, '--quiet'], { cwd: folder });

const types = { html: 'text/html', js: 'text/javascript', json: 'application/json' };
const blank = `<!DOCTYPE html><title>check</title><script type="importmap">{"imports": {
  "three": "/three/build/three.module.js", "three/webgpu": "/three/build/three.webgpu.js",
  "three/tsl": "/three/build/three.tsl.js"}}</script>`;

// http://localhost/three/… is the package, also where the page looks for it; /out/… the exports.
function files(path) {
  if (path === '/') return { contentType: 'text/html', body: blank };
  const place = path.replace(/^\/out\/[^/]+\/node_modules\/three\//, '/three/');
  const root = place.startsWith('/three/') ? join(here, '../node_modules') : folder;
  if (place.includes('..')) return null;
  try {
    const body = readFileSync(normalize(join(root, place)));
    return { contentType: types[place.split('.').pop()] ?? 'application/octet-stream', body };
  } catch {
    return null;
  }
}

// Radiance 1.2 + 0.9 d . axis, an axis for each colour, in three's world: a light of two bands.
const axes = [
  [0.6, 0, 0.8],
  [0, -0.6, 0.8],
  [-0.48, 0.6, -0.64],
];
const environment = Float64Array.from({ length: 12 }, (_, k) => {
  if (k < 3) return 1.2 * Math.sqrt(4 * Math.PI);
  return 0.9 * Math.sqrt((4 * Math.PI) / 3) * axes[k % 3][[1, 2, 0][Math.floor(k / 3) - 1]];
});
const radianceFrom = (d) => axes.map((axis) => 1.2 + 0.9 * dot(axis, d));

const lights = {
  directional: { colour: [1, 0.8, 0.6], intensity: 2.5, place: [1.5, 2, 1] },
  point: { colour: [0.7, 1, 0.9], intensity: 14, place: [-1.5, 1.2, 2.2] },
};
const view = { eye: [0.9, 0.7, 3.4], fov: 38, rotation: [0.4, 0.7, -0.3] };

// A picture of light all around, turned: a wide lamp over the same two bands, in three's layout of
// equirectangular textures (row 0 looks down), with the rotation of scene.environment.
const lamp = unit0([0.5, 0.6, 0.4]);
function unit0(a) {
  return a.map((x) => x / Math.hypot(...a));
}
const pictureFrom = (d) => radianceFrom(d).map((x) => x / 2 + 12 * Math.exp(20 * (dot(lamp, d) - 1)));
const turn = 0.8; // about +y
function picture(width, height) {
  const texels = [];
  for (let row = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column) {
      const phi = 2 * Math.PI * ((column + 0.5) / width - 0.5),
        latitude = Math.PI * ((row + 0.5) / height - 0.5);
      const across = Math.cos(latitude);
      texels.push(...pictureFrom([across * Math.cos(phi), Math.sin(latitude), across * Math.sin(phi)]), 1);
    }
  }
  return { width, height, texels: encoded(texels) };
}
// The world's light from d when the picture is turned by `turn` about +y.
const turnedFrom = ([x, y, z]) => {
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return pictureFrom([c * x - s * z, y, s * x + c * z]);
};

// In the page: the sphere under one kind of light, as floats from the bottom row on.
// A material of a library comes as { member, from }: its number as a uniform, given so or by name, or
// as an attribute of each vertex or instance.
async function draw({ name, gpu, kind, side, view, lights, environment, tangents, picture, turn, member, from }) {
  const three = await import(gpu ? 'three/webgpu' : 'three');
  const { material, materialNumber } = await import(`/out/${name}/${name}_three${gpu ? '_webgpu' : ''}.js`);
  const renderer = gpu ? new three.WebGPURenderer() : new three.WebGLRenderer();
  if (gpu) {
    await renderer.init();
    if (!renderer.backend.isWebGPUBackend) throw new Error('no WebGPU');
  }
  const geometry = new three.SphereGeometry(1, 512, 256);
  if (tangents) {
    // Along the meridians, with a mirrored bitangent.
    const normals = geometry.attributes.normal,
      values = new Float32Array(4 * normals.count);
    const [n, t] = [new three.Vector3(), new three.Vector3()];
    for (let k = 0; k < normals.count; ++k) {
      n.fromBufferAttribute(normals, k);
      t.set(0, 1, 0).addScaledVector(n, -n.y).normalize();
      values.set([t.x, t.y, t.z, -1], 4 * k);
    }
    geometry.setAttribute('tangent', new three.BufferAttribute(values, 4));
  }
  const own = { environment: kind === 'environment' ? environment : null };
  if (member) own.indices = from === 'instance' || from === 'vertex';
  else own.tangents = tangents;
  const surface = material(own);
  if (member && !own.indices) surface.materialIndex = from === 'name' ? member : materialNumber(member);
  let mesh = new three.Mesh(geometry, surface);
  if (from === 'vertex') {
    const numbers = new Float32Array(geometry.attributes.position.count).fill(materialNumber(member));
    geometry.setAttribute('materialIndex', new three.BufferAttribute(numbers, 1));
  } else if (from === 'instance') {
    // The first instance, of another material, is out of sight.
    mesh = new three.InstancedMesh(geometry, surface, 2);
    const numbers = Float32Array.of((materialNumber(member) + 1) % 3, materialNumber(member));
    geometry.setAttribute('materialIndex', new three.InstancedBufferAttribute(numbers, 1));
    mesh.setMatrixAt(0, new three.Matrix4().makeTranslation(50, 0, 0));
    mesh.setMatrixAt(1, new three.Matrix4());
  }
  mesh.rotation.set(...view.rotation);
  const scene = new three.Scene().add(mesh);
  const add = (light, { place }) => {
    light.position.set(...place);
    scene.add(light);
  };
  const colourOf = ({ colour }) => new three.Color().setRGB(...colour);
  if (kind === 'directional') {
    add(new three.DirectionalLight(colourOf(lights[kind]), lights[kind].intensity), lights[kind]);
  } else if (kind === 'point') {
    add(new three.PointLight(colourOf(lights[kind]), lights[kind].intensity), lights[kind]);
  }
  if (kind === 'probe') {
    // The same two bands, a quarter of them as even light.
    const probe = new three.LightProbe(new three.SphericalHarmonics3());
    for (let k = 0; k < 4; ++k)
      probe.sh.coefficients[k].fromArray(environment, 3 * k).multiplyScalar(k === 0 ? 0.75 : 1);
    const even = (0.25 * environment[0]) / Math.sqrt(4 * Math.PI);
    scene.add(probe, new three.AmbientLight(new three.Color(1, 1, 1), even * Math.PI));
  }
  if (kind === 'picture') {
    const { width, height, texels } = picture;
    const map = new three.DataTexture(checks.floatsOf(texels), width, height, three.RGBAFormat, three.FloatType);
    map.mapping = three.EquirectangularReflectionMapping;
    map.minFilter = map.magFilter = three.LinearFilter;
    map.needsUpdate = true;
    scene.environment = map;
    scene.environmentRotation.set(0, turn, 0);
    scene.environmentIntensity = 1.5;
  }
  const camera = new three.PerspectiveCamera(view.fov, 1, 0.1, 20);
  camera.position.set(...view.eye);
  camera.lookAt(0, 0, 0);
  const target = new three.RenderTarget(side, side, { type: three.FloatType });
  const seen = gpu ? target : new three.WebGLRenderTarget(side, side, { type: three.FloatType });
  renderer.setRenderTarget(seen);
  renderer.render(scene, camera);
  let pixels = new Float32Array(4 * side * side);
  if (gpu) pixels = await renderer.readRenderTargetPixelsAsync(seen, 0, 0, side, side);
  else renderer.readRenderTargetPixels(seen, 0, 0, side, side, pixels);
  camera.updateMatrixWorld();
  mesh.updateMatrixWorld();
  const answer = {
    pixels: [...pixels].slice(0, 4 * side * side),
    camera: camera.matrixWorld.elements,
    mesh: mesh.matrixWorld.elements,
  };
  renderer.dispose();
  return answer;
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [0, 1, 2].map((i) => a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
const unit = (a) => a.map((x) => x / Math.hypot(...a));
const minus = (a, b) => a.map((x, i) => x - b[i]);
const rotate = (m, v) => [0, 1, 2].map((r) => m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2]);

const surroundings = picture(1024, 512);

// The pixels that show the sphere well: their place, point, frame and wo. `up`: the rows begin above.
function surfacePoints({ camera, mesh }, up, tangents) {
  const points = [];
  const eye = [camera[12], camera[13], camera[14]],
    reach = Math.tan((view.fov * Math.PI) / 360);
  const axis = rotate(mesh, [0, 1, 0]);
  for (let y = 0; y < side; ++y) {
    for (let x = 0; x < side; ++x) {
      const across = ((2 * (x + 0.5)) / side - 1) * reach,
        above = ((2 * (y + 0.5)) / side - 1) * reach;
      const d = unit(rotate(camera, [across, up ? -above : above, -1]));
      const b = dot(eye, d),
        square = b * b - dot(eye, eye) + 1;
      if (square <= 0) continue;
      const s = -b - Math.sqrt(square);
      const n = unit(eye.map((v, i) => v + s * d[i]));
      const toEye = d.map((v) => -v);
      // Not at the outline, nor where the tangent turns fast.
      if (dot(n, toEye) < 0.15 || Math.abs(dot(n, axis)) > 0.97) continue;
      let t = unit(cross(axis, n)),
        right = cross(n, t);
      if (tangents) {
        t = unit(axis.map((v, i) => v - dot(axis, n) * n[i]));
        right = cross(n, t).map((v) => -v);
      }
      const local = (v) => [dot(v, t), dot(v, right), dot(v, n)];
      const world = (v) => [0, 1, 2].map((i) => v[0] * t[i] + v[1] * right[i] + v[2] * n[i]);
      points.push({ k: y * side + x, n, local, world, wo: local(toEye) });
    }
  }
  return points;
}

// f cos(theta_i) of the file for pairs in the local frame, RGB.
function evaluated(file, pairs, clamp = true) {
  const rows = pairs.map(([wi, wo]) => [...wi, ...wo].map((x) => x.toPrecision(12)).join());
  writeFileSync(join(folder, 'in.csv'), `wi_x,wi_y,wi_z,wo_x,wo_y,wo_z\n${rows.join('\n')}\n`);
  rmSync(join(folder, 'out.csv'), { force: true });
  run('eval', file, '--pairs', 'in.csv', '-o', 'out.csv', '--cosine');
  const [head, ...lines] = readFileSync(join(folder, 'out.csv'), 'utf8').trim().split('\n');
  const first = 6,
    channels = head.split(',').length - first;
  return lines.map((line) => {
    const values = line.split(',').slice(first).map(Number);
    return [0, 1, 2].map((c) => Math.max(values[Math.min(c, channels - 1)], clamp ? 0 : -Infinity));
  });
}

// What a light gives at the points; `even`: where f is 1 everywhere.
function lit(file, kind, points, even = false) {
  const { colour, intensity, place } = lights[kind];
  const wis = points.map(({ n, local }) => local(unit(kind === 'point' ? minus(place, n) : place)));
  const pairs = wis.map((wi, i) => [wi, points[i].wo]);
  const f = even ? pairs.map(([wi]) => [wi[2], wi[2], wi[2]]) : evaluated(file, pairs);
  return points.map(({ n }, i) => {
    if (wis[i][2] <= 0) return [0, 0, 0];
    const gap = minus(place, n),
      share = kind === 'point' ? intensity / dot(gap, gap) : intensity;
    return f[i].map((value, c) => value * colour[c] * share);
  });
}

// Under the environment, by 3000 directions spread evenly over the hemisphere. Coefficients are
// multiplied with the light as they are, without a clamp.
function surrounded(file, points, clamp, radiance) {
  const count = 3000;
  const directions = Array.from({ length: count }, (_, i) => {
    const z = (i + 0.5) / count,
      r = Math.sqrt(1 - z * z),
      phi = i * Math.PI * (3 - Math.sqrt(5));
    return [r * Math.cos(phi), r * Math.sin(phi), z];
  });
  const pairs = points.flatMap(({ wo }) => directions.map((wi) => [wi, wo]));
  const f = evaluated(file, pairs, clamp);
  return points.map(({ world }, i) => {
    const sum = [0, 0, 0];
    directions.forEach((wi, j) => {
      const light = radiance(world(wi));
      for (let c = 0; c < 3; ++c) sum[c] += f[i * count + j][c] * light[c];
    });
    return sum.map((x) => (x * 2 * Math.PI) / count);
  });
}

function compare(name, points, pixels, expected, tolerance) {
  let most = 0,
    wrong = 0,
    all = 0,
    largest = 0;
  points.forEach(({ k }, i) => {
    for (let c = 0; c < 3; ++c) {
      const gap = Math.abs(pixels[4 * k + c] - expected[i][c]);
      largest = Math.max(largest, Number.isFinite(gap) ? gap : Infinity);
      most = Math.max(most, expected[i][c]);
      wrong += gap * gap;
      all += expected[i][c] ** 2;
    }
  });
  const relative = Math.sqrt(wrong / all);
  console.log(
    `${name.padEnd(28)} ${points.length} pixels: r.m.s. ${relative.toExponential(1)}, at most ` +
      `${(largest / most).toExponential(1)} of the largest`,
  );
  expect(relative < tolerance && largest < 2 * tolerance * most, `${name} differs`);
}

async function proveMaterial(page, { name, spec, sampled = false, tangents = false }) {
  for (const kind of ['directional', 'point', 'environment', 'picture', ...(gpu ? [] : ['probe'])]) {
    const drawn = await page.evaluate(draw, {
      name,
      gpu,
      kind,
      side,
      view,
      lights,
      environment: [...environment],
      tangents,
      picture: kind === 'picture' ? surroundings : null,
      turn,
    });
    let points = surfacePoints(drawn, gpu, tangents);
    if (kind === 'environment' || kind === 'probe') {
      points = points.filter((_, i) => i % Math.ceil(points.length / 30) === 0);
      const expected = surrounded(`${name}.json`, points, sampled, radianceFrom);
      compare(`${name}, ${kind}`, points, drawn.pixels, expected, sampled ? 0.02 : 0.01);
    } else if (kind === 'picture') {
      // Against the source itself, which the lookups are fitted to.
      points = points.filter((_, i) => i % Math.ceil(points.length / 30) === 0);
      const expected = surrounded(spec, points, true, turnedFrom).map((rgb) => rgb.map((x) => 1.5 * x));
      compare(`${name}, ${kind}`, points, drawn.pixels, expected, gpu && tangents ? 0.09 : 0.06);
    } else {
      compare(`${name}, ${kind}`, points, drawn.pixels, lit(`${name}.json`, kind, points), 0.01);
    }
  }
}

// As `hshfit eval` has the material of the library, but for the table's largest error of
// ln(f + 0.001) at each pixel.
async function proveMember(page, { name, spec, from, kinds }) {
  const [member, tableError] = [nameOf(spec), libraries[name]];
  for (const kind of kinds) {
    const drawn = await page.evaluate(draw, {
      ...{ name, gpu, kind, side, view, lights, turn, member, from },
      picture: kind === 'picture' ? surroundings : null,
    });
    const file = `${name}.library:${member}`;
    const title = `${name}, ${member} by ${from}, ${kind}`;
    let points = surfacePoints(drawn, gpu, false);
    if (kind === 'picture') {
      points = points.filter((_, i) => i % Math.ceil(points.length / 30) === 0);
      const expected = surrounded(file, points, true, turnedFrom).map((rgb) => rgb.map((x) => 1.5 * x));
      compare(title, points, drawn.pixels, expected, 0.06);
      continue;
    }
    const expected = lit(file, kind, points),
      even = lit(file, kind, points, true);
    // A pixel of SwiftShader is off by a hundredth where highlights are steep.
    const most = Math.max(...expected.flat());
    let worst = 0;
    points.forEach(({ k }, i) => {
      for (let c = 0; c < 3; ++c) {
        const bound = Math.expm1(tableError) * (expected[i][c] + 1e-3 * even[i][c]) + 0.01 * most;
        worst = Math.max(worst, Math.abs(drawn.pixels[4 * k + c] - expected[i][c]) / bound);
      }
    });
    compare(title, points, drawn.pixels, expected, Math.max(0.01, tableError));
    expect(worst <= 1, `${title}: ${worst} times what the table's error explains`);
  }
}

async function provePage(page, name, hash = '') {
  await page.goto(`http://localhost/out/${name}/${name}_three.html${hash}`, { waitUntil: 'commit' });
  expect((await page.textContent('#message')).startsWith('Rendering'), 'the page says nothing first');
  await page.waitForSelector('#message', { state: 'hidden' });
  expect((await page.textContent('h1')).length > 3, 'no title');
  // Brightness of the middle of the stage, where the sphere is, which its corner is not.
  const box = await page.locator('#stage').boundingBox();
  const part = (x, y) => page.screenshot({ clip: { x, y, width: 40, height: 40 } });
  const picture = await part(box.x + box.width / 2 - 20, box.y + box.height / 2 - 20);
  const corner = await part(box.x + 10, box.y + 10);
  expect(!picture.equals(corner), 'the page shows no sphere');
  const bright = await page.evaluate(async (text) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
    const context = new OffscreenCanvas(40, 40).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data } = context.getImageData(0, 0, 40, 40);
    let least = 255;
    for (let k = 0; k < data.length; k += 4) least = Math.min(least, data[k] + data[k + 1] + data[k + 2]);
    return least;
  }, picture.toString('base64'));
  console.log(`page of ${name}: least brightness in its middle ${bright} of 765`);
  expect(bright > 30, 'the page shows a black ball');
}

await finish(async () => {
  try {
    for (const { name, spec, project, export: more = [] } of cases) {
      run('project', spec, '-o', `${name}.json`, ...project);
      run('export', `${name}.json`, '-o', `out/${name}`, '--target', 'three', '--no-error', ...more);
    }
    for (const [name, tableError] of Object.entries(libraries)) {
      run('library', 'learn', grey, gold, paint, '--components', '3', '--bytes', '60', '--limit', '10',
        '--limit-maximum', '10', '--limit-flip', '1', '-o', `${name}.library`);
      run('library', 'export', `${name}.library`, '-o', `out/${name}`, '--target', 'three', '--table-error', `${tableError}`);
    }
    await withBrowser(
      driver,
      async (page, complaints) => {
        await page.goto('http://localhost/');
        for (const one of cases) await proveMaterial(page, one);
        for (const one of members) await proveMember(page, one);
        // Headless Chromium without a GPU ends its GPU process when WebGPU draws into a canvas.
        if (!gpu) await provePage(page, 'ward');
        if (!gpu) await provePage(page, 'atlas', `#material=${encodeURIComponent(nameOf(paint))}`);
        const real = complaints.filter((text) => !/GPU stall|Context Lost|Instance dropped/i.test(text));
        expect(real.length === 0, `console: ${real.join('; ')}`);
      },
      { files },
    );
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
