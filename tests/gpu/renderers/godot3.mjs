// Godot 3 under a virtual display: godot3.mjs HSHFIT FOLDER draws the scene with the shader of
// `export --target godot3` and, as a SpatialMaterial, with the base of the glTF fit, and states their
// errors against `hshfit render`.
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { reduced, writeSheet } from './pictures.mjs';
import * as scene from './scene.mjs';

const [hshfit, folder] = process.argv.slice(2);
const size = 128,
  samples = 3;
mkdirSync(`${folder}/godot3`, { recursive: true });
writeFileSync(`${folder}/godot3/project.godot`, 'config_version=4\n[rendering]\nquality/driver/driver_name="GLES3"\n');

// Base colour, metalness and roughness of a .glb; colours are given as they are shown.
function base(path) {
  const bytes = readFileSync(path);
  const { materials } = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString());
  const { baseColorFactor = [1, 1, 1], metallicFactor = 1, roughnessFactor = 1 } = materials[0].pbrMetallicRoughness;
  const shown = (x) => (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
  return { albedo: baseColorFactor.slice(0, 3).map(shown), metallic: metallicFactor, roughness: roughnessFactor };
}

function draw(words) {
  const file = resolve(`${folder}/godot3/scene.json`),
    out = resolve(`${folder}/godot3/out.raw`);
  writeFileSync(file, JSON.stringify({ ...words, out, side: samples * size }));
  process.env.HSHFIT_SCENE = file;
  process.env.LIBGL_ALWAYS_SOFTWARE = '1';
  const said = scene.run('xvfb-run', '-a', '-s', '-screen 0 640x480x24', 'godot3', '--video-driver', 'GLES3', '--audio-driver', 'Dummy',
    '--path', `${folder}/godot3`, '-s', `${scene.here}/godot3.gd`);
  if (/ERROR/i.test(said)) console.log(said);
  const bytes = readFileSync(out);
  const pixels = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  // Rows from the top down.
  const side = samples * size,
    turned = new Float32Array(pixels.length);
  for (let y = 0; y < side; ++y) turned.set(pixels.subarray(4 * y * side, 4 * (y + 1) * side), 4 * (side - 1 - y) * side);
  return reduced({ size: side, pixels: turned }, samples);
}

const rows = [];
for (const name of scene.names) {
  const shader = resolve(`${scene.exported(hshfit, folder, name, 'godot3')}/${name}_godot3.shader`);
  const standard = base(scene.standard(hshfit, folder, name));
  for (const kind of ['direct', 'environment']) {
    const expected = await scene.references(hshfit, folder, name, kind, size);
    const words = { ...scene.forPage(kind), angle: scene.view.angle, picture: scene.picture, sky_turn: 90 + scene.turn, energy: scene.light.irradiance / Math.PI };
    const row = [];
    if (kind === 'direct') row.push(scene.judged('Godot 3', { name, kind, given: 'ours' }, expected, draw({ ...words, shader })));
    row.push(scene.judged('Godot 3', { name, kind, given: 'glTF' }, expected, draw({ ...words, ...standard })));
    rows.push(row);
  }
}
writeSheet(`${folder}/godot3.png`, rows);
