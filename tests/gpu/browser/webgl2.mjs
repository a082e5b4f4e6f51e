// webgl2.mjs DRIVER FOLDER: the GLSL ES snippets in WebGL 2.
import { expect, finish, proveBreaksShow, proveCases, withBrowser } from './browser.mjs';

// In the page: a fragment shader into four float targets, one pixel a pair.
async function draw(job) {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('no EXT_color_buffer_float');
  gl.getExtension('OES_texture_float_linear');
  const norm16 = gl.getExtension('EXT_texture_norm16');
  const formats = {
    float16: [gl.RGBA16F, gl.HALF_FLOAT, Uint16Array],
    float32: [gl.RGBA32F, gl.FLOAT, Float32Array],
    unorm8: [gl.RGBA8, gl.UNSIGNED_BYTE, Uint8Array],
    unorm16: [norm16?.RGBA16_EXT, gl.UNSIGNED_SHORT, Uint16Array],
  };
  if (!formats[job.coefficients.number][0]) return { left: 'no EXT_texture_norm16 here' };
  const program = checks.useProgram(gl, job['glsl-es']);
  let unit = 0;
  const texture = (name, target, filter) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, gl.createTexture());
    gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, filter);
    gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
    gl.texParameteri(target, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.uniform1i(gl.getUniformLocation(program, name), unit++);
  };
  for (const name of ['coefficients', 'basis']) {
    if (!job[name]) continue;
    const { width, height, layers, number, bytes } = job[name];
    const [internal, type, Type] = formats[number];
    texture(`hsh_${name}`, gl.TEXTURE_2D_ARRAY, gl.LINEAR);
    gl.texImage3D(
      gl.TEXTURE_2D_ARRAY,
      0,
      internal,
      width,
      height,
      layers,
      0,
      gl.RGBA,
      type,
      new Type(checks.bytesOf(bytes).buffer),
    );
  }
  const inputs = new Float32Array(checks.bytesOf(job.inputs).buffer),
    side = job.side,
    pairs = side * side;
  const numbers = (name, width, height, values) => {
    texture(name, gl.TEXTURE_2D, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, values);
  };
  const vectors = (first) =>
    Float32Array.from({ length: 4 * pairs }, (_, i) =>
      i % 4 === 3 ? 0 : inputs[6 * (i >> 2) + first + (i % 4)],
    );
  numbers('wos', side, side, vectors(0));
  numbers('wis', side, side, vectors(3));
  // Texel (slot, colour).
  numbers(
    'lights',
    job.slots,
    job.lights,
    Float32Array.from(
      { length: 4 * job.slots * job.lights },
      (_, i) =>
        inputs[6 * pairs + ((i >> 2) % job.slots) * job.lights + Math.floor((i >> 2) / job.slots)],
    ),
  );
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  for (let i = 0; i < 4; ++i) {
    const target = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, target);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, side, side);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, target, 0);
  }
  gl.drawBuffers([0, 1, 2, 3].map((i) => gl.COLOR_ATTACHMENT0 + i));
  gl.viewport(0, 0, side, side);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const outputs = 2 * job.channels + job.lights,
    values = new Float32Array(outputs * pairs);
  for (let i = 0; 4 * i < outputs; ++i) {
    const part = new Float32Array(4 * pairs);
    gl.readBuffer(gl.COLOR_ATTACHMENT0 + i);
    gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, part);
    for (let k = 0; k < pairs; ++k) {
      for (let c = 0; c < 4 && 4 * i + c < outputs; ++c)
        values[k * outputs + 4 * i + c] = part[4 * k + c];
    }
  }
  if (gl.getError() !== gl.NO_ERROR) throw new Error('WebGL error');
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  gl.getExtension('WEBGL_lose_context').loseContext();
  const bytes = new Uint8Array(values.buffer);
  let text = '';
  for (let i = 0; i < bytes.length; i += 8192)
    text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  return { values: btoa(text), name };
}

const [driver, folder] = process.argv.slice(2);
await finish(() =>
  withBrowser(driver, async (page) => {
    let name = '';
    const run = async (on, job) => {
      const found = await on.evaluate(draw, job);
      name = found.name ?? name;
      return found;
    };
    await proveCases(folder, driver, page, run);
    await proveBreaksShow(folder, page, 'glsl-es', run);
    console.log(name);
    expect(name.toLowerCase().includes(driver), `ran on ${name}`);
  }),
);
