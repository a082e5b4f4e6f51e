// Blender without a window: blender.mjs HSHFIT FOLDER [ENGINE…] draws the scene with the glTF fit as
// its importer reads it (a Principled BSDF) in CYCLES, the default, or BLENDER_EEVEE, and states the
// errors against `hshfit render`.
import { writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { readExr, writeSheet } from './pictures.mjs';
import * as scene from './scene.mjs';

const [hshfit, folder, ...wanted] = process.argv.slice(2);
const size = 128;
const engines = wanted.length > 0 ? wanted : ['CYCLES'];
const rows = [];
for (const name of scene.names) {
  scene.exported(hshfit, folder, name, 'bin');
  const glb = resolve(scene.standard(hshfit, folder, name));
  for (const kind of ['direct', 'environment']) {
    const expected = await scene.references(hshfit, folder, name, kind, size);
    const row = [];
    for (const engine of engines) {
      const out = resolve(`${folder}/${name}-${kind}-${engine}.exr`),
        words = `${folder}/blender.json`;
      const text = JSON.stringify({
        engine, kind, glb, out, size, samples: kind === 'direct' ? 16 : 256, eye: scene.eye, angle: scene.view.angle,
        towards: scene.towardsLight, irradiance: scene.light.irradiance, picture: scene.picture,
        lookup_turn: -scene.turn,
      });
      writeFileSync(words, text);
      // EEVEE draws with OpenGL, which needs a display.
      const display = engine === 'CYCLES' ? [] : ['xvfb-run', '-a'];
      process.env.LIBGL_ALWAYS_SOFTWARE = '1';
      scene.run(...display, 'blender', '-b', '--factory-startup', '--python-exit-code', '1', '-P', `${scene.here}/blender.py`, '--', words);
      row.push(scene.judged(`Blender, ${engine}`, { name, kind, given: 'glTF' }, expected, await readExr(out)));
    }
    rows.push(row);
  }
}
writeSheet(`${folder}/blender.png`, rows);
