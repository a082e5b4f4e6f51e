// screenshots.mjs PROGRAM MEASURED FOLDER [NAME…]: the pictures of docs/reference/viewer.md,
// by the program and Chromium. MEASURED: an RGL file, whose folder the program runs in. Not in the
// page, but to be looked at: viewer-form-dark, viewer-form-narrow. tutorial-viewer is
// of docs/tutorial.md.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, dirname, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { expect, finish, withBrowser } from './browser.mjs';

const [program, measured, folder] = process.argv.slice(2, 5).map((path) => resolve(path));
const wanted = process.argv.slice(5);
const shots = [
  {
    name: 'viewer-phong',
    spec: 'phong:exponent=22',
    outgoing: '32',
    view: 'frames=16&order=5&clamp=false&lighting=point&lightElevation=24',
  },
  {
    name: 'viewer-ward',
    spec: 'ward:kd=0.05,ks=0.3,ax=0.15,ay=0.5',
    outgoing: '32x32',
    dark: true,
    view: 'frames=8&cycles=6&order=7&shape=teapot&lighting=both&azimuth=-8&elevation=18',
  },
  {
    name: 'viewer-measured',
    spec: basename(measured),
    outgoing: '32',
    view:
      'frames=8&cycles=4&order=10&layout=split&dividers=36,52,68&lighting=both' +
      '&azimuth=0&lightAzimuth=-52&lightElevation=36',
  },
  {
    name: 'viewer-light',
    spec: 'ggx:alpha=0.35,F0=0.9/0.6/0.3',
    outgoing: '32',
    lights: [
      'preetham:turbidity=3,elevation=25,azimuth=-110,radiance=2+uniform:radiance=0.1+' +
        'sun:elevation=25,azimuth=-110,angle=3,irradiance=5/4.5/3.6',
      'sky:type=12,elevation=40',
    ],
    view: 'frames=4&cycles=12&order=10&shape=teapot&skyTurn=20&azimuth=-8&elevation=18',
  },
  // Of docs/tutorial.md, whose first command writes MEASURED.
  {
    name: 'tutorial-viewer',
    spec: basename(measured),
    form: ['--form', 'halfway', '--precision', 'half'],
    view: 'frames=4&cycles=12',
  },
  ...[
    { name: 'viewer-form', view: 'frames=4&cycles=12' },
    { name: 'viewer-form-dark', view: 'frames=4&cycles=12&shape=teapot&azimuth=-8&elevation=18', dark: true },
    { name: 'viewer-form-narrow', view: 'frames=4&cycles=6', width: 420 },
  ].map((shot) => ({
    ...shot,
    spec: basename(measured),
    form: ['--form', 'halfway', '--precision', 'half'],
  })),
];

await finish(async () => {
  const work = mkdtempSync(join(tmpdir(), 'hshfit-screenshots-'));
  const run = (...words) =>
    execFileSync(program, [...words, '--quiet'], { cwd: dirname(measured) });
  try {
    for (const { name, spec, outgoing, view, dark, width = 1240, form, lights = [] } of shots) {
      if (wanted.length > 0 && !wanted.includes(name)) continue;
      const coefficients = join(work, `${name}.json`);
      const textures = ['--cosine', '--order', '10', '--outgoing', outgoing];
      run('project', spec, '-o', coefficients, ...(form ?? textures));
      const light = lights.flatMap((one) => ['--light', one]);
      const error = form ? [] : ['--no-error'];
      run('export', coefficients, '-o', work, '--target', 'viewer', ...error, ...light);
      await withBrowser(
        'llvmpipe',
        async (page, complaints) => {
          page.setDefaultTimeout(900000);
          await page.goto(`${pathToFileURL(join(work, `${name}_viewer.html`)).href}#${view}`);
          await page.waitForFunction(() => window.viewer?.settled);
          await page.screenshot({ path: join(folder, `${name}.png`) });
          console.log(name, await page.innerText('#numbers'));
          expect(complaints.length === 0, complaints.join('; '));
        },
        { viewport: { width, height: 860 }, dark },
      );
    }
  } finally {
    rmSync(work, { recursive: true, force: true });
  }
});
