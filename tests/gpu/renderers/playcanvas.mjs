// PlayCanvas in Chromium: playcanvas.mjs DRIVER HSHFIT FOLDER [KIND…] draws the scene with the material
// of `export --target playcanvas` and with the glTF fit, and states their errors against `hshfit render`.
import { trial } from './chromium.mjs';

// In the page: float pixels from the bottom row on, as Base64.
async function draw({ name, kind, side, eye, angle, towards, irradiance, glb, picture, turn }) {
  const pc = await import('/npm/playcanvas/build/playcanvas.mjs');
  const canvas = document.getElementById('c');
  canvas.width = canvas.height = side;
  const device = await pc.createGraphicsDevice(canvas, { deviceTypes: ['webgl2'], antialias: false });
  const options = new pc.AppOptions();
  options.graphicsDevice = device;
  options.componentSystems = [pc.RenderComponentSystem, pc.CameraComponentSystem, pc.LightComponentSystem];
  options.resourceHandlers = [pc.TextureHandler, pc.ContainerHandler];
  const app = new pc.AppBase(canvas);
  app.init(options);
  app.start();
  app.autoRender = false;
  const load = (type, url) =>
    new Promise((resolve, reject) => {
      const asset = new pc.Asset(url, type, { url });
      asset.once('load', () => resolve(asset));
      asset.once('error', (error) => reject(new Error(error)));
      app.assets.add(asset);
      app.assets.load(asset);
    });
  app.scene.ambientLight = new pc.Color(0, 0, 0);
  if (kind === 'direct') {
    const lamp = new pc.Entity('lamp');
    // Intensity 1 is the irradiance pi.
    lamp.addComponent('light', { type: 'directional', intensity: irradiance / Math.PI, castShadows: false });
    // Light shines along the entity's -y.
    const rotation = new pc.Quat().setFromDirections(new pc.Vec3(0, 1, 0), new pc.Vec3(...towards));
    lamp.setRotation(rotation);
    app.root.addChild(lamp);
  } else {
    const { resource } = await load('texture', picture);
    resource.projection = pc.TEXTUREPROJECTION_EQUIRECT;
    const source = pc.EnvLighting.generateLightingSource(resource, { size: 256 });
    app.scene.envAtlas = pc.EnvLighting.generateAtlas(source);
    // Column 0 of a picture is a quarter turn from where the program has it, and turns run the other way.
    app.scene.skyboxRotation = new pc.Quat().setFromAxisAngle(new pc.Vec3(0, 1, 0), 270 - turn);
    app.scene.layers.getLayerById(pc.LAYERID_SKYBOX).enabled = false;
  }
  let ball;
  if (glb) {
    const { resource } = await load('container', glb);
    ball = resource.instantiateRenderEntity();
  } else {
    ball = new pc.Entity('ball');
    const mesh = pc.Mesh.fromGeometry(device, new pc.SphereGeometry({ radius: 1, latitudeBands: 256, longitudeBands: 256 }));
    const { material } = await import(`/files/${name}/${name}_playcanvas.js`);
    ball.addComponent('render', { meshInstances: [new pc.MeshInstance(mesh, material(pc, device))], castShadows: false });
  }
  app.root.addChild(ball);
  const colorBuffer = new pc.Texture(device, {
    width: side, height: side, format: pc.PIXELFORMAT_RGBA32F, mipmaps: false, minFilter: pc.FILTER_NEAREST, magFilter: pc.FILTER_NEAREST,
  });
  const renderTarget = new pc.RenderTarget({ colorBuffer, depth: true, samples: 1 });
  const camera = new pc.Entity('eye');
  camera.addComponent('camera', {
    fov: (angle * 180) / Math.PI, nearClip: 0.1, farClip: 50, clearColor: new pc.Color(0, 0, 0, 0), renderTarget,
    toneMapping: pc.TONEMAP_NONE, gammaCorrection: pc.GAMMA_NONE,
  });
  camera.setPosition(...eye);
  camera.lookAt(0, 0, 0);
  app.root.addChild(camera);
  for (let k = 0; k < 5; ++k) {
    app.renderNextFrame = true;
    app.tick ? app.tick(performance.now()) : app.render();
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  const pixels = await colorBuffer.read(0, 0, side, side, { renderTarget });
  const bytes = new Uint8Array(pixels.buffer, pixels.byteOffset, pixels.byteLength);
  let text = '';
  for (let k = 0; k < bytes.length; k += 32768) text += String.fromCharCode(...bytes.subarray(k, k + 32768));
  app.destroy();
  return btoa(text);
}

await trial({ title: 'PlayCanvas', name: 'playcanvas', target: 'playcanvas', scripts: [], draw });
