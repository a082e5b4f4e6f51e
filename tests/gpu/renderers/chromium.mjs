// A trial of an engine in Chromium: SCRIPT DRIVER HSHFIT FOLDER [KIND…]. `draw` runs in the page and
// returns float pixels from the bottom row on, as Base64; the errors are stated against `hshfit render`, and
// FOLDER/ENGINE.png has the pictures: right, drawn, four times their difference, for each material that the
// engine is given.
import { existsSync } from 'node:fs';
import { decoded, finish, withBrowser } from '../browser/browser.mjs';
import { reduced, writeSheet } from './pictures.mjs';
import * as scene from './scene.mjs';

const size = 128,
  samples = 3;

// target: of `export`; scripts: of its packages, by what is drawn; more: what `draw` is given besides the
// scene, by the kind of light and what is drawn.
export async function trial({ title, name: engine, target, scripts, draw, more = () => ({}) }) {
  const [driver, hshfit, folder, ...wanted] = process.argv.slice(2);
  const kinds = wanted.length > 0 ? wanted : ['direct', ...(existsSync(scene.picture) ? ['environment'] : [])];
  const rows = [];
  await finish(async () => {
    for (const name of scene.names) {
      scene.exported(hshfit, folder, name, target);
      for (const kind of kinds) {
        const expected = await scene.references(hshfit, folder, name, kind, size);
        const row = [];
        for (const given of scene.given) {
          const words = { ...scene.forPage(kind), driver, name, side: samples * size, glb: given === 'glTF' ? `/files/${name}/${name}.glb` : null };
          // A fresh browser for each: engines keep their contexts.
          const text = await withBrowser(
            driver,
            async (page, complaints) => {
              await page.goto('http://localhost/');
              for (const url of typeof scripts === 'function' ? scripts(given) : scripts) await page.addScriptTag({ url });
              const pixels = await page.evaluate(draw, { ...words, ...more(kind, { hshfit, folder, name, given }) });
              for (const line of new Set(complaints)) if (!/GPU stall/.test(line)) console.log(`console: ${line}`);
              return pixels;
            },
            { files: scene.server(folder) },
          );
          const found = reduced({ size: samples * size, pixels: decoded(text, Float32Array) }, samples);
          row.push(scene.judged(title, { name, kind, given }, expected, found));
        }
        rows.push(row);
      }
    }
    writeSheet(`${folder}/${engine}.png`, rows);
  });
}
