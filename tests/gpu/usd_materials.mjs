// usd_materials.mjs PROGRAM: TinyUSDZ and three.js read exported .usda files; the inputs of
// UsdPreviewSurface and the mesh are those that were given. A layer cut off, a renamed input and a
// material that is bound to nothing have to be found. Ends with 77 where the npm packages are missing.
import { execFileSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const packages = join(dirname(fileURLToPath(import.meta.url)), 'node_modules');
if (!existsSync(join(packages, 'tinyusdz')) || !existsSync(join(packages, 'three'))) {
  console.log('skipped: the npm packages are not installed: npm ci --ignore-scripts in tests/gpu');
  process.exit(77);
}
const { USDLoader } = await import('three/addons/loaders/USDLoader.js');

// TinyUSDZ is compiled for pages: it refuses Node unless that looks like a page.
process.type = 'renderer';
globalThis.window = globalThis;
// Node 18 takes a file as a module by the end of its name alone.
const scratch = mkdtempSync(join(tmpdir(), 'tinyusdz-'));
copyFileSync(join(packages, 'tinyusdz/tinyusdz.js'), join(scratch, 'tinyusdz.mjs'));
const { default: makeTiny } = await import(join(scratch, 'tinyusdz.mjs'));
rmSync(scratch, { recursive: true });
const wasm = readFileSync(join(packages, 'tinyusdz/tinyusdz.wasm'));
const tiny = await makeTiny({
  print() {},
  printErr() {},
  instantiateWasm(imports, done) {
    WebAssembly.instantiate(wasm, imports).then(({ instance, module }) => done(instance, module));
    return {};
  },
});

let failures = 0;
function expect(holds, message) {
  if (holds) return;
  console.log(`FAILED: ${message}`);
  ++failures;
}
const near = (a, b) => Math.abs(a - b) < 1e-6;

/// What TinyUSDZ finds; its name of one input lacks a letter.
function byTiny(text) {
  const loader = new tiny.TinyUSDZLoaderNative();
  if (!loader.loadFromBinary(new TextEncoder().encode(text), 'layer.usda')) return undefined;
  if (loader.numMeshes() !== 1) return undefined;
  const material = loader.getMaterial(loader.getMesh(0).materialId);
  return material && { ...material, clearcoat: material.cleacoat };
}

function byThree(text) {
  let mesh;
  new USDLoader().parse(text).traverse((each) => {
    if (each.isMesh) mesh = each;
  });
  const { color, metalness, roughness, ior, clearcoat, clearcoatRoughness } = mesh.material;
  const base = { diffuseColor: color.toArray(), metallic: metalness, roughness, ior };
  return { mesh, found: { ...base, clearcoat, clearcoatRoughness } };
}

const inputs = ['metallic', 'roughness', 'ior', 'clearcoat', 'clearcoatRoughness'];
const same = (found, given) =>
  given.diffuseColor.every((value, c) => near(found.diffuseColor?.[c], value)) &&
  inputs.every((name) => near(found[name], given[name]));

const folder = mkdtempSync(join(tmpdir(), 'hshfit-usd-'));
const plain = { metallic: 0, roughness: 0.4, ior: 1.5, clearcoat: 0, clearcoatRoughness: 0 };
const cases = {
  dielectric: { ...plain, diffuseColor: [0.9, 0.5, 0.1], ior: 1.8 },
  metal: { ...plain, diffuseColor: [0.95, 0.6, 0.3], metallic: 1, roughness: 0.25 },
  'coat 1': { ...plain, diffuseColor: [0.1, 0.2, 0.3], clearcoat: 0.75, clearcoatRoughness: 0.125 },
};
try {
  for (const [name, given] of Object.entries(cases)) {
    const spec =
      `gltf-pbr:baseColorFactor=${given.diffuseColor.join('/')},metallicFactor=${given.metallic},` +
      `roughnessFactor=${given.roughness},ior=${given.ior},clearcoatFactor=${given.clearcoat},` +
      `clearcoatRoughnessFactor=${given.clearcoatRoughness}`;
    execFileSync(process.argv[2], ['export', spec, '-o', folder, '--name', name, '--target', 'usd']);
    const text = readFileSync(join(folder, `${name}.usda`), 'utf8');
    const found = byTiny(text);
    expect(found && same(found, given), `${name}: TinyUSDZ reads ${JSON.stringify(found)}`);
    expect(found && !found.useSpecularWorkflow, `${name}: the specular workflow`);
    const three = byThree(text);
    expect(same(three.found, given), `${name}: three.js reads ${JSON.stringify(three.found)}`);
    // A closed unit sphere: every triangle's corners are at their normals.
    const { position, normal } = three.mesh.geometry.attributes;
    let worst = 0;
    for (let k = 0; k < position.count; ++k) {
      for (const part of ['getX', 'getY', 'getZ'])
        worst = Math.max(worst, Math.abs(position[part](k) - normal[part](k)));
    }
    expect(position.count > 1000 && worst < 1e-6, `${name}: normals are off by ${worst}`);
    const renamed = byTiny(text.replace('inputs:roughness', 'inputs:rough'));
    expect(!renamed || !same(renamed, given), `${name}: a renamed input goes unnoticed`);
    expect(!byTiny(text.slice(0, text.length - 40)), `${name}: a cut goes unnoticed`);
    const unbound = byTiny(text.replace('/Material>\n', '/Other>\n'));
    expect(!unbound || !same(unbound, given), `${name}: a lost binding goes unnoticed`);
    // UsdMtlx's place of a surfacematerial is </MaterialX/Materials/NAME>.
    const [, file, material] = /references = @\.\/(.+)@<\/MaterialX\/Materials\/(\w+)>/.exec(text);
    const document = readFileSync(join(folder, file), 'utf8');
    expect(document.includes(`<surfacematerial name="${material}"`),
      `${name}: ${material} is not in ${file}`);
  }
  console.log(`${Object.keys(cases).length} .usda files by TinyUSDZ and three.js`);
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures ? 1 : 0);
