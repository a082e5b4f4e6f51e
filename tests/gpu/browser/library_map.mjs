// library_map.mjs DRIVER PROGRAM: the page of `hshfit library map` in a browser: places, filters,
// the facts of a material and near duplicates, wide and narrow, light and dark.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { expect, finish, withBrowser } from './browser.mjs';

const [driver, program] = process.argv.slice(2);
const specs = ['lambert:kd=.7/.1/.1', 'lambert:kd=.1/.6/.1', 'lambert:kd=.1/.1/.7',
  'lambert:kd=.05', 'lambert:kd=.8', 'ggx:alpha=.4,F0=.9/.7/.3', 'ggx:alpha=.2,F0=.9/.6/.3',
  'ggx:alpha=.202,F0=.9/.6/.3'];
const run = (...words) =>
  execFileSync(program, ['library', ...words, '--force', '--quiet'], { encoding: 'utf8' });

const namesShown = (page) =>
  page.$$eval('.material:not(.out)', (all) => all.map((one) => one.title).sort());

async function set(page, selector, value) {
  await page.$eval(selector, (input, to) => {
    input.value = to;
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
}

async function reset(page) {
  await page.click('button[type=reset]');
  await page.waitForFunction(() => document.querySelectorAll('.material.out').length === 0);
}

// No thumbnail covers another, and nothing is wider than the page.
async function proveLayout(page, width) {
  const boxes = await page.$$eval('.material', (all) =>
    all.map((one) => [one.offsetLeft, one.offsetTop, one.offsetWidth]));
  boxes.forEach(([x, y, size], k) => {
    for (const [x2, y2] of boxes.slice(0, k))
      expect(Math.hypot(x - x2, y - y2) > size, `thumbnails overlap at width ${width}`);
    expect(size >= 24, `thumbnails of ${size} pixels at width ${width}`);
  });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  expect(wide <= width, `the page is ${wide} wide in ${width}`);
}

async function proveFilters(page, answer) {
  const where = (holds) => answer.materials.filter(holds).map((one) => one.name).sort();
  const same = async (expected, text) =>
    expect(JSON.stringify(await namesShown(page)) === JSON.stringify(expected), text);
  await set(page, '#name', 'GGX');
  await same(where((one) => one.name.startsWith('ggx')), 'filter by name');
  await reset(page);
  const sorted = answer.materials.map((one) => one.gloss).sort((a, b) => a - b);
  await set(page, '[aria-label="Gloss, least"]', 5);
  await same(where((one) => one.gloss >= sorted[5]), 'filter by gloss');
  await reset(page);
  await set(page, '[aria-label="Albedo, most"]', 0);
  await same(['lambert_kd=.05'], 'filter by albedo');
  await reset(page);
  await set(page, '#hue', 136);
  await set(page, '#hueWidth', 30);
  await same(['lambert_kd=.1_.6_.1'], 'filter by hue');
  await reset(page);
  await page.check('#onlyTwins');
  await same(answer.duplicates.flatMap((pair) => [pair.first, pair.second]).sort(),
    'filter by near duplicates');
  await reset(page);
}

async function proveFacts(page, answer, file) {
  const gold = answer.materials.find((one) => one.name.startsWith('ggx_alpha=.4'));
  await page.click(`.material[title="${gold.name}"]`);
  const text = await page.textContent('#facts');
  for (const part of [gold.name, gold.source, `${gold.bytes} bytes`, gold.nearest[0].name,
    gold.nearest[4].distance.toFixed(3)])
    expect(text.includes(part), `no ${part} in the facts`);
  await page.click('#facts .link');
  expect((await page.textContent('#facts h2')) === gold.nearest[0].name, 'no way to a neighbour');
  const pressed = await page.$$eval('[aria-pressed=true]', (all) => all.map((one) => one.title));
  await page.goto('about:blank');
  await page.goto(`${pathToFileURL(file).href}#${encodeURIComponent(gold.name)}`);
  expect((await page.textContent('#facts h2')) === gold.name, 'the address names no material');
  expect(pressed.length === 1 && pressed[0] === gold.nearest[0].name, 'not marked as chosen');
}

async function prove(page, complaints, file, answer, width) {
  await page.goto(pathToFileURL(file).href);
  expect((await namesShown(page)).length === specs.length, 'not all materials are shown');
  const loaded = await page.$$eval('.material img', (all) =>
    all.every((one) => one.naturalWidth === 72));
  expect(loaded, 'a thumbnail is no picture');
  await proveLayout(page, width);
  await proveFilters(page, answer);
  await proveFacts(page, answer, file);
  expect(answer.duplicates.length === 1, `${answer.duplicates.length} near duplicates`);
  expect((await page.$$('#twinList li')).length === 1, 'the list of near duplicates');
  expect((await page.$$('.material.twin')).length === 2, 'the marks of near duplicates');
  expect(complaints.length === 0, `console: ${complaints.join('; ')}`);
}

await finish(async () => {
  const folder = mkdtempSync(join(tmpdir(), 'hshfit-map-'));
  const library = join(folder, 'a.library'), file = join(folder, 'a.html');
  try {
    run('learn', ...specs, '--components', '5', '--limit', '10', '--limit-maximum', '10',
      '--limit-flip', '1', '-o', library);
    const answer = JSON.parse(run('map', library, '--json', '-o', file));
    for (const [width, dark] of [[1280, false], [420, true]])
      await withBrowser(driver, (page, complaints) =>
        prove(page, complaints, file, answer, width),
      { viewport: { width, height: 900 }, dark });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
