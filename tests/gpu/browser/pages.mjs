// pages.mjs DRIVER PROGRAM: the pages of fits, comparisons, reports, trade-offs and batches in a
// browser, narrow and wide: no figure, text or table is cut, and the swatches of a table have the
// colours of its figure, light and dark.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { expect, finish, withBrowser } from './browser.mjs';

const [driver, program] = process.argv.slice(2);
const long = 'ggx:alpha=.35,F0=.912345678/.61234567/.312345678';

// Elements that hide a part of what they hold. Large matrices lie in closed details and scroll.
const hidden = (page) =>
  page.$$eval('body, body *', (all) =>
    all
      .filter((one) => one.scrollWidth > one.clientWidth + 1 && !one.closest('details, svg') &&
        getComputedStyle(one).overflowX !== 'visible')
      .map((one) => `${one.tagName} ${one.className}: ${one.textContent.trim().slice(0, 60)}`));

// Texts of whole figures that an edge of a column cuts, where the columns are shown apart.
const cutTexts = (page) =>
  page.$$eval('figure', (figures) =>
    figures.flatMap((figure) => {
      const whole = figure.querySelector('svg.whole');
      if (!whole) return [];
      const edges = [...figure.querySelectorAll('svg.part')].map((part) => part.viewBox.baseVal.x);
      const frame = whole.getBoundingClientRect();
      const unit = whole.viewBox.baseVal.width / frame.width;
      return [...whole.querySelectorAll('text')].filter((text) => {
        const box = text.getBoundingClientRect();
        const left = (box.left - frame.left) * unit, right = (box.right - frame.left) * unit;
        return edges.some((edge) => left < edge - 1 && right > edge + 1);
      }).map((text) => `${text.textContent.trim()} in ${figure.className}`);
    }));

async function proveSwatches(page) {
  const found = await page.evaluate(() => {
    const svg = document.querySelector('figure.curves svg');
    const strokes = new Set([...svg.querySelectorAll('[color], [stroke]')].flatMap((one) =>
      [getComputedStyle(one).color, getComputedStyle(one).stroke]));
    return [...document.querySelectorAll('tbody th i')].map((one) => {
      const style = getComputedStyle(one);
      return { drawn: strokes.has(style.backgroundColor), filter: style.filter,
        figure: getComputedStyle(svg).filter };
    });
  });
  expect(found.length > 4, 'the report has no swatches');
  for (const one of found) {
    expect(one.drawn, 'a swatch has a colour that the figure has not');
    expect(one.filter === one.figure, `swatch ${one.filter}, figure ${one.figure}`);
  }
}

// The lightest pixel of a figure's left margin, where the labels of its axis are: 0 to 255.
async function lightestLabel(page, selector) {
  const figure = await page.$(selector);
  const png = (await figure.screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = new OffscreenCanvas(Math.floor(image.width / 10), image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const { data: all } = context.getImageData(0, 0, canvas.width, Math.min(canvas.height, 250));
    return all.filter((_, k) => k % 4 === 1).reduce((a, b) => Math.max(a, b), 0);
  }, png);
}

async function proveBatch(page) {
  const columns = () => page.$$eval('thead th', (all) => all.length);
  const few = await columns();
  await page.check('#every');
  expect((await columns()) > few, 'all columns are no more than the first ones');
  await page.uncheck('#every');
  expect((await columns()) === few, 'the first columns do not come back');
}

await finish(async () => {
  const folder = mkdtempSync(join(tmpdir(), 'hshfit-pages-'));
  const run = (...words) => execFileSync(program, [...words, '--quiet'], { cwd: folder });
  try {
    run('fit', long, '--model', 'lambert+beckmann', '--starts', '1', '-o', 'fit');
    run('compare', 'preset:bagher-sgd/gold-metallic-paint', 'ggx:alpha=.2', '-o', 'compared');
    run('report', 'phong:exponent=22', '--cosine', '-o', 'report');
    run('tradeoff', 'phong:exponent=22', '--forms', 'outgoing', '--outgoing', '8', '--orders',
      '3,5', '-o', 'trade');
    writeFileSync(join(folder, 'items.jsonl'),
      '{"command": "compare", "input": "ggx:alpha=0.3", "with": "beckmann:alpha=0.3"}\n' +
      '{"command": "project", "input": "lambert", "options": {"order": 3}}\n');
    run('batch', 'items.jsonl', '-o', 'batch');
    run('batch', 'items.jsonl', '-o', 'batch', '--merge');
    const pages = ['fit/comparison.html', 'compared/comparison.html', 'report/report.html',
      'trade/tradeoff.html', 'trade/timing.html', 'batch/index.html'];
    for (const width of [420, 700, 720, 1030, 1280])
      await withBrowser(driver, async (page) => {
        for (const file of pages) {
          await page.goto(pathToFileURL(join(folder, file)).href);
          const wide = await page.evaluate(() => document.documentElement.scrollWidth);
          expect(wide <= width, `${file} is ${wide} wide in ${width}`);
          const parts = file.startsWith('batch') ? [] : await hidden(page);
          expect(parts.length === 0, `${file} at ${width}: ${parts.join('; ')}`);
          const texts = width < 1280 ? [] : await cutTexts(page);
          expect(texts.length === 0, `${file}: columns cut ${texts.join('; ')}`);
          if (file.startsWith('batch')) await proveBatch(page);
          if (file.startsWith('compared') || file.startsWith('fit'))
            expect(!/\d\.\d{9}/.test(await page.innerText('body')), `${file} has long numbers`);
        }
      }, { viewport: { width, height: 900 } });
    // Text of figures is light where the page is dark, in columns that are shown apart too.
    const figures = [['compared/comparison.html', 'figure.map'], ['trade/tradeoff.html', 'figure'],
      ['compared/comparison.html', 'figure.curves'], ['report/report.html', 'figure'],
      ['fit/comparison.html', 'figure.curves'], ['fit/comparison.html', 'figure.narrow']];
    for (const width of [420, 1280])
      await withBrowser(driver, async (page) => {
        for (const [file, selector] of figures) {
          await page.goto(pathToFileURL(join(folder, file)).href);
          const green = await lightestLabel(page, selector);
          expect(green > 128, `${selector} of ${file} at ${width}: labels are no lighter than ${green}`);
        }
      }, { viewport: { width, height: 900 }, dark: true });
    for (const dark of [false, true])
      await withBrowser(driver, async (page) => {
        await page.goto(pathToFileURL(join(folder, 'report/report.html')).href);
        await proveSwatches(page);
      }, { dark });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
