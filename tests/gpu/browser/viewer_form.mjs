// viewer_form.mjs DRIVER PROGRAM: the viewer of forms exported as they are, opened from disk: the source,
// the form by its own shader, order-7 textures; numbers as constants, as a texture, without a source.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { expect, finish, withBrowser } from './browser.mjs';

const [driver, program] = [process.argv[2], resolve(process.argv[3])];
const folder = mkdtempSync(join(tmpdir(), 'hshfit-forms-'));
const run = (...words) => execFileSync(program, [...words, '--quiet'], { cwd: folder });
const halfway = ['--form', 'halfway', '--halfway', '8,4,3', '--precision', 'half'];
const cases = [
  { name: 'halfway', spec: 'ggx:alpha=.3,F0=.9/.6/.3', project: halfway, least: 0.2 },
  {
    name: 'texture',
    spec: 'ggx:alpha=.3,F0=.9/.6/.3',
    project: [...halfway.slice(0, 4), '--precision', 'unorm16'],
    export: ['--storage', 'texture', '--allow-loss'],
    least: 0.3,
  },
  { name: 'basis', spec: 'phong:exponent=4,kd=.3', project: ['--form', 'basis', '--order', '7'], least: 1.1 },
  // The form itself in place of the source, which does not open any more.
  { name: 'alone', spec: 'alone.binary', project: halfway, alone: true },
];

async function open(page, name, state) {
  await page.goto('about:blank');
  await page.goto(`${pathToFileURL(join(folder, name, `${name}_viewer.html`)).href}#${state}`);
  await page.waitForFunction(() => window.viewer?.settled);
  return page.evaluate(() => ({
    numbers: window.viewer.numbers,
    pairs: window.viewer.pairs.map(([a, b]) => `${a.name} − ${b.name}`),
    images: window.viewer.renderer.images.map(({ name }) => name),
    lighting: window.viewer.state.lighting,
    labels: [...document.querySelectorAll('.label')].map((label) => label.innerText),
    absent: [...document.querySelectorAll('.absent')].map((box) => box.textContent).filter(Boolean),
    means: window.viewer.renderer.images.map((image) => {
      const pixels = window.viewer.renderer.read(image);
      let sum = 0,
        count = 0;
      for (let k = 0; k < pixels.length; k += 4) {
        if (!(pixels[k + 3] > 0)) continue;
        sum += pixels[k] + pixels[k + 1] + pixels[k + 2];
        ++count;
      }
      return sum / count / 3;
    }),
  }));
}

await finish(async () => {
  try {
    for (const { name, spec, project, alone, export: more = [] } of cases) {
      if (alone) run('convert', 'ggx:alpha=.4,F0=.9/.6/.3', spec);
      run('project', spec, '-o', `${name}.json`, ...project);
      if (alone) rmSync(join(folder, spec));
      run('export', `${name}.json`, '-o', name, '--target', 'viewer', ...more);
    }
    await withBrowser(
      driver,
      async (page, complaints) => {
        for (const { name, least, alone } of cases) {
          for (const light of ['point', 'sky', 'both']) {
            const { numbers, pairs, images, labels, absent, means } = await open(
              page,
              name,
              `frames=1&cycles=4&lighting=${light}`,
            );
            expect(images.length === (alone ? 2 : 3), `${name}: pictures ${images}`);
            expect(means.every((mean) => mean > 1e-2), `${name}, ${light}: black: ${means}`);
            expect(labels.filter((text) => /\d bytes/.test(text)).length === 2, `${name}: ${labels}`);
            if (alone) {
              expect(/does not open/.test(absent.join()), `${name}: '${absent}'`);
              expect(/of the form/.test(labels.join()), `${name}: ${labels}`);
              continue;
            }
            console.log(
              `${name}, ${light}: ${pairs.map((pair, i) => `${pair} ${(100 * numbers[i].relative).toFixed(2)} %`).join(', ')}`,
            );
            // Point light compares shaders alone; the environment two means over directions.
            expect(numbers[0].relative < Math.max(least * numbers[1].relative, 0.03),
              `${name}, ${light}: the form is no nearer than the textures`);
          }
        }
        const { lighting } = await open(page, 'halfway', 'frames=1&cycles=1');
        expect(lighting === 'both', 'the page opens with one light');
        expect(complaints.length === 0, `console: ${complaints.join('; ')}`);
      },
      { viewport: { width: 620, height: 500 } },
    );
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
