// Chromium and functions that the checks share.
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, normalize } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';

export const here = dirname(fileURLToPath(import.meta.url));

const quiet = [
  '--no-sandbox',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];
const drivers = {
  swiftshader: ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  llvmpipe: ['--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
  webgpu: ['--enable-unsafe-webgpu', '--enable-unsafe-swiftshader'],
};

// `use(page)` in a fresh browser with an empty profile; `files` answers http://localhost/
// paths, and all other network requests fail.
export async function withBrowser(
  driver,
  use,
  { files = null, viewport = null, dark = false } = {},
) {
  const profile = mkdtempSync(join(tmpdir(), 'hshfit-browser-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    args: [...quiet, ...drivers[driver]],
    viewport: viewport ?? { width: 800, height: 600 },
    colorScheme: dark ? 'dark' : 'light',
  });
  try {
    const complaints = [];
    await context.route(/^https?:/, async (route) => {
      const path = new URL(route.request().url()).pathname;
      const found = files?.(path);
      if (!found) {
        complaints.push(`asked for ${route.request().url()}`);
        return route.abort();
      }
      return route.fulfill(found);
    });
    await context.addInitScript({ path: join(here, 'page_functions.js') });
    const page = await context.newPage();
    page.setDefaultTimeout(240000);
    page.on('console', (message) => {
      // A driver's warning about a slow readback is no error.
      const slow = message.text().includes('GL Driver Message (OpenGL, Performance');
      if (['error', 'warning'].includes(message.type()) && !slow) complaints.push(message.text());
    });
    page.on('pageerror', (error) => complaints.push(error.message));
    return await use(page, complaints);
  } finally {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  }
}

export const decoded = (text, Type) => {
  const bytes = Buffer.from(text, 'base64');
  return new Type(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
};

// Floats as text for a page, whose `checks.floatsOf` reads it. Lists of numbers go to and fro one by one.
export const encoded = (floats) => Buffer.from(Float32Array.from(floats).buffer).toString('base64');

// Answers the requests of a page that imports three.js: the page itself, the files of three.js, and those of
// `folder`.
export const filesOfThree = (folder, page) => (path) => {
  if (path === '/') return { contentType: 'text/html', body: page };
  if (path.includes('..')) return null;
  const root = path.startsWith('/three/') ? join(here, '../node_modules') : folder;
  const body = readFileSync(normalize(join(root, path)));
  return { contentType: path.endsWith('.js') ? 'text/javascript' : 'application/octet-stream', body };
};

export const readJson = (path) => JSON.parse(readFileSync(path, 'utf8'));

// Largest differences of eval and shade, of the largest values; NaN in `expected` is not compared.
export function differences(job, expected, found) {
  const outputs = 2 * job.channels + job.lights;
  const worst = [0, 0],
    most = [0, 0];
  for (let i = 0; i < expected.length; ++i) {
    if (Number.isNaN(expected[i])) continue;
    const kind = i % outputs >= 2 * job.channels ? 1 : 0;
    const gap = Math.abs(found[i] - expected[i]);
    worst[kind] = Math.max(worst[kind], gap < 1e30 ? gap : 1e30);
    most[kind] = Math.max(most[kind], Math.abs(expected[i]));
  }
  return { eval: worst[0] / most[0], shade: worst[1] / most[1] };
}

let failures = 0;
export function expect(condition, text) {
  if (condition) return;
  ++failures;
  console.log(`FAILED: ${text}`);
}

// Runs a check and ends the process: 0, or 1 where something failed.
export async function finish(check) {
  try {
    await check();
  } catch (error) {
    ++failures;
    console.log(`FAILED: ${error.stack ?? error}`);
  }
  process.exit(failures > 0 ? 1 : 0);
}

// Every case through `run(page, job)`, which gives outputs in the order of `expected`, or throws.
export async function proveCases(folder, driver, page, run) {
  for (const file of readJson(join(folder, 'cases.json'))) {
    const job = readJson(join(folder, file));
    const found = await run(page, job);
    if (found.left) {
      console.log(`${job.name.padEnd(48)} left out: ${found.left}`);
      continue;
    }
    const d = differences(
      job,
      decoded(job.expected, Float64Array),
      decoded(found.values, Float32Array),
    );
    console.log(
      `${job.name.padEnd(48)} eval ${d.eval.toExponential(1)}  shade ${d.shade.toExponential(1)}`,
    );
    expect(d.eval <= job.tolerance[driver], `${job.name}: eval differs by ${d.eval}`);
    expect(d.shade <= job.tolerance[driver], `${job.name}: shade differs by ${d.shade}`);
  }
}

// Faults that a check has to detect: an undeclared name, a swapped channel order in the texels
// (rows from the bottom), and a wrong constant.
export function brokenCases(folder, language) {
  const job = readJson(join(folder, 'case1.json'));
  const undeclared = {
    ...job,
    [language]: job[language].replace(/hsh_uv\(wo\)/, 'hsh_uv(notDeclared)'),
  };
  const { width, height, layers } = job.coefficients;
  const bytes = Buffer.from(job.coefficients.bytes, 'base64');
  const row = bytes.length / layers / height,
    flipped = Buffer.alloc(bytes.length);
  for (let k = 0; k < layers * height; ++k) {
    const layer = Math.floor(k / height),
      y = k % height;
    bytes.copy(flipped, (layer * height + height - 1 - y) * row, k * row, (k + 1) * row);
  }
  const upsideDown = {
    ...job,
    coefficients: {
      width,
      height,
      layers,
      number: job.coefficients.number,
      bytes: flipped.toString('base64'),
    },
  };
  return { job, undeclared, upsideDown };
}

export async function proveBreaksShow(folder, page, language, run) {
  const { job, undeclared, upsideDown } = brokenCases(folder, language);
  expect(undeclared[language] !== job[language], 'the snippet could not be broken');
  let refused = '';
  try {
    await run(page, undeclared);
  } catch (error) {
    refused =
      String(error.message)
        .split('\n')
        .find((line) => /notDeclared/.test(line)) ?? '';
  }
  expect(refused, 'an undeclared name is not refused');
  console.log(`undeclared name: ${refused.trim()}`);
  const found = await run(page, upsideDown);
  const d = differences(
    job,
    decoded(job.expected, Float64Array),
    decoded(found.values, Float32Array),
  );
  expect(d.eval > 1e-2, 'texels upside down go unnoticed');
  console.log(`texels upside down: eval ${d.eval.toExponential(1)}`);
}
