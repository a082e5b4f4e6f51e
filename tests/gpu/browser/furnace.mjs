// furnace.mjs DRIVER FOLDER [PICTURES]: the path tracer of furnace.html under uniform light of
// radiance 1. A sphere then has the directional albedo of its form at every pixel, and two touching
// spheres that lose nothing are as bright as the light. PICTURES is a folder for screenshots.
// furnace.mjs DRIVER EXPORT.hsh.json SHADER.es.glsl [PICTURES]: an export with constants, against
// the albedos of its sidecar.
import { readFileSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { decoded, expect, finish, here, readJson, withBrowser } from './browser.mjs';

const bins = 8;

// Of the albedo, per channel, at a cosine; rows are at polar angles from 0 to 90 degrees.
function albedoAt(rows, cosine) {
  const x = (Math.acos(cosine) / (Math.PI / 2)) * (rows.length - 1),
    k = Math.min(Math.floor(x), rows.length - 2);
  return rows[k].map((low, c) => low + (x - k) * (rows[k + 1][c] - low));
}

// Means over pixels by cos(theta_o), of the picture and of the albedo: [[found, expected], …] per
// bin, channels averaged.
function byElevation(job, values) {
  const sums = Array.from({ length: bins }, () => [0, 0, 0]);
  for (let k = 0; k < values.length; k += 4) {
    const cosine = values[k + 3];
    if (cosine < 0.1) continue;
    const expected = albedoAt(job.albedo, Math.min(cosine, 1));
    const sum = sums[Math.min(bins - 1, Math.floor((bins * (cosine - 0.1)) / 0.9))];
    for (let c = 0; c < expected.length; ++c) sum[0] += values[k + c] / expected.length;
    for (const value of expected) sum[1] += value / expected.length;
    ++sum[2];
  }
  return sums.map(([found, expected, count]) => [found / count, expected / count]);
}

async function render(page, job, pictures) {
  const values = decoded(await page.evaluate((given) => window.furnace(given), job), Float32Array);
  if (pictures)
    await page.screenshot({ path: join(pictures, `${job.name.replaceAll(/\W+/g, '_')}.png`) });
  return values;
}

async function proveAlbedo(page, job, pictures) {
  const values = await render(page, { ...job, spheres: 1 }, pictures);
  const errors = byElevation(job, values).map(([found, expected]) => found / expected - 1);
  const worst = Math.max(...errors.map(Math.abs));
  console.log(
    `${job.name.padEnd(24)} relative error by elevation ${errors.map((e) => e.toFixed(4)).join(' ')}`,
  );
  expect(worst < 0.01, `${job.name}: ${worst} off the albedo`);
}

// Of a material with albedo 1.
async function proveWhite(page, job, pictures) {
  const values = await render(page, { ...job, spheres: 2, name: `${job.name} twice` }, pictures);
  let worst = 0,
    mean = 0,
    count = 0;
  for (let k = 0; k < values.length; k += 4) {
    if (values[k + 3] === 0) continue;
    mean += values[k];
    ++count;
    worst = Math.max(worst, Math.abs(values[k] - 1));
  }
  console.log(
    `${job.name.padEnd(24)} two spheres: mean ${(mean / count).toFixed(6)}, largest distance from 1 ` +
      worst.toExponential(1),
  );
  expect(Math.abs(mean / count - 1) < 1e-4, `${job.name}: two spheres have ${mean / count}`);
  expect(worst < 1e-2, `${job.name}: a pixel is ${worst} from 1`);
}

// The albedos of a sidecar at its few elevations, compared with pixels within 1.5 degrees.
async function proveExport(page, sidecar, shader, pictures) {
  const document = readJson(sidecar);
  const job = {
    name: document.source.brdf.split('/').pop(),
    snippet: readFileSync(shader, 'utf8'),
    cosine: document.cos_included,
    textured: false,
    spheres: 1,
    size: 192,
    samples: 16,
    passes: 32,
  };
  const values = await render(page, job, pictures);
  for (const { wo, albedo, estimate } of document.proposal.efficiency) {
    const wanted = albedo ?? estimate;
    const sums = [0, 0];
    for (let k = 0; k < values.length; k += 4) {
      const cosine = values[k + 3];
      const apart = Math.acos(Math.min(1, cosine)) - Math.acos(Math.min(1, wo[2]));
      if (cosine === 0 || Math.abs(apart) > Math.PI / 120) continue;
      for (let c = 0; c < wanted.length; ++c) sums[0] += values[k + c] / wanted.length;
      ++sums[1];
    }
    const found = sums[0] / sums[1],
      expected = wanted.reduce((a, b) => a + b) / wanted.length;
    console.log(
      `${job.name}: cos(theta_o) ${wo[2].toFixed(3)}: radiance ${found.toFixed(5)}, albedo ` +
        `${expected.toFixed(5)}, ${(100 * (found / expected - 1)).toFixed(2)} %`,
    );
  }
}

const [driver, folder, ...rest] = process.argv.slice(2);
const page0 = readFileSync(join(here, 'furnace.html'), 'utf8');
const files = (path) => (path === '/' ? { contentType: 'text/html', body: page0 } : null);
await finish(() =>
  withBrowser(
    driver,
    async (page, complaints) => {
      const open = () => page.goto('http://localhost/');
      await open();
      if (!statSync(folder).isDirectory()) return proveExport(page, folder, rest[0], rest[1]);
      for (const file of readJson(join(folder, 'sampling.json'))) {
        const job = { ...readJson(join(folder, file)), size: 96, samples: 16, passes: 16 };
        if (!job.isotropic) continue;
        await open();
        if (job.white) await proveWhite(page, job, rest[0]);
        else await proveAlbedo(page, job, rest[0]);
      }
      expect(complaints.length === 0, complaints.join('\n'));
    },
    { files },
  ),
);
