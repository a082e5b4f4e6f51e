// The map as WebGL 2 textures, and its two programs.
function bytesOf(text) {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

class MapRenderer {
  constructor(canvas, data) {
    const gl = canvas.getContext('webgl2', { antialias: false, preserveDrawingBuffer: true });
    if (!gl) throw new Error('This browser has no WebGL 2.');
    this.gl = gl;
    this.data = data;
    this.floats = gl.getExtension('EXT_color_buffer_float') !== null;
    if (data.number === 'float32' && data.form !== 'clusters'
      && !gl.getExtension('OES_texture_float_linear'))
      throw new Error('This browser does not blend texels of float32; the map has to be float16.');
    const layers = Math.max(data.layers, data.harmonics?.layers ?? 0);
    if (layers > gl.getParameter(gl.MAX_ARRAY_TEXTURE_LAYERS))
      throw new Error(`The map has ${layers} layers, more than this browser takes.`);
    this.map = this.levelsTexture(0, data);
    this.harmonics = data.harmonics ? this.levelsTexture(4, data.harmonics) : null;
    this.shared = data.shared ? this.sharedTexture() : null;
    this.view = this.program(data.shaders.fragment);
  }

  newTexture(unit, target, min, mag, wrap) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(target, texture);
    gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, min);
    gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, mag);
    gl.texParameteri(target, gl.TEXTURE_WRAP_S, wrap);
    gl.texParameteri(target, gl.TEXTURE_WRAP_T, wrap);
    return texture;
  }

  // The levels of the map, or of its harmonics.
  levelsTexture(unit, { levels, layers }) {
    const { gl, data } = this;
    const clusters = data.form === 'clusters', array = gl.TEXTURE_2D_ARRAY;
    const wrap = data.wrap === 'repeat' ? gl.REPEAT : gl.CLAMP_TO_EDGE;
    const texture = this.newTexture(unit, array,
      clusters ? gl.NEAREST_MIPMAP_NEAREST : gl.LINEAR_MIPMAP_LINEAR,
      clusters ? gl.NEAREST : gl.LINEAR, wrap);
    const [format, type, Numbers] = {
      float16: [gl.RGBA16F, gl.HALF_FLOAT, Uint16Array],
      float32: [gl.RGBA32F, gl.FLOAT, Float32Array],
      unorm8: [gl.RGBA8, gl.UNSIGNED_BYTE, Uint8Array],
    }[data.number];
    const [first] = levels;
    gl.texStorage3D(array, levels.length, format, first.width, first.height, layers);
    levels.forEach((level, k) => {
      gl.texSubImage3D(array, k, 0, 0, 0, level.width, level.height, layers, gl.RGBA, type,
        new Numbers(bytesOf(level.bytes).buffer));
    });
    gl.texParameteri(array, gl.TEXTURE_MAX_LEVEL, levels.length - 1);
    return texture;
  }

  sharedTexture() {
    const { gl } = this;
    const { width, height, bytes } = this.data.shared;
    const texture = this.newTexture(1, gl.TEXTURE_2D_ARRAY, gl.NEAREST, gl.NEAREST, gl.CLAMP_TO_EDGE);
    gl.texImage3D(gl.TEXTURE_2D_ARRAY, 0, gl.RGBA32F, width, height, 1, 0, gl.RGBA, gl.FLOAT,
      new Float32Array(bytesOf(bytes).buffer));
    return texture;
  }

  program(fragment) {
    const { gl, data } = this;
    const program = gl.createProgram();
    const defines = `#define ENVIRONMENT ${data.lights.length ? data.order * data.order : 0}\n`
      + (data.cosine ? '#define COSINE_INCLUDED\n' : '');
    const add = (type, text) => {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, `#version 300 es\n${text}`);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    };
    add(gl.VERTEX_SHADER, data.shaders.vertex);
    add(gl.FRAGMENT_SHADER, `${defines}${data.shaders.snippet}\n${fragment}`);
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
      throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  // Sets uniforms by their names: numbers, arrays, and {whole} for integers.
  use(program, uniforms) {
    const { gl } = this;
    gl.useProgram(program);
    gl.uniform1i(gl.getUniformLocation(program, 'hsh_map'), 0);
    gl.uniform1i(gl.getUniformLocation(program, 'hsh_shared'), 1);
    gl.uniform1i(gl.getUniformLocation(program, 'hsh_harmonics'), 4);
    for (const [name, value] of Object.entries(uniforms)) {
      const at = gl.getUniformLocation(program, name);
      if (value.whole !== undefined) gl.uniform1i(at, value.whole);
      else if (typeof value === 'number') gl.uniform1f(at, value);
      else if (value.length === 2) gl.uniform2fv(at, value);
      else gl.uniform3fv(at, value);
    }
  }

  draw(uniforms) {
    const { gl } = this;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, gl.canvas.width, gl.canvas.height);
    this.use(this.view, uniforms);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  // The values that the shader gives for the tests of the page, [test][channel].
  check(tests) {
    const { gl, data } = this;
    if (!this.floats) throw new Error('This browser does not draw float32.');
    const program = this.program(data.shaders.check);
    this.newTexture(2, gl.TEXTURE_2D, gl.NEAREST, gl.NEAREST, gl.CLAMP_TO_EDGE);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 3, tests.length, 0, gl.RGBA, gl.FLOAT,
      Float32Array.from(tests.flatMap((test) => test.numbers)));
    this.newTexture(3, gl.TEXTURE_2D, gl.NEAREST, gl.NEAREST, gl.CLAMP_TO_EDGE);
    const target = gl.getParameter(gl.TEXTURE_BINDING_2D);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, tests.length, 1, 0, gl.RGBA, gl.FLOAT, null);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, tests.length, 1);
    this.use(program, { tests: { whole: 2 } });
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const values = new Float32Array(4 * tests.length);
    gl.readPixels(0, 0, tests.length, 1, gl.RGBA, gl.FLOAT, values);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return tests.map((_, k) => [...values.subarray(4 * k, 4 * k + data.channels)]);
  }
}
