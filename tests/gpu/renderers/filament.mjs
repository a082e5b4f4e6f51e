// Filament in Chromium: filament.mjs DRIVER HSHFIT FOLDER [KIND…] draws the scene with the material of
// `export --target filament` and with the glTF fit, lit by the engine's sun and by the cube of
// `export --lighting prefiltered --engine filament`, and states the errors against `hshfit render`. Debian's
// package libfilament-tools compiles our material, for Filament 1.9; the glTF fit is drawn by the newest.
import { existsSync } from 'node:fs';
import { trial } from './chromium.mjs';
import * as scene from './scene.mjs';

// E / pi as Filament's polynomial of nine factors, of coefficients of radiance.
function polynomial(radiance) {
  const share = [1, 2 / 3, 1 / 4],
    factor = [0.28209479, 0.48860251, 0.48860251, 0.48860251, 1.09254843, 1.09254843, 0.31539157, 1.09254843, 0.54627422];
  return radiance.flatMap((rgb, k) => rgb.map((x) => x * factor[k] * share[Math.floor(Math.sqrt(k))]));
}

// In the page, z up: float pixels from the bottom row on, as Base64. The canvas has 8 bits, so that
// pictures under light of eight strengths are put together.
async function draw({ kind, side, eye, angle, towards, irradiance, glb, compiled, ball, cube, levels, bands }) {
  Object.assign(window, window.glMatrix);
  await new Promise((resolve) => Filament.init([...(glb ? [glb] : [compiled, ball]), ...(cube ? [cube] : [])], resolve));
  const canvas = document.getElementById('c');
  canvas.width = canvas.height = side;
  const engine = Filament.Engine.create(canvas, { preserveDrawingBuffer: true, antialias: false, alpha: true });
  const world = engine.createScene();
  let dim; // all light to a share
  const lights = engine.getLightManager();
  const lamp = Filament.EntityManager.get().create();
  let texture;
  if (cube) {
    const bytes = Filament.assets[cube];
    texture = Filament.Texture.Builder().width(levels[0].face).height(levels[0].face).levels(levels.length)
      .sampler(Filament.Texture$Sampler.SAMPLER_CUBEMAP).format(Filament.Texture$InternalFormat.RGBA16F).build(engine);
    levels.forEach(({ offset, bytes: count }, k) => {
      const part = new Uint8Array(bytes.buffer, bytes.byteOffset + offset, count);
      texture.setImageCube(engine, k, Filament.PixelBuffer(part, Filament.PixelDataFormat.RGBA, Filament.PixelDataType.HALF));
    });
  }
  if (glb && kind === 'direct') {
    Filament.LightManager.Builder(Filament.LightManager$Type.DIRECTIONAL)
      .color([1, 1, 1]).intensity(irradiance).direction(towards.map((x) => -x)).castShadows(false).build(engine, lamp);
    world.addEntity(lamp);
    dim = (share) => lights.setIntensity(lights.getInstance(lamp), irradiance * share);
  } else if (glb) {
    const surroundings = Filament.IndirectLight.Builder().reflections(texture).irradianceSh(3, bands).intensity(1).build(engine);
    world.setIndirectLight(surroundings);
    dim = (share) => surroundings.setIntensity(share);
  }
  if (glb) {
    const loader = engine.createAssetLoader();
    const asset = loader.createAsset(Filament.assets[glb]);
    await new Promise((resolve) => asset.loadResources(resolve, () => {}, '/', 1));
    const transforms = engine.getTransformManager();
    const root = transforms.getInstance(asset.getRoot());
    // +y up to +z up.
    transforms.setTransform(root, [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1]);
    root.delete();
    world.addEntities(asset.getEntities());
  } else {
    const surface = engine.createMaterial(compiled).createInstance();
    const { MinFilter, MagFilter, WrapMode } = Filament;
    const filter = new Filament.TextureSampler(MinFilter.LINEAR_MIPMAP_LINEAR, MagFilter.LINEAR, WrapMode.CLAMP_TO_EDGE);
    if (!texture) {
      // Black, under the sun alone.
      texture = Filament.Texture.Builder().width(1).height(1).levels(1)
        .sampler(Filament.Texture$Sampler.SAMPLER_CUBEMAP).format(Filament.Texture$InternalFormat.RGBA8).build(engine);
      texture.setImageCube(engine, 0, Filament.PixelBuffer(new Uint8Array(24), Filament.PixelDataFormat.RGBA, Filament.PixelDataType.UBYTE));
    }
    surface.setTextureParameter('environment', texture, filter);
    surface.setFloat3Parameter('axis', [0, 0, 1]);
    surface.setFloat3Parameter('sunDirection', towards);
    const sun = kind === 'direct' ? irradiance : 0;
    surface.setFloat3Parameter('sunIrradiance', [sun, sun, sun]);
    dim = (share) => surface.setFloatParameter('exposure', share);
    world.addEntity(engine.loadFilamesh(ball, surface).renderable);
  }
  const camera = engine.createCamera(Filament.EntityManager.get().create());
  camera.setProjectionFov((angle * 180) / Math.PI, 1, 0.1, 50, Filament.Camera$Fov.VERTICAL);
  camera.lookAt(eye, [0, 0, 0], [0, 0, 1]);
  camera.setExposureDirect(1);
  const view = engine.createView();
  view.setCamera(camera);
  view.setScene(world);
  view.setViewport([0, 0, side, side]);
  view.setPostProcessingEnabled(false);
  const chain = engine.createSwapChain(),
    renderer = engine.createRenderer();
  renderer.setClearOptions({ clearColor: [0, 0, 0, 0], clear: true });
  const result = new Float32Array(4 * side * side);
  const gl = canvas.getContext('webgl2'),
    bytes = new Uint8Array(4 * side * side);
  for (const exposure of [0.002, 0.005, 0.0125, 0.03, 0.08, 0.2, 0.5, 1]) {
    dim(exposure);
    for (let k = 0; k < 3; ++k) {
      renderer.render(chain, view);
      engine.execute();
      await new Promise((resolve) => requestAnimationFrame(resolve));
    }
    renderer.render(chain, view);
    engine.execute();
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    for (let k = 0; k < bytes.length; k += 4) {
      const fits = Math.max(bytes[k], bytes[k + 1], bytes[k + 2]) < 255;
      for (let c = 0; c < 3; ++c)
        if (fits || result[k + c] === 0) result[k + c] = bytes[k + c] / 255 / exposure;
      result[k + 3] = bytes[k + 3] / 255;
    }
  }
  const all = new Uint8Array(result.buffer);
  let text = '';
  for (let k = 0; k < all.length; k += 32768) text += String.fromCharCode(...all.subarray(k, k + 32768));
  return btoa(text);
}

// The cube that the program filters for Filament, and the irradiance, of the picture as it is turned.
let surroundings;
function surroundingsOf({ hshfit, folder }) {
  if (surroundings) return surroundings;
  const light = `${scene.picture}:turn=${scene.turn}`;
  scene.run(hshfit, 'export', 'lambert', '-o', `${folder}/cube`, '--name', 'cube', '--lighting', 'prefiltered', '--engine', 'filament',
    '--light', light, '--target', 'bin', '--force');
  const { levels } = scene.readJson(`${folder}/cube/cube.lighting.json`).models[0].cube;
  const { radiance } = JSON.parse(scene.run(hshfit, 'irradiance', light, '--json'));
  return (surroundings = { levels, bands: polynomial(radiance), cube: '/files/cube/cube.prefiltered.cube.f16.bin' });
}

// Our material and the sphere as Filament's tools compile them.
function compiledOf({ folder, name }) {
  const [path, ball] = [`${folder}/${name}/${name}`, `${folder}/ball.filamesh`];
  scene.run('matc', '-p', 'mobile', '-o', `${path}.filamat`, `${path}.mat`);
  if (!existsSync(ball)) {
    scene.writeBall(`${folder}/ball.obj`);
    scene.run('filamesh', `${folder}/ball.obj`, ball);
  }
  return { compiled: `/files/${name}/${name}.filamat`, ball: '/files/ball.filamesh' };
}

const more = (kind, job) => ({
  eye: scene.eye, // z up
  towards: scene.towardsLight,
  ...(job.given === 'ours' ? compiledOf(job) : {}),
  ...(kind === 'direct' ? { cube: null } : surroundingsOf(job)),
});
const scripts = (given) => ['/npm/gl-matrix/gl-matrix.js', `/npm/${given === 'ours' ? 'filament-1.9' : 'filament'}/filament.js`];
await trial({ title: 'Filament', name: 'filament', target: 'filament', scripts, draw, more });
