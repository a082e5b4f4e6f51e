// three_package.mjs PROGRAM: exports of the target three as npm packages: TypeScript accepts their types
// and refuses wrong uses, and Node imports them by name. Ends with 77 where npm packages are missing.
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const modules = join(dirname(fileURLToPath(import.meta.url)), 'node_modules');
if (!['three', 'typescript', '@types/three'].every((name) => existsSync(join(modules, name)))) {
  console.log('skipped: the npm packages are not installed: npm ci --ignore-scripts in tests/gpu');
  process.exit(77);
}
const program = resolve(process.argv[2]);
const folder = mkdtempSync(join(tmpdir(), 'hshfit-package-'));
const run = (...words) => execFileSync(program, [...words, '--quiet'], { cwd: folder });
let failures = 0;
function expect(condition, text) {
  if (condition) return;
  ++failures;
  console.log(`FAILED: ${text}`);
}

const good = `
import { DataTexture, LightProbe, Mesh, SphereGeometry, Vector3 } from 'three';
import { environmentFromProbe, facts, HshfitMaterial, material, studio } from 'hshfit-ward';
import { material as nodeMaterial } from 'hshfit-ward/webgpu';
import { material as form } from 'hshfit-ggx';
import { material as ofLibrary, materialNumber, materials } from 'hshfit-atlas';
import { HshfitNodeMaterial as Atlas } from 'hshfit-atlas/webgpu';
const one: HshfitMaterial = material({ tangents: true, axis: new Vector3(0, 0, 1), side: 2 });
one.setEnvironment(studio).setEnvironment(environmentFromProbe(new LightProbe()));
new Mesh(new SphereGeometry(), nodeMaterial({ axis: [0, 1, 0], environment: null, normalMap: new DataTexture() }));
const tinted = material({ color: 'red', aoMap: new DataTexture(), aoMapIntensity: 0.5 });
tinted.normalScale.set(1, tinted.color.r);
form().setEnvironment(null).setEnvironmentMap(new DataTexture());
const bytes: number = facts.bytes;
const two = ofLibrary({ materialIndex: materials[1], side: 2 });
two.materialIndex = 'lambert';
const index: number = two.materialIndex + new Atlas({ indices: true }).materialIndex + materialNumber('ggx');
console.log(index);
console.log(bytes);
`;
const bad = [
  ["import { material } from 'hshfit-ward'; material({ tangents: 'yes' });", 'a wrong type'],
  ["import { material } from 'hshfit-ward'; material().setSurroundings(null);", 'no such function'],
  ["import { material } from 'hshfit-ward'; material({ normalMap: 'file.png' });", 'no texture'],
  ["import { material } from 'hshfit-atlas'; material({ axis: [0, 1, 0] });", 'an option of other materials'],
  ["import { material } from 'hshfit-atlas'; material().materialIndex = null;", 'no material'],
  ["import { nothing } from 'hshfit-ward/webgpu'; console.log(nothing);", 'no such export'],
];

// Errors in each file by the compiler, which reads all in one call: the types of three take most of its time.
function compiled(texts) {
  const names = texts.map((text, k) => `use${k}.ts`);
  texts.forEach((text, k) => writeFileSync(join(folder, names[k]), text));
  const { stdout } = spawnSync(process.execPath, [join(modules, 'typescript/bin/tsc'), '--noEmit',
    '--strict', '--target', 'es2022', '--module', 'nodenext', '--moduleResolution', 'nodenext',
    '--lib', 'es2022,dom', ...names], { cwd: folder, encoding: 'utf8' });
  const lines = stdout.split('\n').filter((line) => line !== '');
  const said = names.map((name) => lines.filter((line) => line.startsWith(`${name}(`)).join('\n'));
  const others = lines.filter((line) => !/^use\d+\.ts\(|^ /.test(line));
  expect(others.length === 0, `types: ${others.join('\n')}`);
  return said;
}

try {
  mkdirSync(join(folder, 'node_modules'));
  for (const name of ['three', '@types', '@dimforge', '@tweenjs', 'fflate', 'meshoptimizer'])
    if (existsSync(join(modules, name))) symlinkSync(join(modules, name), join(folder, 'node_modules', name));
  writeFileSync(join(folder, 'package.json'), '{"type": "module"}');
  run('project', 'ward:ax=.3,ay=.6,kd=.1/.2/.3', '-o', 'ward.json', '--order', '4', '--outgoing', '8x8');
  run('project', 'ggx:alpha=.4', '-o', 'ggx.json', '--form', 'halfway', '--halfway', '4,2,2', '--precision', 'half');
  for (const name of ['ward', 'ggx'])
    run('export', `${name}.json`, '-o', `node_modules/hshfit-${name}`, '--target', 'three', '--no-error');

  run('library', 'learn', 'lambert', 'ggx:alpha=.4', '--components', '2', '--limit', '10', '--limit-maximum', '10',
    '--limit-flip', '1', '-o', 'atlas.library');
  run('library', 'export', 'atlas.library', '-o', 'node_modules/hshfit-atlas', '--target', 'three');

  const [accepted, ...refused] = compiled([good, ...bad.map(([text]) => text)]);
  expect(accepted === '', `types: ${accepted}`);
  bad.forEach(([, name], k) => {
    expect(refused[k] !== '', `${name} goes unnoticed`);
    console.log(`${name}: ${refused[k].split('\n')[0]}`);
  });

  writeFileSync(join(folder, 'use.mjs'), `
    import { Euler, Mesh, LightProbe, ShaderMaterial } from 'three';
    import { environmentFromFile, environmentFromProbe, facts, material, studio } from 'hshfit-ward';
    import { material as ofLibrary, materials } from 'hshfit-atlas';
    import { material as form } from 'hshfit-ggx';
    // The lookups under environments of so many levels: fitted to six, or to seven.
    const drawn = form();
    const tables = [6, 7, 8, 6].map((levels) => {
      const environment = { isPMREMTexture: true, mipmaps: new Array(levels) };
      drawn.onBeforeRender(null, { environment, environmentRotation: new Euler(), environmentIntensity: 1 });
      return drawn.uniforms.hsh_prefiltered_table.value;
    });
    const [six, seven] = tables.map((table) => table.image.data);
    const chosen = [tables[2] === tables[1], tables[3] === tables[0], six.length === seven.length,
      six.some((x, k) => x !== seven[k])];
    const two = ofLibrary({ materialIndex: materials[1] });
    const refused = [2, -1, 0.5, 'lambert ', null, NaN].filter((number) => {
      try {
        two.materialIndex = number;
        return false;
      } catch (error) {
        return error instanceof RangeError && error.message.startsWith('atlas has no material ');
      }
    });
    const made = material();
    const probe = new LightProbe(undefined, 2);
    probe.sh.coefficients[2].set(1, 2, 3);
    const light = environmentFromProbe(probe);
    // A light of the program: +z up there becomes +y up.
    const up = environmentFromFile({ format: 'hshfit-light', domain: 'sphere',
      basis: { name: 'sh', order: 2, condon_shortley: false }, coefficients: [[1, 0, 5, 0]] });
    console.log(JSON.stringify([made instanceof ShaderMaterial, new Mesh(undefined, made).material === made,
      made.clone().isHshfitMaterial, facts.name, studio.length, [...light.slice(6, 9)],
      [...up.slice(0, 12)].map((x) => Math.round(x * 1e9) / 1e9),
      two.materialIndex, two.clone().materialIndex, refused.length, ...chosen]));`);
  const said = JSON.parse(execFileSync(process.execPath, ['use.mjs'], { cwd: folder, encoding: 'utf8' }));
  const wanted = [true, true, true, 'ward:kd=0.1/0.2/0.3,ax=0.3,ay=0.6', 75, [2, 4, 6],
    [1, 1, 1, 5, 5, 5, 0, 0, 0, 0, 0, 0], 1, 1, 6, true, true, true, true];
  expect(JSON.stringify(said) === JSON.stringify(wanted), `in Node: ${JSON.stringify(said)}`);
  console.log('imported in Node:', JSON.stringify(said));
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures > 0 ? 1 : 0);
