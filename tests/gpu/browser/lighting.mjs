// lighting.mjs DRIVER FOLDER [PICTURE.png]: the shaders of lighting in FOLDER (write_lighting) on
// DRIVER: WebGL 2 on swiftshader or llvmpipe, or webgpu. Their values at the tests of the sidecar,
// and pictures of the scenes beside direct integration.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, finish, readJson, withBrowser } from './browser.mjs';
import { drawWebGl2, drawWebGpu, sheet } from './lighting_page.mjs';

const [driver, folder, picture] = process.argv.slice(2);
const bytesOf = (name) => readFileSync(join(folder, name));
const floatsOf = (name) => {
  const bytes = bytesOf(name);
  return new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
};
const base64 = (array) =>
  Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString('base64');
const scenes = readJson(join(folder, 'scenes.json'));
const sidecar = readJson(join(folder, scenes.sidecar));
const language = driver === 'webgpu' ? 'wgsl' : 'glsl-es';

// What a page needs to draw normals, viewers and, of materials with one, tangents with one model.
function jobOf(entry, { normals, viewers, tangents }, width, height) {
  const shader = entry.shaders.find(({ target }) => target === language);
  const numbers = {
    coefficients: () => entry.light.flat(),
    'split-sum': () => entry.irradiance.flat(),
    prefiltered: () => [],
    ltc: () => entry.areas.flatMap(({ corners, radiance }) => [...corners.flat(), ...radiance]),
  };
  const file = (files) => files.find(({ path }) => path.endsWith('.bin')).path;
  return {
    model: entry.model,
    source: bytesOf(shader.path).toString(),
    table: { ...entry.table, bytes: bytesOf(file(entry.table.files)).toString('base64') },
    cube: entry.cube && {
      levels: entry.cube.levels,
      bytes: bytesOf(file(entry.cube.files)).toString('base64'),
    },
    light: numbers[entry.model](),
    normals: base64(normals),
    viewers: base64(viewers),
    tangents: sidecar.rows.azimuths && base64(tangents),
    width,
    height,
  };
}

const four = (vectors) => Float32Array.from(vectors.flatMap((v) => [...v, 1]));

async function prove(page) {
  const draw = (job) => page.evaluate(driver === 'webgpu' ? drawWebGpu : drawWebGl2, job);
  const decoded = (text) => {
    const bytes = Buffer.from(text, 'base64');
    return new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  };
  let name = '';
  for (const entry of sidecar.models) {
    const normals = four(sidecar.tests.map(({ normal }) => normal));
    const viewers = four(sidecar.tests.map(({ viewer }) => viewer));
    const tangents = four(sidecar.tests.map(({ tangent }) => tangent ?? [0, 0, 0]));
    const found = await draw(jobOf(entry, { normals, viewers, tangents }, 8, 8));
    name = found.name;
    const values = decoded(found.values);
    let worst = 0,
      most = 0;
    sidecar.tests.forEach((test, k) =>
      test[entry.model].forEach((value, c) => {
        worst = Math.max(worst, Math.abs(values[4 * k + c] - value));
        most = Math.max(most, Math.abs(value));
      }),
    );
    console.log(`${entry.model.padEnd(13)} tests: ${(worst / most).toExponential(1)}`);
    // Cube maps are float16, and filters at the corners of a cube differ.
    const bound = entry.cube ? 5e-3 : 2e-5;
    expect(worst <= bound * most, `${entry.model} differs by ${worst / most}`);
  }
  const rows = [];
  for (const scene of scenes.scenes) {
    const normals = floatsOf(`${scene.name}.normals.bin`);
    const truth = floatsOf(`${scene.name}.integration.bin`);
    const tangents = floatsOf(`${scene.name}.tangents.bin`);
    const viewers = new Float32Array(normals.length);
    for (let i = 0; i < viewers.length; ++i) viewers[i] = [...scenes.viewer, 1][i % 4];
    const row = [{ title: 'integration', values: base64(truth), channels: 3 }];
    for (const entry of sidecar.models) {
      const found = await draw(
        jobOf(entry, { normals, viewers, tangents }, scene.size, scene.size),
      );
      const values = decoded(found.values);
      const library = floatsOf(`${scene.name}.${entry.model}.bin`);
      let squares = 0,
        all = 0,
        maximum = 0,
        mean = 0,
        count = 0,
        apart = 0;
      for (let k = 0; k < truth.length / 3; ++k) {
        if (normals[4 * k + 3] === 0) continue;
        for (let c = 0; c < 3; ++c) {
          const gap = values[4 * k + c] - truth[3 * k + c];
          squares += gap * gap;
          all += truth[3 * k + c] ** 2;
          maximum = Math.max(maximum, Math.abs(gap));
          mean += truth[3 * k + c];
          count += 1;
          apart += (values[4 * k + c] - library[3 * k + c]) ** 2;
        }
      }
      const error = Math.sqrt(squares / all);
      console.log(
        `${scene.name.padEnd(7)} ${entry.model.padEnd(13)} against integration: relative L2 ` +
          `${error.toFixed(4)} (library ${scene.models[entry.model].relative_l2.toFixed(4)}), ` +
          `maximum ${((maximum * count) / mean).toFixed(3)}, ` +
          `${found.nanoseconds.toFixed(0)} ns a pixel on ${found.name}`,
      );
      const limit = entry.cube ? 5e-3 : 1e-4;
      expect(
        Math.sqrt(apart / all) <= limit,
        `${scene.name}, ${entry.model}: not the library's picture (${Math.sqrt(apart / all)})`,
      );
      row.push({
        title: `${entry.model} ${(100 * error).toFixed(1)} %`,
        values: base64(values),
        channels: 4,
      });
    }
    rows.push({ size: scene.size, mask: base64(normals), pictures: row });
  }
  if (picture) {
    const url = await page.evaluate(sheet, rows);
    writeFileSync(picture, Buffer.from(url.split(',')[1], 'base64'));
  }
  return name;
}

const files = (path) =>
  path === '/' ? { contentType: 'text/html', body: '<title>lighting</title>' } : null;
await finish(() =>
  withBrowser(
    driver,
    async (page, complaints) => {
      await page.goto('http://localhost/');
      console.log(await prove(page));
      expect(complaints.length === 0, complaints.join('\n'));
    },
    { files },
  ),
);
