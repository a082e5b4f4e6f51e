// standard_materials.mjs PROGRAM: exported .glb files pass Khronos' validator, and .mtlx files the
// MaterialX library with its own node definitions, which also generates a shader from each. Broken
// ones of either kind have to fail. Ends with 77 where the npm packages are missing.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import vm from 'node:vm';

const packages = join(dirname(fileURLToPath(import.meta.url)), 'node_modules');
const bin = join(packages, '@needle-tools/materialx/bin');
if (!existsSync(bin) || !existsSync(join(packages, 'gltf-validator'))) {
  console.log('skipped: the npm packages are not installed: npm ci --ignore-scripts in tests/gpu');
  process.exit(77);
}
const require = createRequire(join(packages, 'x.js'));
const validator = require('gltf-validator');

// The library's script, which is written for pages and bundlers, as a function in Node.
async function materialX() {
  const path = join(bin, 'JsMaterialXGenShader.js');
  const text = readFileSync(path, 'utf8').replace(/export default MaterialX;?/g, '');
  const make = vm.runInThisContext(`(function (require, __filename, __dirname) {
    const module = { exports: {} }, exports = module.exports; ${text}\nreturn MaterialX; })`);
  return make(require, path, bin)({
    locateFile: (name) => join(bin, name.endsWith('.data') ? `${name}.txt` : name),
  });
}

let failures = 0;
function expect(holds, message) {
  if (holds) return;
  console.log(`FAILED: ${message}`);
  ++failures;
}

const folder = mkdtempSync(join(tmpdir(), 'hshfit-materials-'));
const write = (name, spec, ...options) =>
  execFileSync(process.argv[2], ['export', spec, '-o', folder, '--name', name, ...options]);

const gltf = {
  plain: 'gltf-pbr:baseColorFactor=.9/.5/.1,metallicFactor=.3,roughnessFactor=.4',
  metal: 'gltf-pbr:roughnessFactor=0',
  full:
    'gltf-pbr:metallicFactor=0,roughnessFactor=.5,ior=1.8,specularFactor=.7,' +
    'specularColorFactor=1/.5/.2,sheenColorFactor=.5/.3/.8,sheenRoughnessFactor=.6,' +
    'clearcoatFactor=.8,clearcoatRoughnessFactor=.25,anisotropyStrength=.6,' +
    'anisotropyRotation=.8,iridescenceFactor=.7,iridescenceIor=1.6,iridescenceThickness=350',
};
const openpbr = {
  base: 'openpbr',
  layers:
    'openpbr:base_color=.9/.5/.1,base_metalness=.4,base_diffuse_roughness=.3,specular_weight=.5,' +
    'specular_color=.9/1/.8,specular_roughness_anisotropy=.3,geometry_tangent=.8,' +
    'specular_ior=1.7,coat_weight=.5,coat_color=.9/.5/.4,coat_roughness=.2,coat_ior=1.4,coat_darkening=.5,fuzz_weight=.3,' +
    'fuzz_color=.2/.4/.8,fuzz_roughness=.7,thin_film_weight=.4,thin_film_ior=1.8,' +
    'thin_film_thickness=.35',
};

try {
  const validate = async (bytes) => (await validator.validateBytes(bytes)).issues;
  for (const [name, spec] of Object.entries(gltf)) {
    write(name, spec, '--target', 'gltf');
    const bytes = new Uint8Array(readFileSync(join(folder, `${name}.glb`)));
    const issues = await validate(bytes);
    // The validator knows no use of tangents but normal textures.
    const others = issues.messages.filter(({ code }) => code !== 'UNUSED_MESH_TANGENT');
    expect(others.length === 0, `${name}.glb: ${JSON.stringify(others)}`);
    const broken = bytes.slice();
    broken[broken.length - 1] ^= 0x7f;
    broken[8] ^= 4;
    const worse = await validate(broken).catch(() => ({ numErrors: 1 }));
    expect(worse.numErrors > 0, `${name}.glb: a changed length goes unnoticed`);
  }
  const outOfRange = Buffer.from(readFileSync(join(folder, 'plain.glb')));
  outOfRange.write('1.4', outOfRange.indexOf('"roughnessFactor":') + '"roughnessFactor":'.length);
  expect((await validate(new Uint8Array(outOfRange))).numErrors > 0,
    'a roughness of 1.4 goes unnoticed');

  const library = await materialX();
  const generator = library.EsslShaderGenerator.create();
  const context = new library.GenContext(generator);
  const definitions = library.loadStandardLibraries(context);
  const check = async (text) => {
    const document = library.createDocument();
    document.setDataLibrary(definitions);
    await library.readFromXmlString(document, text, '');
    const answer = {};
    const valid = document.validate(answer);
    return { document, valid, message: answer.message };
  };
  for (const [name, spec] of Object.entries({ ...gltf, ...openpbr })) {
    write(`mx_${name}`, spec, '--target', 'materialx');
    const text = readFileSync(join(folder, `mx_${name}.mtlx`), 'utf8');
    const { document, valid, message } = await check(text);
    expect(valid, `${name}.mtlx: ${message}`);
    const [material] = document.getMaterialNodes();
    expect(material !== undefined, `${name}.mtlx: no material`);
    const shader = material.getInput('surfaceshader').getConnectedNode();
    expect(Boolean(shader.getNodeDef()), `${name}.mtlx: no definition of ${shader.getCategory()}`);
    const source = generator.generate('material', material, context).getSourceCode('pixel');
    expect(source.length > 1000, `${name}.mtlx: no shader`);
    const wrong = await check(text.replace(/name="base_color"/, 'name="base_colour"'));
    expect(!wrong.valid, `${name}.mtlx: an unknown input goes unnoticed`);
  }
  console.log(`MaterialX ${library.getVersionString()}, glTF validator ${validator.version()}: ` +
    `${Object.keys(gltf).length} .glb and ${Object.keys({ ...gltf, ...openpbr }).length} .mtlx files`);
} finally {
  rmSync(folder, { recursive: true, force: true });
}
process.exit(failures ? 1 : 0);
