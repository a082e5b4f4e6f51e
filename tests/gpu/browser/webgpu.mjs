// webgpu.mjs FOLDER: the WGSL snippets in WebGPU.
import { finish, expect, proveBreaksShow, proveCases, withBrowser } from './browser.mjs';

// In the page: a compute shader, one invocation a pair.
async function compute(job) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('no WebGPU adapter');
  const wanted = job.coefficients.number;
  const formats = {
    float16: ['rgba16float', 8],
    float32: ['rgba32float', 16],
    unorm8: ['rgba8unorm', 4],
    unorm16: ['rgba16unorm', 8],
  };
  if (wanted === 'unorm16') return { left: 'rgba16unorm is no core format' };
  const features = wanted === 'float32' ? ['float32-filterable'] : [];
  const device = await adapter.requestDevice({ requiredFeatures: features });
  device.pushErrorScope('validation');
  const module = device.createShaderModule({ code: job.wgsl });
  const messages = (await module.getCompilationInfo()).messages.filter(
    ({ type }) => type === 'error',
  );
  if (messages.length) throw new Error(messages.map(({ message }) => message).join('\n'));
  const pipeline = await device.createComputePipelineAsync({
    layout: 'auto',
    compute: { module, entryPoint: 'main' },
  });
  const textureOf = ({ width, height, layers, number, bytes }) => {
    const [format, size] = formats[number];
    const texture = device.createTexture({
      size: [width, height, layers],
      format,
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
    device.queue.writeTexture(
      { texture },
      checks.bytesOf(bytes),
      { bytesPerRow: width * size, rowsPerImage: height },
      [width, height, layers],
    );
    return texture.createView({ dimension: '2d-array' });
  };
  const bufferOf = (size, usage, data) => {
    const buffer = device.createBuffer({ size, usage });
    if (data) device.queue.writeBuffer(buffer, 0, data);
    return buffer;
  };
  const inputs = checks.bytesOf(job.inputs),
    pairs = job.side * job.side;
  const size = 4 * pairs * (2 * job.channels + job.lights);
  const storage = GPUBufferUsage.STORAGE;
  const results = bufferOf(size, storage | GPUBufferUsage.COPY_SRC);
  const entries = [
    { binding: 0, resource: textureOf(job.coefficients) },
    { binding: 1, resource: device.createSampler({ minFilter: 'linear', magFilter: 'linear' }) },
    {
      binding: 3,
      resource: { buffer: bufferOf(inputs.length, storage | GPUBufferUsage.COPY_DST, inputs) },
    },
    { binding: 4, resource: { buffer: results } },
  ];
  if (job.basis) entries.push({ binding: 2, resource: textureOf(job.basis) });
  const readable = bufferOf(size, GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST);
  const encoder = device.createCommandEncoder(),
    pass = encoder.beginComputePass();
  pass.setPipeline(pipeline);
  pass.setBindGroup(0, device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
  pass.dispatchWorkgroups(pairs / 64);
  pass.end();
  encoder.copyBufferToBuffer(results, 0, readable, 0, size);
  device.queue.submit([encoder.finish()]);
  const problem = await device.popErrorScope();
  if (problem) throw new Error(problem.message);
  await readable.mapAsync(GPUMapMode.READ);
  const bytes = new Uint8Array(readable.getMappedRange());
  let text = '';
  for (let i = 0; i < bytes.length; i += 8192)
    text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  const { vendor, architecture } = adapter.info;
  device.destroy();
  return { values: btoa(text), name: `${vendor} ${architecture}` };
}

const [folder] = process.argv.slice(2);
// WebGPU exists for secure origins only; localhost is one.
const files = (path) =>
  path === '/' ? { contentType: 'text/html', body: '<title>check</title>' } : null;
await finish(() =>
  withBrowser(
    'webgpu',
    async (page) => {
      await page.goto('http://localhost/');
      let name = '';
      const run = async (on, job) => {
        const found = await on.evaluate(compute, job);
        name = found.name ?? name;
        return found;
      };
      await proveCases(folder, 'swiftshader', page, run);
      await proveBreaksShow(folder, page, 'wgsl', run);
      console.log(name);
      expect(name.includes('swiftshader'), `ran on ${name}`);
    },
    { files },
  ),
);
