// sampling.mjs DRIVER FOLDER: sample() and pdf() of the snippets in WebGL 2, or in WebGPU for the
// driver webgpu: the same directions as the library, by the chi-square test of two samples, and
// densities that agree.
import { join } from 'node:path';
import { decoded, expect, finish, readJson, withBrowser } from './browser.mjs';

// In the page: a fragment shader into four float targets, one pixel a pair; all jobs of a case.
async function draw(job) {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('no EXT_color_buffer_float');
  gl.getExtension('OES_texture_float_linear');
  const program = checks.useProgram(gl, job['glsl-es']);
  const texture = (unit, name, target, filter) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, gl.createTexture());
    for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(target, key, filter);
    for (const key of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T])
      gl.texParameteri(target, key, gl.CLAMP_TO_EDGE);
    if (name) gl.uniform1i(gl.getUniformLocation(program, name), unit);
  };
  const { width, height, layers, bytes } = job.coefficients;
  if (job.textured) {
    texture(0, 'hsh_coefficients', gl.TEXTURE_2D_ARRAY, gl.LINEAR);
    const texels = new Float32Array(checks.bytesOf(bytes).buffer);
    gl.texImage3D(
      ...[gl.TEXTURE_2D_ARRAY, 0, gl.RGBA32F, width, height, layers, 0, gl.RGBA, gl.FLOAT, texels],
    );
  }
  const side = job.side,
    pairs = side * side;
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  for (let i = 0; i < 4; ++i) {
    texture(3, '', gl.TEXTURE_2D, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, side, side);
    const target = gl.getParameter(gl.TEXTURE_BINDING_2D);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, target, 0);
  }
  gl.drawBuffers([0, 1, 2, 3].map((i) => gl.COLOR_ATTACHMENT0 + i));
  gl.viewport(0, 0, side, side);
  texture(1, 'wos', gl.TEXTURE_2D, gl.NEAREST);
  texture(2, 'wis', gl.TEXTURE_2D, gl.NEAREST);
  const results = [];
  for (const text of job.inputs) {
    const inputs = new Float32Array(checks.bytesOf(text).buffer);
    for (const first of [0, 3]) {
      const vectors = Float32Array.from({ length: 4 * pairs }, (_, i) =>
        i % 4 === 3 ? 0 : inputs[6 * (i >> 2) + first + (i % 4)],
      );
      gl.activeTexture(gl.TEXTURE1 + (first ? 1 : 0));
      gl.texImage2D(
        ...[gl.TEXTURE_2D, 0, gl.RGBA32F, side, side, 0, gl.RGBA, gl.FLOAT, vectors],
      );
    }
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const values = new Float32Array(job.outputs * pairs);
    for (let i = 0; 4 * i < job.outputs; ++i) {
      const part = new Float32Array(4 * pairs);
      gl.readBuffer(gl.COLOR_ATTACHMENT0 + i);
      gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, part);
      for (let k = 0; k < pairs; ++k)
        for (let c = 0; c < 4 && 4 * i + c < job.outputs; ++c)
          values[k * job.outputs + 4 * i + c] = part[4 * k + c];
    }
    results.push(values);
  }
  if (gl.getError() !== gl.NO_ERROR) throw new Error('WebGL error');
  gl.getExtension('WEBGL_lose_context').loseContext();
  return results.map((values) => {
    const found = new Uint8Array(values.buffer);
    let text = '';
    for (let i = 0; i < found.length; i += 8192)
      text += String.fromCharCode(...found.subarray(i, i + 8192));
    return btoa(text);
  });
}

// In the page: a compute shader, one invocation a pair.
async function compute(job) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('no WebGPU adapter');
  const device = await adapter.requestDevice({ requiredFeatures: ['float32-filterable'] });
  device.pushErrorScope('validation');
  const module = device.createShaderModule({ code: job.wgsl });
  const messages = (await module.getCompilationInfo()).messages.filter((m) => m.type === 'error');
  if (messages.length) throw new Error(messages.map(({ message }) => message).join('\n'));
  const pipeline = await device.createComputePipelineAsync({
    layout: 'auto',
    compute: { module, entryPoint: 'main' },
  });
  const { width, height, layers, bytes } = job.coefficients;
  const texture = device.createTexture({
    size: [width, height, layers],
    format: 'rgba32float',
    usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
  });
  device.queue.writeTexture(
    { texture },
    checks.bytesOf(bytes),
    { bytesPerRow: 16 * width, rowsPerImage: height },
    [width, height, layers],
  );
  const results = [];
  for (const text of job.inputs) {
    const inputs = checks.bytesOf(text),
      pairs = job.side * job.side,
      size = 4 * pairs * job.outputs;
    const bufferOf = (bytesOfIt, usage) => device.createBuffer({ size: bytesOfIt, usage });
    const storage = GPUBufferUsage.STORAGE;
    const given = bufferOf(inputs.length, storage | GPUBufferUsage.COPY_DST);
    device.queue.writeBuffer(given, 0, inputs);
    const written = bufferOf(size, storage | GPUBufferUsage.COPY_SRC);
    const readable = bufferOf(size, GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST);
    const entries = [
      { binding: 3, resource: { buffer: given } },
      { binding: 4, resource: { buffer: written } },
    ];
    // The layout has only what the shader uses: forms in constants have no texture.
    if (job.textured)
      entries.push(
        { binding: 0, resource: texture.createView({ dimension: '2d-array' }) },
        {
          binding: 1,
          resource: device.createSampler({ minFilter: 'linear', magFilter: 'linear' }),
        },
      );
    const encoder = device.createCommandEncoder(),
      pass = encoder.beginComputePass();
    const layout = pipeline.getBindGroupLayout(0);
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, device.createBindGroup({ layout, entries }));
    pass.dispatchWorkgroups(pairs / 64);
    pass.end();
    encoder.copyBufferToBuffer(written, 0, readable, 0, size);
    device.queue.submit([encoder.finish()]);
    await readable.mapAsync(GPUMapMode.READ);
    const found = new Uint8Array(readable.getMappedRange());
    let out = '';
    for (let i = 0; i < found.length; i += 8192)
      out += String.fromCharCode(...found.subarray(i, i + 8192));
    results.push(btoa(out));
  }
  const problem = await device.popErrorScope();
  if (problem) throw new Error(problem.message);
  device.destroy();
  return results;
}

// Cells of a k-d tree with `least` to 2 `least` points of `placing`; gives a function from a point
// to its cell.
function cellsOf(placing, least) {
  let count = 0;
  const split = (points, axis) => {
    if (points.length < 2 * least) return { cell: count++ };
    const sorted = points.map((p) => p[axis]).sort((a, b) => a - b);
    const at = sorted[sorted.length >> 1];
    const next = (axis + 1) % 2;
    return {
      axis,
      at,
      low: split(
        points.filter((p) => p[axis] < at),
        next,
      ),
      high: split(
        points.filter((p) => p[axis] >= at),
        next,
      ),
    };
  };
  const root = split(placing, 0);
  const cellOf = (p) => {
    let node = root;
    while (node.cell === undefined) node = p[node.axis] < node.at ? node.low : node.high;
    return node.cell;
  };
  return { count, cellOf };
}

// The probability that two samples of one distribution differ as much, by Pearson's statistic and
// the normal approximation of Wilson and Hilferty.
export function twoSampleProbability(placing, a, b, least = 20) {
  const { count, cellOf } = cellsOf(placing, least);
  const counts = [new Float64Array(count), new Float64Array(count)];
  for (const p of a) ++counts[0][cellOf(p)];
  for (const p of b) ++counts[1][cellOf(p)];
  const ratio = Math.sqrt(b.length / a.length);
  let statistic = 0;
  for (let k = 0; k < count; ++k) {
    const both = counts[0][k] + counts[1][k];
    if (both > 0) statistic += (counts[0][k] * ratio - counts[1][k] / ratio) ** 2 / both;
  }
  const n = count - 1,
    z = (Math.cbrt(statistic / n) - (1 - 2 / (9 * n))) / Math.sqrt(2 / (9 * n));
  // Upper tail of the normal distribution: Abramowitz & Stegun 26.2.17.
  const t = 1 / (1 + 0.2316419 * Math.abs(z)),
    tail =
      (Math.exp((-z * z) / 2) / Math.sqrt(2 * Math.PI)) *
      t *
      (0.31938153 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  return z > 0 ? tail : 1 - tail;
}

function check(job, found) {
  const pairs = job.side * job.side;
  const worst = { wi: 0, pdf: 0, p: 1, mean: 0 };
  found.forEach((text, k) => {
    const values = decoded(text, Float32Array),
      expected = decoded(job.expected[k], Float64Array),
      drawn = [];
    if (k === 0) {
      // Densities of given pairs.
      for (let i = 0; i < pairs; ++i) {
        const d = values[i * job.outputs + 4],
          gap = d === expected[i] ? 0 : Math.abs(d / expected[i] - 1);
        worst.pdf = Math.max(worst.pdf, gap < 1e30 ? gap : 1e30);
      }
      return;
    }
    let sum = 0,
      squares = 0;
    for (let i = 0; i < pairs; ++i) {
      const v = values.subarray(i * job.outputs, i * job.outputs + 5),
        e = expected.subarray(4 * i, 4 * i + 4);
      // e[3]: whether single precision may choose another lobe here.
      for (let c = 0; c < 3 && e[3] === 0; ++c) {
        const gap = Math.abs(v[c] - e[c]);
        worst.wi = Math.max(worst.wi, gap < 1e30 ? gap : 1e30);
      }
      drawn.push([v[0], v[1]]);
      const ratio = v[2] / Math.PI / v[3];
      sum += ratio;
      squares += ratio * ratio;
    }
    if (k === 1) return;
    // One outgoing direction: two samples, and the integral of the cosine's density.
    const mean = sum / pairs,
      error = 1e-6 + Math.sqrt(Math.max(0, squares / pairs - mean * mean) / pairs);
    worst.mean = Math.max(worst.mean, Math.abs(mean - 1) / error);
    const reference = decoded(job.drawn[k - 2], Float64Array);
    const points = Array.from({ length: reference.length / 2 }, (_, i) => [
      reference[2 * i],
      reference[2 * i + 1],
    ]);
    const half = points.length >> 1;
    worst.p = Math.min(
      worst.p,
      twoSampleProbability(points.slice(0, half), points.slice(half), drawn),
    );
  });
  return worst;
}

const [driver, folder] = process.argv.slice(2);
const files = (path) =>
  path === '/' ? { contentType: 'text/html', body: '<title>check</title>' } : null;
await finish(() =>
  withBrowser(
    driver,
    async (page) => {
      await page.goto('http://localhost/');
      for (const file of readJson(join(folder, 'sampling.json'))) {
        const job = readJson(join(folder, file));
        const worst = check(job, await page.evaluate(driver === 'webgpu' ? compute : draw, job));
        console.log(
          `${job.name.padEnd(24)} wi ${worst.wi.toExponential(1)}  pdf ` +
            `${worst.pdf.toExponential(1)}  two samples p ${worst.p.toFixed(3)}  integral of a density ${worst.mean.toFixed(1)} standard errors`,
        );
        expect(worst.wi <= 1e-5, `${job.name}: directions differ by ${worst.wi}`);
        expect(worst.pdf <= 1e-5, `${job.name}: densities differ by ${worst.pdf}`);
        expect(worst.p > 1e-5, `${job.name}: other samples than the library's, p ${worst.p}`);
        expect(worst.mean <= 4, `${job.name}: ${worst.mean} standard errors from 1`);
      }
    },
    { files },
  ),
);
