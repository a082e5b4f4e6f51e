// three.js in Chromium: three.mjs DRIVER HSHFIT FOLDER [KIND…] draws the scene with the material of
// `export --target three` and with the glTF fit, and states their errors against `hshfit render`; kind
// `bumps`: a sphere with a normal map in the environment. DRIVER webgpu: the node material.
import { trial } from './chromium.mjs';
import * as scene from './scene.mjs';

// In the page: float pixels from the bottom row on, as Base64.
async function draw({ driver, name, kind, side, eye, angle, reach, towards, irradiance, glb, picture, turn, bumps }) {
  const gpu = driver === 'webgpu';
  const three = await import(gpu ? 'three/webgpu' : 'three');
  const { HDRLoader } = await import('three/addons/loaders/HDRLoader.js');
  const renderer = gpu ? new three.WebGPURenderer() : new three.WebGLRenderer();
  if (gpu) await renderer.init();
  const world = new three.Scene();
  if (kind === 'direct') {
    const lamp = new three.DirectionalLight(0xffffff, irradiance);
    lamp.position.set(...towards);
    world.add(lamp);
  } else {
    world.environment = await new HDRLoader().setDataType(three.FloatType).loadAsync(picture);
    world.environment.mapping = three.EquirectangularReflectionMapping;
    world.environmentRotation.y = (turn * Math.PI) / 180;
  }
  let surface, mesh;
  if (glb) {
    const { GLTFLoader } = await import('three/addons/loaders/GLTFLoader.js');
    const { scene: read } = await new GLTFLoader().loadAsync(glb);
    read.traverse((one) => (mesh = one.isMesh ? one : mesh));
    surface = mesh.material;
  } else {
    const { material } = await import(`/files/${name}/${name}_three${gpu ? '_webgpu' : ''}.js`);
    surface = material({ tangents: bumps !== null });
  }
  if (bumps) {
    const bytes = Uint8Array.from(atob(bumps.texels), (c) => c.charCodeAt(0));
    surface.normalMap = new three.DataTexture(bytes, bumps.width, bumps.height);
    surface.normalMap.magFilter = surface.normalMap.minFilter = three.LinearFilter;
    surface.normalMap.wrapS = three.RepeatWrapping;
    surface.normalMap.needsUpdate = true;
    surface.normalScale.set(1, 1);
  }
  if (!glb || bumps) mesh = new three.Mesh(new three.SphereGeometry(1, 256, 128), surface);
  if (bumps) {
    // Along u. Without tangents three.js takes slopes in the proportions of u and v.
    const { uv } = mesh.geometry.attributes;
    const tangents = new Float32Array(4 * uv.count);
    for (let k = 0; k < uv.count; ++k) {
      const phi = 2 * Math.PI * uv.getX(k);
      tangents.set([Math.sin(phi), 0, Math.cos(phi), 1], 4 * k);
    }
    mesh.geometry.setAttribute('tangent', new three.BufferAttribute(tangents, 4));
  }
  world.add(mesh);
  const camera = kind === 'bumps' ? new three.OrthographicCamera(-reach, reach, reach, -reach, 0.1, 50)
    : new three.PerspectiveCamera((angle * 180) / Math.PI, 1, 0.1, 50);
  camera.position.set(...eye);
  camera.lookAt(0, 0, 0);
  const target = new three.RenderTarget(side, side, { type: three.FloatType });
  const seen = gpu ? target : new three.WebGLRenderTarget(side, side, { type: three.FloatType });
  renderer.setClearColor(0, 0);
  renderer.setRenderTarget(seen);
  renderer.render(world, camera);
  renderer.render(world, camera);
  let pixels = new Float32Array(4 * side * side);
  if (gpu) pixels = await renderer.readRenderTargetPixelsAsync(seen, 0, 0, side, side);
  else renderer.readRenderTargetPixels(seen, 0, 0, side, side, pixels);
  if (gpu) {
    // Rows of textures are read from above, each of as many bytes as 256 divides.
    const row = pixels.length / side,
      upright = new Float32Array(4 * side * side);
    for (let y = 0; y < side; ++y) upright.set(pixels.subarray(y * row, y * row + 4 * side), 4 * side * (side - 1 - y));
    pixels = upright;
  }
  const bytes = new Uint8Array(pixels.buffer, pixels.byteOffset, 16 * side * side);
  let text = '';
  for (let k = 0; k < bytes.length; k += 32768) text += String.fromCharCode(...bytes.subarray(k, k + 32768));
  return btoa(text);
}

const more = (kind) => ({ reach: scene.reach, bumps: kind === 'bumps' ? scene.bumpTexels() : null });
await trial({ title: 'three.js', name: 'three', target: 'three', scripts: [], draw, more });
