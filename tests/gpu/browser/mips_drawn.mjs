// mips_drawn.mjs DRIVER PROGRAM [FOLDER]: the files of the target mips in three.js' own material, as its
// KTX2Loader reads them, against the mean over the texels below every pixel.
//
// Facing: a texel of a level is a pixel, the map is seen from the front, one lamp after the other. The
// columns are relative L2 over all lamps and pixels, the largest difference over the mean radiance, the
// relative L2 of the albedo, and all light over that of the mean. Inclined: a plane seen from near to far with the hardware's own choice of level; the
// last column is the mean difference of what is shown, from 0 to 1.
// With FOLDER more levels, and the pictures: mips_drawn.png.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, normalize, resolve } from 'node:path';
import { read } from 'ktx-parse';
import { decoded, expect, filesOfThree, finish, here, withBrowser } from './browser.mjs';
import { levelNumbers, levelSize, normalOf, widths } from './mip_numbers.mjs';
import { shownDifference, writeSheet } from '../renderers/pictures.mjs';

const [driver, program, out] = [process.argv[2], resolve(process.argv[3]), process.argv[4]];
const folder = mkdtempSync(join(tmpdir(), 'hshfit-mips-'));
const maps = [
  { name: 'bumpy', material: { color: [0.8, 0.25, 0.1], metalness: 0 } },
  { name: 'brushed', material: { color: [0.91, 0.92, 0.92], metalness: 1 } },
];
// Sets of textures; `map` true where the anisotropy has one, `edits` where three.js' shader is edited by
// examples/renderers/three_ellipses.js.
const kinds = {
  'ordinary mips': { source: 'ordinary' },
  'normal, roughness': { source: 'files' },
  'normal, roughness, anisotropy': { source: 'files', map: true },
  'the same, axes turned': { source: 'files', map: true, edits: { energy: false } },
  'the same, not compressed': { source: 'levels', map: true, edits: { energy: false } },
  'axes turned, energy of ellipses': { source: 'files', map: true, edits: {} },
  'normal, round roughness': { source: 'round' },
};

const blank = `<!DOCTYPE html><title>mips</title><script type="importmap">{"imports": {
  "three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}</script>`;
const ofFolder = filesOfThree(folder, blank);
const ellipses = { contentType: 'text/javascript', body: readFileSync(join(here, '../../../examples/renderers/three_ellipses.js')) };
const files = (path) => (path === '/three_ellipses.js' ? ellipses : ofFolder(path));

const text = (floats) => Buffer.from(Float32Array.from(floats).buffer).toString('base64');

// A level as the texels of three maps: those of the files before compression (`levels`), with the roughness of
// a round lobe of the same mean square (`round`), or the mean normals of level 0 with its roughness (`ordinary`).
function texels(file, level, source) {
  const [width, height] = levelSize(file, level),
    [wide] = levelSize(file, 0);
  const [numbers, base] = [levelNumbers(file, level), levelNumbers(file, 0)];
  const made = { width, height, normal: [], roughness: [], anisotropy: [] };
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const number = numbers(y * width + x);
      let [normal, own] = [normalOf(number), widths(number)];
      if (source === 'ordinary') {
        normal = [0, 0, 0];
        for (let k = 0; k < 4 ** level; ++k) {
          const [column, row] = [(x << level) + (k % (1 << level)), (y << level) + (k >> level)];
          normalOf(base(row * wide + column)).forEach((value, c) => (normal[c] += value / 4 ** level));
        }
        own = widths(base(0));
      }
      // An axis and its opposite are the same; filters mix those on one side.
      if (own.angle < 0) own.angle += Math.PI;
      const round = Math.sqrt((own.longer ** 2 + own.shorter ** 2) / 2);
      const strength = Math.sqrt(Math.max(0, own.longer - own.shorter) / (1 - own.shorter));
      made.normal.push(...normal.map((value) => (value + 1) / 2), 1);
      made.roughness.push(1, Math.sqrt(source === 'round' ? round : own.shorter), 1, 1);
      made.anisotropy.push((Math.cos(own.angle) + 1) / 2, (Math.sin(own.angle) + 1) / 2, strength, 1);
    }
  return { ...made, normal: text(made.normal), roughness: text(made.roughness), anisotropy: text(made.anisotropy) };
}

// In the page: a plane of the map's material with one of its three sets of textures, or with level 0 alone.
async function prepare({ name, material, kinds, levels }) {
  const three = await import('three');
  const { KTX2Loader } = await import('three/addons/loaders/KTX2Loader.js');
  const { withEllipses } = await import('/three_ellipses.js');
  const renderer = (window.renderer ??= new three.WebGLRenderer());
  const floats = (word) => new Float32Array(checks.bytesOf(word).buffer);
  const repeated = (texture) => {
    texture.wrapS = texture.wrapT = three.RepeatWrapping;
    texture.anisotropy = renderer.capabilities.getMaxAnisotropy();
    texture.needsUpdate = true;
    return texture;
  };
  const ofLevels = (from, role) => {
    const mipmaps = from.map((level) => ({ data: floats(level[role]), width: level.width, height: level.height }));
    const { data, width, height } = mipmaps[0];
    const texture = new three.DataTexture(data, width, height, three.RGBAFormat, three.FloatType);
    texture.magFilter = three.LinearFilter;
    texture.minFilter = mipmaps.length > 1 ? three.LinearMipmapLinearFilter : three.LinearFilter;
    if (mipmaps.length > 1) texture.mipmaps = mipmaps;
    return repeated(texture);
  };
  const loader = new KTX2Loader().detectSupport(renderer);
  const sets = { truth: {} };
  for (const role of ['normal', 'roughness']) sets.truth[role] = ofLevels(levels.levels.slice(0, 1), role);
  for (const [kind, { source, map }] of Object.entries(kinds)) {
    sets[kind] = {};
    for (const role of ['normal', 'roughness', ...(map ? ['anisotropy'] : [])])
      sets[kind][role] = source === 'files' ? repeated(await loader.loadAsync(`/${name}/out/material.${role}.ktx2`)) : ofLevels(levels[source], role);
  }
  // Rows of the maps are from the top, y of normals is up, as in glTF.
  const geometry = new three.PlaneGeometry(2, 2);
  const { uv, position } = geometry.attributes;
  for (let k = 0; k < uv.count; ++k) uv.setY(k, 1 - uv.getY(k));
  geometry.setAttribute('tangent', new three.BufferAttribute(Float32Array.from({ length: 4 * position.count }, (_, k) => (k % 4 === 0 || k % 4 === 3 ? 1 : 0)), 4));
  const materials = Object.fromEntries(Object.entries(sets).map(([kind, { normal, roughness, anisotropy }]) => {
    const made = new three.MeshPhysicalMaterial({
      color: new three.Color().setRGB(...material.color), metalness: material.metalness,
      roughness: 1, normalMap: normal, roughnessMap: roughness,
      ...(anisotropy ? { anisotropy: 1, anisotropyMap: anisotropy } : {}),
    });
    if (kinds[kind]?.edits) withEllipses(made, kinds[kind].edits);
    return [kind, made];
  }));
  const mesh = new three.Mesh(geometry, materials.truth);
  const lamp = new three.DirectionalLight(0xffffff, Math.PI);
  const scene = new three.Scene().add(mesh, lamp);
  const plain = geometry.attributes.uv.array.slice();
  const targets = {};
  // `side` pixels along an edge of the camera's picture, from `samples` each way: the mean.
  window.drawn = ({ kind, lampAt, side, samples, camera, repeats }) => {
    geometry.attributes.uv.array.set(plain.map((value) => value * repeats));
    geometry.attributes.uv.needsUpdate = true;
    mesh.material = materials[kind];
    lamp.position.set(...lampAt);
    const tiles = Math.ceil((side * samples) / 1024),
      wide = (side * samples) / tiles,
      own = side / tiles;
    const target = (targets[wide] ??= new three.WebGLRenderTarget(wide, wide, { type: three.FloatType }));
    renderer.setRenderTarget(target);
    const result = new Float32Array(4 * side * side),
      pixels = new Float32Array(4 * wide * wide);
    for (let tile = 0; tile < tiles * tiles; ++tile) {
      const [column, row] = [tile % tiles, Math.floor(tile / tiles)];
      camera.setViewOffset(side * samples, side * samples, column * wide, row * wide, wide, wide);
      renderer.render(scene, camera);
      renderer.readRenderTargetPixels(target, 0, 0, wide, wide, pixels);
      for (let k = 0; k < wide * wide; ++k) {
        const x = column * own + Math.floor((k % wide) / samples),
          y = (tiles - 1 - row) * own + Math.floor(Math.floor(k / wide) / samples);
        for (let c = 0; c < 4; ++c) result[4 * (y * side + x) + c] += pixels[4 * k + c] / samples ** 2;
      }
    }
    return result;
  };
  const front = new three.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
  front.position.z = 3;
  const inclined = new three.PerspectiveCamera(30, 1, 0.1, 20);
  inclined.position.set(0, -2.4, 0.9);
  inclined.up.set(0, 0, 1);
  inclined.lookAt(0, -0.15, 0);
  window.cameras = { front, inclined };
}

// In the page: sums over lamps and pixels, for each kind, of a level with one texel a pixel.
function facing({ kinds, level, side, lamps }) {
  const setting = { side, camera: cameras.front, repeats: 1 };
  const sums = kinds.map(() => ({ wrong: 0, largest: 0, albedo: new Float64Array(3 * side * side) }));
  const albedo = new Float64Array(3 * side * side);
  let [all, mean] = [0, 0];
  for (const lampAt of lamps) {
    const truth = drawn({ ...setting, kind: 'truth', lampAt, samples: 4 * 2 ** level });
    kinds.forEach((kind, n) => {
      const found = drawn({ ...setting, kind, lampAt, samples: 1 });
      for (let k = 0; k < truth.length; ++k) {
        if (k % 4 === 3) continue;
        const to = 3 * (k >> 2) + (k % 4);
        const gap = found[k] - truth[k];
        sums[n].wrong += gap ** 2;
        sums[n].largest = Math.max(sums[n].largest, Math.abs(gap));
        sums[n].albedo[to] += found[k];
        if (n > 0) continue;
        all += truth[k] ** 2;
        mean += truth[k] / (3 * side * side * lamps.length);
        albedo[to] += truth[k];
      }
    });
  }
  return sums.map(({ wrong, largest, albedo: own }) => {
    let [off, square, light, expected] = [0, 0, 0, 0];
    own.forEach((value, k) => {
      off += (value - albedo[k]) ** 2;
      square += albedo[k] ** 2;
      light += value;
      expected += albedo[k];
    });
    return { l2: Math.sqrt(wrong / all), largest: largest / mean, albedo: Math.sqrt(off / square), light: light / expected };
  });
}

// In the page: one picture as Base64.
function picture(setting) {
  const bytes = new Uint8Array(drawn({ ...setting, camera: cameras.inclined }).buffer);
  let word = '';
  for (let k = 0; k < bytes.length; k += 8192) word += String.fromCharCode(...bytes.subarray(k, k + 8192));
  return btoa(word);
}

// Directions of a Fibonacci spiral over the hemisphere, even in solid angle.
const lampsOf = (count) => Array.from({ length: count }, (_, k) => {
  const [z, phi] = [(k + 0.5) / count, k * Math.PI * (3 - Math.sqrt(5))];
  return [Math.sqrt(1 - z * z) * Math.cos(phi), Math.sqrt(1 - z * z) * Math.sin(phi), z];
});

const inclinedLamps = [[0.15, 0.8, 0.58], [0.4, 0.6, 0.7], [-0.6, 0.3, 0.75]];
const inclinedSide = 96;
const shown = ['ordinary mips', 'normal, roughness, anisotropy', 'the same, axes turned'];

// The pictures of a map by every kind under every lamp, rows of `sheet`, and their errors.
async function drawInclined(page, map, sheet) {
  const errors = Object.fromEntries(Object.keys(kinds).map((kind) => [kind, []]));
  for (const [n, lampAt] of inclinedLamps.entries()) {
    const take = async (kind, samples) => {
      const word = await page.evaluate(picture, { kind, lampAt, side: inclinedSide, samples, repeats: 4 });
      const pixels = decoded(word, Float32Array);
      return { size: inclinedSide, pixels };
    };
    const expected = await take('truth', out ? 32 : 16);
    const row = [];
    for (const kind of Object.keys(kinds)) {
      const found = await take(kind, 1);
      let [wrong, all, largest, mean] = [0, 0, 0, 0];
      found.pixels.forEach((value, k) => {
        if (k % 4 === 3) return;
        const gap = value - expected.pixels[k];
        wrong += gap ** 2;
        all += expected.pixels[k] ** 2;
        largest = Math.max(largest, Math.abs(gap));
        mean += expected.pixels[k] / (3 * inclinedSide ** 2);
      });
      errors[kind].push({ l2: Math.sqrt(wrong / all), largest: largest / mean, shown: shownDifference(expected, found) });
      if (shown.includes(kind)) row.push({ expected, found });
    }
    if (n === 1) sheet.push(row);
  }
  return errors;
}

const three = (value) => value.toFixed(3);

await finish(async () => {
  try {
    if (out) mkdirSync(out, { recursive: true });
    const sheet = [];
    await withBrowser(driver, async (page, complaints) => {
      await page.goto('http://localhost/');
      const known = await page.evaluate(() => {
        const gl = document.createElement('canvas').getContext('webgl2');
        return ['EXT_texture_compression_rgtc', 'EXT_texture_compression_bptc'].every((name) => gl.getExtension(name));
      });
      if (!known) {
        console.log('skipped: this browser has no BC5 or no BC7');
        return;
      }
      for (const map of maps) {
        execFileSync(program, ['svbrdf', join(here, `../../../examples/maps/${map.name}.json`), '-o', map.name, '--form', 'ellipse', '--checks', '1', '--quiet'], { cwd: folder });
        execFileSync(program, ['export', `${map.name}/material.json`, '-o', `${map.name}/out`, '--target', 'mips,ktx2', '--quiet'], { cwd: folder });
        const file = read(readFileSync(join(folder, map.name, 'out/material.map.ktx2')));
        const levels = Object.fromEntries(['levels', 'ordinary', 'round'].map((source) => [source, file.levels.map((_, level) => texels(file, level, source))]));
        await page.evaluate(prepare, { ...map, kinds, levels });
        const names = Object.keys(kinds);
        for (const level of out ? [1, 2, 3, 4] : [3]) {
          const side = file.pixelWidth >> level;
          const found = await page.evaluate(facing, { kinds: names, level, side, lamps: lampsOf(64) });
          found.forEach(({ l2, largest, albedo, light }, k) => console.log(`| ${map.name} | facing, level ${level} | ${names[k]} | ${three(l2)} | ${three(largest)} | ${three(albedo)} | ${three(light)} |`));
          if (level !== 3) continue;
          const of = (kind) => found[names.indexOf(kind)];
          const l2 = (kind) => of(kind).l2;
          const [ordinary, turned, exact] = [l2('ordinary mips'), l2('the same, axes turned'), l2('the same, not compressed')];
          const [before, restored] = [of('the same, axes turned').light, of('axes turned, energy of ellipses').light];
          if (map.material.metalness) expect(before < 0.93 && Math.abs(restored - 1) < 0.03, `${map.name}: ${restored} of the light, and ${before} without the energy of ellipses`);
          expect(turned < 0.7 * ordinary, `${map.name}, level ${level}: ${turned}, and ordinary mips ${ordinary}`);
          expect(turned < exact + 0.1 * ordinary, `${map.name}, level ${level}: compression costs ${turned - exact}`);
        }
        const errors = await drawInclined(page, map, sheet);
        for (const kind of names) {
          const mean = (name) => errors[kind].reduce((sum, error) => sum + error[name] / errors[kind].length, 0);
          console.log(`| ${map.name} | inclined | ${kind} | ${three(mean('l2'))} | ${three(mean('largest'))} | ${three(mean('shown'))} |`);
        }
        const total = (kind) => errors[kind].reduce((sum, { l2 }) => sum + l2, 0);
        expect(total('the same, axes turned') < total('ordinary mips'), `${map.name}: inclined, no better than ordinary mips`);
      }
      expect(complaints.length === 0, complaints.join('\n'));
    }, { files });
    if (out && sheet.length) writeSheet(join(out, 'mips_drawn.png'), sheet);
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
