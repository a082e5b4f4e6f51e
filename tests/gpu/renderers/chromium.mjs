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

// target: of `export`, null: the engine has no material of ours; scripts: of its packages; more: what
// `draw` is given besides the scene, by the kind of light.
export async function trial({ title, name: engine, target, scripts, draw, more = () => ({}) }) {
  const [driver, hshfit, folder, ...wanted] = process.argv.slice(2);
  const kinds = wanted.length > 0 ? wanted : ['direct', ...(existsSync(scene.picture) ? ['environment'] : [])];
  const rows = [];
  await finish(async () => {
    for (const name of scene.names) {
      scene.exported(hshfit, folder, name, target ?? 'bin');
      for (const kind of kinds) {
        const expected = await scene.references(hshfit, folder, name, kind, size);
        const row = [];
        for (const given of target ? scene.given : ['glTF']) {
          const words = { ...scene.forPage(kind), driver, name, side: samples * size, glb: given === 'glTF' ? `/files/${name}/${name}.glb` : null };
          // A fresh browser for each: engines keep their contexts.
          const text = await withBrowser(
            driver,
            async (page, complaints) => {
              await page.goto('http://localhost/');
              for (const url of scripts) await page.addScriptTag({ url });
              const pixels = await page.evaluate(draw, { ...words, ...more(kind, { hshfit, folder }) });
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
