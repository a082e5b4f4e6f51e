// Functions that lighting.mjs runs within a page; each stands alone.

// Draws normals and viewers with one model into a float target; the time is that of further draws.
export async function drawWebGl2(job) {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('no EXT_color_buffer_float');
  const areas = job.light.length / 15;
  const surface = job.tangents ? 'n, t' : 'n';
  const shading = {
    coefficients: `uniform vec3 light[${job.light.length / 3}];
      vec3 shade(vec3 n, vec3 t, vec3 wo) { return hsh_coefficients(${surface}, wo, light); }`,
    'split-sum': `uniform vec3 light[9];
      vec3 shade(vec3 n, vec3 t, vec3 wo) { return hsh_splitSum(${surface}, wo, light); }`,
    prefiltered: `vec3 shade(vec3 n, vec3 t, vec3 wo) { return hsh_prefiltered(${surface}, wo); }`,
    ltc: `uniform vec3 light[${5 * areas}];
      vec3 shade(vec3 n, vec3 t, vec3 wo) {
        vec3 sum = vec3(0.0);
        for (int k = 0; k < ${5 * areas}; k += 5)
          sum += light[k + 4] * hsh_ltc(${surface}, wo, light[k], light[k + 1], light[k + 2], light[k + 3]);
        return sum;
      }`,
  }[job.model];
  const fragment = `#version 300 es
    ${job.source}
    uniform sampler2D normals, viewers${job.tangents ? ', tangents' : ''};
    ${shading}
    out vec4 colour;
    void main() {
      ivec2 at = ivec2(gl_FragCoord.xy);
      vec4 n = texelFetch(normals, at, 0);
      vec3 t = ${job.tangents ? 'texelFetch(tangents, at, 0).xyz' : 'vec3(0.0)'};
      colour = vec4(n.w > 0.0 ? shade(n.xyz, t, texelFetch(viewers, at, 0).xyz) : vec3(0.0), n.w);
    }`;
  const program = checks.useProgram(gl, fragment);
  let unit = 0;
  const bind = (name, target, least, most) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, gl.createTexture());
    gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, least);
    gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, most);
    gl.texParameteri(target, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.uniform1i(gl.getUniformLocation(program, name), unit++);
  };
  const numbers = (name, width, height, text) => {
    bind(name, gl.TEXTURE_2D, gl.NEAREST, gl.NEAREST);
    const values = new Float32Array(checks.bytesOf(text).buffer);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, values);
  };
  const name = job.model === 'split-sum' ? 'splitSum' : job.model;
  numbers(`hsh_${name}_table`, job.table.width, job.table.height, job.table.bytes);
  numbers('normals', job.width, job.height, job.normals);
  numbers('viewers', job.width, job.height, job.viewers);
  if (job.tangents) numbers('tangents', job.width, job.height, job.tangents);
  if (job.cube) {
    bind(`hsh_${name}_cube`, gl.TEXTURE_CUBE_MAP, gl.LINEAR_MIPMAP_LINEAR, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MAX_LEVEL, job.cube.levels.length - 1);
    const texels = new Uint16Array(checks.bytesOf(job.cube.bytes).buffer);
    job.cube.levels.forEach(({ face, offset }, level) => {
      for (let k = 0; k < 6; ++k) {
        const first = offset / 2 + k * face * face * 4;
        gl.texImage2D(
          gl.TEXTURE_CUBE_MAP_POSITIVE_X + k,
          level,
          gl.RGBA16F,
          face,
          face,
          0,
          gl.RGBA,
          gl.HALF_FLOAT,
          texels.subarray(first, first + face * face * 4),
        );
      }
    });
  }
  if (job.light.length) gl.uniform3fv(gl.getUniformLocation(program, 'light'), job.light);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  const target = gl.createTexture();
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, target);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, job.width, job.height);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.viewport(0, 0, job.width, job.height);
  const values = new Float32Array(4 * job.width * job.height);
  const frame = () => {
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, job.width, job.height, gl.RGBA, gl.FLOAT, values);
  };
  frame();
  const covered = values.filter((_, i) => i % 4 === 3 && values[i] > 0).length;
  const start = performance.now();
  for (let k = 0; k < 4; ++k) frame();
  const nanoseconds = ((performance.now() - start) / 4 / covered) * 1e6;
  if (gl.getError() !== gl.NO_ERROR) throw new Error('WebGL error');
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const renderer = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension('WEBGL_lose_context').loseContext();
  const bytes = new Uint8Array(values.buffer);
  let text = '';
  for (let i = 0; i < bytes.length; i += 8192)
    text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  return { values: btoa(text), name: renderer, nanoseconds };
}

// The same in a fragment shader of WebGPU. (In compute shaders, SwiftShader filters cube maps without
// the neighbouring faces.)
export async function drawWebGpu(job) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('no WebGPU adapter');
  const device = await adapter.requestDevice();
  device.pushErrorScope('validation');
  const count = Math.max(1, job.light.length / 3);
  const surface = job.tangents ? 'n, t' : 'n';
  const shading = {
    coefficients: `return hsh_coefficients(${surface}, wo, all);`,
    'split-sum': `return hsh_splitSum(${surface}, wo, all);`,
    prefiltered: `return hsh_prefiltered(${surface}, wo);`,
    ltc: `var sum = vec3<f32>(0.0);
      for (var k = 0; k < ${count}; k += 5) {
        sum += all[k + 4] * hsh_ltc(${surface}, wo, all[k], all[k + 1], all[k + 2], all[k + 3]);
      }
      return sum;`,
  }[job.model];
  const code = `${job.source}
    @group(0) @binding(3) var<storage, read> light: array<vec4<f32>>;
    @group(0) @binding(4) var<storage, read> normals: array<vec4<f32>>;
    @group(0) @binding(5) var<storage, read> viewers: array<vec4<f32>>;
    ${job.tangents ? '@group(0) @binding(6) var<storage, read> tangents: array<vec4<f32>>;' : ''}
    fn shade(n: vec3<f32>, t: vec3<f32>, wo: vec3<f32>) -> vec3<f32> {
      var all: array<vec3<f32>, ${count}>;
      for (var i = 0; i < ${count}; i++) { all[i] = light[i].xyz; }
      ${shading}
    }
    @vertex fn corner(@builtin(vertex_index) k: u32) -> @builtin(position) vec4<f32> {
      return vec4<f32>(select(-1.0, 3.0, k == 1), select(-1.0, 3.0, k == 2), 0.0, 1.0);
    }
    @fragment fn pixel(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
      let k = u32(at.y) * ${job.width} + u32(at.x);
      let n = normals[k];
      var colour = vec3<f32>(0.0);
      let t = ${job.tangents ? 'tangents[k].xyz' : 'vec3<f32>(0.0)'};
      if (n.w > 0.0) { colour = shade(n.xyz, t, viewers[k].xyz); }
      return vec4<f32>(colour, n.w);
    }`;
  const module = device.createShaderModule({ code });
  const errors = (await module.getCompilationInfo()).messages.filter(({ type }) => type === 'error');
  if (errors.length) throw new Error(errors.map(({ message }) => message).join('\n'));
  const pipeline = await device.createRenderPipelineAsync({
    layout: 'auto',
    vertex: { module, entryPoint: 'corner' },
    fragment: { module, entryPoint: 'pixel', targets: [{ format: 'rgba32float' }] },
  });
  const textureOf = (format, width, layers, levels) =>
    device.createTexture({
      size: [width, layers === 6 ? width : job.table.height, layers],
      format,
      mipLevelCount: levels,
      usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
  const table = textureOf('rgba32float', job.table.width, 1, 1);
  device.queue.writeTexture(
    { texture: table },
    checks.bytesOf(job.table.bytes),
    { bytesPerRow: job.table.width * 16 },
    [job.table.width, job.table.height],
  );
  const storage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST | GPUBufferUsage.COPY_SRC;
  const bufferOf = (data) => {
    const buffer = device.createBuffer({ size: data.byteLength, usage: storage });
    device.queue.writeBuffer(buffer, 0, data);
    return { buffer };
  };
  const light = new Float32Array(4 * count);
  job.light.forEach((value, i) => (light[4 * Math.floor(i / 3) + (i % 3)] = value));
  const pixels = job.width * job.height;
  const target = device.createTexture({
    size: [job.width, job.height],
    format: 'rgba32float',
    usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
  });
  const entries = [
    { binding: 0, resource: table.createView() },
    { binding: 3, resource: bufferOf(light) },
    { binding: 4, resource: bufferOf(checks.bytesOf(job.normals)) },
    { binding: 5, resource: bufferOf(checks.bytesOf(job.viewers)) },
  ];
  if (job.tangents)
    entries.push({ binding: 6, resource: bufferOf(checks.bytesOf(job.tangents)) });
  if (job.cube) {
    const { levels } = job.cube;
    const cube = textureOf('rgba16float', levels[0].face, 6, levels.length);
    const texels = checks.bytesOf(job.cube.bytes);
    levels.forEach(({ face, offset, bytes }, mipLevel) =>
      device.queue.writeTexture(
        { texture: cube, mipLevel },
        texels.subarray(offset, offset + bytes),
        { bytesPerRow: face * 8, rowsPerImage: face },
        [face, face, 6],
      ),
    );
    const linear = { minFilter: 'linear', magFilter: 'linear', mipmapFilter: 'linear' };
    entries.push({ binding: 1, resource: cube.createView({ dimension: 'cube' }) });
    entries.push({ binding: 2, resource: device.createSampler(linear) });
  }
  const group = device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries });
  const rowBytes = Math.ceil((16 * job.width) / 256) * 256;
  const readable = device.createBuffer({
    size: rowBytes * job.height,
    usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST,
  });
  const frame = async () => {
    const encoder = device.createCommandEncoder(),
      pass = encoder.beginRenderPass({
        colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }],
      });
    pass.setPipeline(pipeline);
    pass.setBindGroup(0, group);
    pass.draw(3);
    pass.end();
    encoder.copyTextureToBuffer({ texture: target }, { buffer: readable, bytesPerRow: rowBytes }, [
      job.width,
      job.height,
    ]);
    device.queue.submit([encoder.finish()]);
    await device.queue.onSubmittedWorkDone();
  };
  await frame();
  const start = performance.now();
  for (let k = 0; k < 4; ++k) await frame();
  const seconds = (performance.now() - start) / 4;
  const problem = await device.popErrorScope();
  if (problem) throw new Error(problem.message);
  await readable.mapAsync(GPUMapMode.READ);
  const bytes = new Uint8Array(16 * pixels),
    mapped = readable.getMappedRange();
  for (let y = 0; y < job.height; ++y)
    bytes.set(
      new Uint8Array(mapped, y * rowBytes, 16 * job.width).slice(),
      16 * y * job.width,
    );
  const values = new Float32Array(bytes.buffer);
  const covered = values.filter((_, i) => i % 4 === 3 && values[i] > 0).length;
  let text = '';
  for (let i = 0; i < bytes.length; i += 8192)
    text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  const { vendor, architecture } = adapter.info;
  device.destroy();
  return {
    values: btoa(text),
    name: `${vendor} ${architecture}`,
    nanoseconds: (seconds / covered) * 1e6,
  };
}

// Pictures in rows, each with its difference from the first, four times as bright, below it.
export function sheet(rows) {
  const floatsOf = (text) =>
    new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const size = rows[0].size,
    gap = 18;
  const columns = rows[0].pictures.length;
  const canvas = document.createElement('canvas');
  canvas.width = columns * size;
  canvas.height = rows.length * 2 * (size + gap);
  const context = canvas.getContext('2d');
  context.fillStyle = 'white';
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.fillStyle = 'black';
  context.font = '12px sans-serif';
  const srgb = (v) => 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055);
  rows.forEach(({ mask, pictures }, r) => {
    const normals = floatsOf(mask),
      truth = floatsOf(pictures[0].values);
    const bright = [...truth].sort((a, b) => a - b)[Math.floor(truth.length * 0.985)];
    pictures.forEach(({ title, values, channels }, column) => {
      const numbers = floatsOf(values);
      for (const difference of [false, true]) {
        const top = (2 * r + (difference ? 1 : 0)) * (size + gap);
        if (difference && column === 0) continue;
        const image = context.createImageData(size, size);
        for (let k = 0; k < size * size; ++k) {
          if (normals[4 * k + 3] === 0) continue;
          for (let c = 0; c < 3; ++c) {
            const value = numbers[channels * k + c];
            const shown = difference ? 4 * Math.abs(value - truth[3 * k + c]) : value;
            image.data[4 * k + c] = srgb(Math.min(1, Math.max(0, (0.8 * shown) / bright)));
          }
          image.data[4 * k + 3] = 255;
        }
        context.putImageData(image, column * size, top + gap);
        context.fillText(difference ? '4 x difference' : title, column * size + 4, top + 13);
      }
    });
  });
  return canvas.toDataURL('image/png');
}
