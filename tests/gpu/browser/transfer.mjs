// transfer.mjs DRIVER PROGRAM: the page of `hshfit transfer` against the pictures of the program, and
// its light and materials as they change.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { expect, finish, withBrowser } from './browser.mjs';

const [driver, program] = process.argv.slice(2);
const scene = {
  format: 'hshfit-scene',
  version: 1,
  materials: [
    { name: 'white', brdf: 'lambert:kd=.8' },
    { name: 'red', brdf: 'lambert:kd=.7/.2/.1' },
    { name: 'satin', brdf: 'ggx:alpha=.5,F0=.9/.7/.4' },
    { name: 'brushed', brdf: 'ward:ax=.2,ay=.6' },
  ],
  lights: [{ light: 'sky:type=12,elevation=40,azimuth=-60,radiance=1' }],
  objects: [
    { name: 'floor', mesh: 'square', material: 'white', scale: 2 },
    { name: 'wall', mesh: 'square', material: 'red', theta: 90, at: [-1, 0, 1] },
    { name: 'plate', mesh: 'square', material: 'satin', scale: 0.6, theta: 30, at: [0.3, 0, 0.7] },
    { name: 'sheet', mesh: 'square', material: 'brushed', scale: 0.5, theta: 20, at: [0, -1.2, 0.5] },
  ],
  cameras: [{ name: 'eye', position: [4, -4, 3], target: [0, 0, 0.5], width: 96 }],
};

// Runs in the page: returns the bytes of the canvas and of a picture.
async function pixels(picture) {
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  const read = (source) => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [96, 96];
    const context = canvas.getContext('2d', { willReadFrequently: true });
    context.drawImage(source, 0, 0);
    return [...context.getImageData(0, 0, 96, 96).data];
  };
  const own = read(document.getElementById('canvas'));
  if (!picture) return { own };
  const image = new Image();
  image.src = picture;
  await image.decode();
  return { own, other: read(image) };
}

const change = (page, use) => page.evaluate(`(() => { const p = window.transferPage; ${use};
  p.changed('light'); })()`);

async function prove(page, complaints, folder, matrices) {
  await page.goto(pathToFileURL(join(folder, 'transfer.html')).href);
  await page.waitForFunction(() => window.transferPage?.frames.length > 0);
  const png = readFileSync(join(folder, 'eye_scene_transfer.png')).toString('base64');
  const { own, other } = await page.evaluate(pixels, `data:image/png;base64,${png}`);
  // Outlines are sampled otherwise: the median over the surface, and few that are far off.
  const gaps = [];
  for (let k = 0; k < own.length; ++k)
    if (k % 4 < 3 && other[k] > 8) gaps.push(Math.abs(own[k] - other[k]));
  gaps.sort((a, b) => a - b);
  const at = (share) => gaps[Math.floor(share * (gaps.length - 1))];
  console.log(`${matrices}: gap of the median ${at(0.5)}, of 90 % ${at(0.9)}, of 97 % ${at(0.97)}`);
  expect(gaps.length > 8000, `only ${gaps.length} values of a surface`);
  expect(at(0.5) <= 1 && at(0.9) <= 4, 'the page differs from the program');

  const pictures = [JSON.stringify(own)];
  for (const use of ['p.state.turn = 120', 'p.state.tilt = 40', 'p.state.kind = 0',
    'p.state.order = 2', 'p.state.light = p.data.lights.length - 1', 'p.state.hour = 0.1',
    'p.chosen[0] = { material: 1, albedo: p.data.materials[1].albedo }',
    matrices ? 'p.chosen[1] = { material: 4, albedo: [0, 0, 0] }' : 'p.chosen[1].albedo = [0, 1, 0]']) {
    await change(page, use);
    pictures.push(JSON.stringify((await page.evaluate(pixels, null)).own));
  }
  const names = new Set(pictures);
  expect(names.size === pictures.length, `only ${names.size} of ${pictures.length} pictures differ`);
  expect(complaints.length === 0, `console: ${complaints.join('; ')}`);
}

await finish(async () => {
  const folder = mkdtempSync(join(tmpdir(), 'hshfit-transfer-'));
  try {
    writeFileSync(join(folder, 'scene.json'), JSON.stringify(scene));
    for (const matrices of [[], ['--local-order', '4', '--clusters', '8', '--components', '24']]) {
      execFileSync(program, ['transfer', join(folder, 'scene.json'), '-o', folder, '--rays', '100',
        '--passes', '2', '--edge', '0.4', '--reference-samples', '1', '--material',
        'ggx:alpha=.7,F0=.5', '--error', '1e-3', '--force', '--quiet', ...matrices]);
      await withBrowser(driver, (page, complaints) =>
        prove(page, complaints, folder, matrices.length > 0));
    }
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
