// Babylon.js in Chromium: babylon.mjs DRIVER HSHFIT FOLDER [KIND…] draws the scene with the material of
// `export --target babylon` and with the glTF fit, and states their errors against `hshfit render`.
import { trial } from './chromium.mjs';

// In the page: float pixels from the bottom row on, as Base64.
async function draw({ name, kind, side, eye, angle, towards, irradiance, glb, picture, turn }) {
  const engine = new BABYLON.Engine(document.getElementById('c'), false, { preserveDrawingBuffer: true });
  const world = new BABYLON.Scene(engine);
  world.useRightHandedSystem = true;
  world.clearColor = new BABYLON.Color4(0, 0, 0, 0);
  const camera = new BABYLON.FreeCamera('eye', BABYLON.Vector3.FromArray(eye), world);
  camera.setTarget(BABYLON.Vector3.Zero());
  camera.fov = angle;
  camera.minZ = 0.1;
  if (kind === 'direct') {
    const lamp = new BABYLON.DirectionalLight('lamp', BABYLON.Vector3.FromArray(towards).scale(-1), world);
    lamp.intensity = irradiance;
  } else {
    const map = new BABYLON.HDRCubeTexture(picture, world, 256, false, true, false, true);
    // Column 0 of a picture is a quarter turn from where the program has it, and turns run the other way.
    map.rotationY = ((90 - turn) * Math.PI) / 180;
    world.environmentTexture = map;
    await new Promise((resolve) => (map.isReady() ? resolve() : map.onLoadObservable.addOnce(resolve)));
  }
  let mesh;
  if (glb) {
    await BABYLON.SceneLoader.AppendAsync('', glb, world);
    mesh = world.meshes.find((one) => one.getTotalVertices() > 0);
    world.activeCamera = camera;
  } else {
    mesh = BABYLON.MeshBuilder.CreateSphere('ball', { diameter: 2, segments: 128 }, world);
    const { material } = await import(`/files/${name}/${name}_babylon.js`);
    mesh.material = material(BABYLON, world);
  }
  world.imageProcessingConfiguration.applyByPostProcess = true;  // radiance as it is
  const target = new BABYLON.RenderTargetTexture('out', side, world, {
    type: BABYLON.Constants.TEXTURETYPE_FLOAT, format: BABYLON.Constants.TEXTUREFORMAT_RGBA, generateMipMaps: false,
  });
  target.renderList = [mesh];
  target.activeCamera = camera;
  target.clearColor = world.clearColor;
  world.customRenderTargets.push(target);
  // Until effects are compiled and the environment is filtered.
  for (let k = 0; k < 400; ++k) {
    world.render();
    if (k > 4 && world.isReady() && mesh.material.isReady(mesh) && target.isReadyForRendering()) break;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  world.render();
  const pixels = await target.readPixels();
  const bytes = new Uint8Array(pixels.buffer, pixels.byteOffset, pixels.byteLength);
  let text = '';
  for (let k = 0; k < bytes.length; k += 32768) text += String.fromCharCode(...bytes.subarray(k, k + 32768));
  engine.dispose();
  return btoa(text);
}

await trial({ title: 'Babylon.js', name: 'babylon', target: 'babylon', scripts: ['/npm/babylonjs/babylon.js', '/npm/babylonjs-loaders/babylonjs.loaders.js'], draw });
