// Draws the pictures: geometry once a frame, then every representation over it, averaged over
// frames with a sub-pixel shift each, and the panes from the averages.

class Unsupported extends Error {}

function openContext(canvas) {
  const gl = canvas.getContext('webgl2', {
    antialias: false,
    depth: false,
    alpha: false,
    preserveDrawingBuffer: true,
    powerPreference: 'high-performance',
  });
  if (!gl) {
    throw new Unsupported(
      'This page needs WebGL 2, which this browser does not offer here. ' +
        'Switch on hardware acceleration in its settings, or open the page in another browser.',
    );
  }
  if (!gl.getExtension('EXT_color_buffer_float')) {
    throw new Unsupported(
      'This page draws into floating-point textures (EXT_color_buffer_float), ' +
        'which this device does not offer. Most desktop computers do.',
    );
  }
  return gl;
}

function makeProgram(gl, vertex, fragment, name) {
  const program = gl.createProgram();
  for (const [type, source] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(`${name}: ${gl.getShaderInfoLog(shader)}`);
    }
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`${name}: ${gl.getProgramInfoLog(program)}`);
  }
  const places = {};
  const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
  for (let i = 0; i < count; ++i) {
    const info = gl.getActiveUniform(program, i);
    places[info.name.replace('[0]', '')] = gl.getUniformLocation(program, info.name);
  }
  return { program, places };
}

function halfArray(gl, width, height, layers, halves) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
  gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA16F, width, height, layers);
  for (const [key, value] of [
    [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
    [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
    [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
    [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
  ]) {
    gl.texParameteri(gl.TEXTURE_2D_ARRAY, key, value);
  }
  fillArray(gl, texture, width, height, layers, halves);
  return texture;
}

function fillArray(gl, texture, width, height, layers, halves) {
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
  gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
  gl.texSubImage3D(
    gl.TEXTURE_2D_ARRAY,
    0,
    0,
    0,
    0,
    width,
    height,
    layers,
    gl.RGBA,
    gl.HALF_FLOAT,
    halves,
  );
}

// The coefficients with all bands from `order` on set to 0: what a lower order would have stored.
function truncated(fit, order) {
  const halves = fit.halves.slice();
  const pixels = fit.width * fit.height;
  fit.bands.forEach((band, lane) => {
    if (band < order) return;
    const first = (lane >> 2) * pixels * 4 + (lane & 3);
    for (let p = 0; p < pixels; ++p) halves[first + 4 * p] = 0;
  });
  return halves;
}

// The texels of a form, which its shader fetches without a filter.
function singleArray(gl, width, height, values) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
  gl.texStorage3D(gl.TEXTURE_2D_ARRAY, 1, gl.RGBA32F, width, height, 1);
  gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D_ARRAY, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
  const [format, type] = [gl.RGBA, gl.FLOAT];
  gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, 0, 0, width, height, 1, format, type, values);
  return texture;
}

// The uniforms that only one kind of picture has.
function ownUniforms({ fit, form, exact, texture }, sky) {
  if (fit) {
    const light = fit.oddSign < 0 ? sky.oddSigned : sky.light;
    return { [fit.sampler]: { array: texture }, skyLight: { triples: light } };
  }
  const lobeRoughness = (form ?? exact).roughness;
  if (exact) return { exactTable: { array: texture }, lobeRoughness };
  return texture ? { [form.sampler]: { array: texture }, lobeRoughness } : { lobeRoughness };
}

class Renderer {
  constructor(canvas, data) {
    const gl = (this.gl = openContext(canvas)),
      file = data.shaders;
    this.canvas = canvas;
    this.environments = data.lights.map((light) => Environment.embedded(light));
    this.data = data;
    this.geometry = makeProgram(gl, file.geometryVertex, file.geometryFragment, 'geometry');
    this.composite = makeProgram(gl, file.screenVertex, file.compositeFragment, 'panes');
    this.images = data.fits.map((fit) => ({
      name: fit.name,
      fit,
      order: 0,
      shader: makeProgram(gl, file.screenVertex, fitSource(data, fit), fit.name),
      texture: halfArray(gl, fit.width, fit.height, fit.layers, fit.halves),
    }));
    if (data.form) {
      const { form } = data;
      this.images.unshift({
        name: form.name,
        form,
        shader: makeProgram(gl, file.screenVertex, formSource(data, form), form.name),
        texture: form.values ? singleArray(gl, form.width, form.height, form.values) : null,
      });
    }
    if (data.exact.halves) {
      const e = data.exact;
      this.images.unshift({
        name: 'exact',
        exact: e,
        shader: makeProgram(gl, file.screenVertex, exactSource(data, e), 'exact'),
        texture: halfArray(gl, e.width, e.height, e.azimuths * e.rest, e.halves),
      });
    }
    this.shapes = { sphere: this.upload(sphereShape()), teapot: this.upload(teapotShape()) };
    this.empty = gl.createVertexArray();
    this.frame = 0;
  }

  upload(shape) {
    const gl = this.gl,
      vao = gl.createVertexArray();
    gl.bindVertexArray(vao);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, shape.vertices, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, shape.indices, gl.STATIC_DRAW);
    for (const k of [0, 1]) {
      gl.enableVertexAttribArray(k);
      gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 24, 12 * k);
    }
    gl.bindVertexArray(null);
    return { vao, count: shape.indices.length, radius: shape.radius, extent: shape.extent };
  }

  target(width, height, textures, depth) {
    const gl = this.gl,
      framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const made = [];
    for (let i = 0; i < textures; ++i) {
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, texture, 0);
      made.push(texture);
    }
    gl.drawBuffers(made.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    let buffer = null;
    if (depth) {
      buffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, buffer);
    }
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE) {
      throw new Unsupported('This device cannot draw into 32-bit floating-point textures.');
    }
    return { framebuffer, textures: made, depth: buffer };
  }

  free(target) {
    const gl = this.gl;
    target.textures.forEach((texture) => gl.deleteTexture(texture));
    if (target.depth) gl.deleteRenderbuffer(target.depth);
    gl.deleteFramebuffer(target.framebuffer);
  }

  // Sizes the pictures; starts the average anew.
  resize(width, height) {
    if (this.width === width && this.height === height) return;
    if (this.surface) {
      this.free(this.surface);
      this.images.forEach((image) => image.targets.forEach((target) => this.free(target)));
    }
    [this.width, this.height] = [width, height];
    this.surface = this.target(width, height, 2, true);
    for (const image of this.images) {
      image.targets = [this.target(width, height, 1), this.target(width, height, 1)];
    }
    this.frame = 0;
  }

  restart() {
    this.frame = 0;
  }

  setOrder(order) {
    for (const image of this.images) {
      if (!image.fit || image.order === order) continue;
      image.order = order;
      fillArray(
        this.gl,
        image.texture,
        image.fit.width,
        image.fit.height,
        image.fit.layers,
        truncated(image.fit, order),
      );
    }
  }

  use({ program, places }, uniforms) {
    const gl = this.gl;
    gl.useProgram(program);
    let unit = 0;
    for (const [name, value] of Object.entries(uniforms)) {
      const place = places[name];
      if (!place) continue;
      if (value instanceof WebGLTexture) {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, value);
        gl.uniform1i(place, unit++);
      } else if (value.array) {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D_ARRAY, value.array);
        gl.uniform1i(place, unit++);
      } else if (value.triples) gl.uniform3fv(place, value.triples);
      else if (value.integer !== undefined) gl.uniform1i(place, value.integer);
      else if (value.length === 9) gl.uniformMatrix3fv(place, true, value);
      else if (value.length === 16) gl.uniformMatrix4fv(place, false, value);
      else if (value.length === 3) gl.uniform3fv(place, value);
      else if (typeof value === 'boolean') gl.uniform1i(place, value ? 1 : 0);
      else gl.uniform1f(place, value);
    }
  }

  // The coefficients of the light in the world of the pictures: rotated, not projected again.
  turnedSky({ sky, skyTurn, skyTilt }) {
    const environment = this.environments[sky];
    const key = [sky, skyTurn, skyTilt].join();
    if (this.sky?.key === key && this.sky.environment === environment) return this.sky;
    if (this.sky?.environment !== environment) this.uploadSky(environment);
    const order = this.data.skyOrder;
    const matrix = multiplied(zUpToYUp, turnAndTilt(skyTurn, skyTilt));
    const light = rotated(order, matrix, environment.coefficients);
    const odd = light.map((x, k) => {
      const slot = Math.floor(k / 3),
        l = Math.floor(Math.sqrt(slot));
      return (slot - l * (l + 1)) % 2 === 0 ? x : -x;
    });
    this.sky = { key, environment, matrix, light: [...light], oddSigned: [...odd] };
    return this.sky;
  }

  uploadSky(environment) {
    const gl = this.gl,
      { texels, alias } = environment.textures();
    for (const texture of Object.values(this.skyTextures ?? {})) gl.deleteTexture(texture);
    const make = (internal, format, values) => {
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
      gl.pixelStorei(gl.UNPACK_FLIP_Y_WEBGL, false);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      const { width, height } = environment;
      gl.texImage2D(gl.TEXTURE_2D, 0, internal, width, height, 0, format, gl.FLOAT, values);
      return texture;
    };
    this.skyTextures = {
      picture: make(gl.RGBA32F, gl.RGBA, texels),
      alias: make(gl.RG32F, gl.RG, alias),
    };
  }

  // One more frame of the average: `scene` as controls.js makes it. After `cycle` frames only the
  // exact environment goes on, over the same sub-pixel shifts again.
  step(scene, cycle) {
    const gl = this.gl;
    this.setOrder(scene.order);
    gl.viewport(0, 0, this.width, this.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    this.drawSurface(scene, this.frame % cycle);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.empty);
    const sky = this.turnedSky(scene);
    const shared = {
      positions: this.surface.textures[0],
      normals: this.surface.textures[1],
      eye: scene.eye,
      light: scene.light,
      lightDistance: scene.lightDistance,
      pointStrength: Array(3).fill(scene.pointStrength),
      environmentStrength: scene.environmentStrength,
      frameShare: 1 / (this.frame + 1),
      frameIndex: { integer: this.frame },
      clampNegative: scene.clamp,
      skyPicture: this.skyTextures.picture,
      skyAlias: this.skyTextures.alias,
      skyToWorld: sky.matrix,
    };
    for (const image of this.images) {
      if (image.fit && this.frame >= cycle) continue;
      const [from, to] = image.targets;
      gl.bindFramebuffer(gl.FRAMEBUFFER, to.framebuffer);
      this.use(image.shader, { ...shared, ...ownUniforms(image, sky), before: from.textures[0] });
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      image.targets = [to, from];
    }
    ++this.frame;
  }

  drawSurface(scene, frame) {
    const gl = this.gl,
      shape = this.shapes[scene.shape];
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.surface.framebuffer);
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    // The first frame through the middle of the pixel, the others spread by the R2 sequence.
    const shift = (step, size) => ((((frame * step + 0.5) % 1) - 0.5) * 2) / size;
    const camera = Float32Array.from(scene.camera);
    const dx = shift(0.7548776662466927, this.width),
      dy = shift(0.5698402909980532, this.height);
    for (let c = 0; c < 4; ++c) {
      camera[4 * c] += dx * camera[4 * c + 3];
      camera[4 * c + 1] += dy * camera[4 * c + 3];
    }
    this.use(this.geometry, { camera });
    gl.bindVertexArray(shape.vao);
    gl.drawElements(gl.TRIANGLES, shape.count, gl.UNSIGNED_INT, 0);
  }

  // Panes {x, y, width, height (device pixels, y up), clip [x0, x1] | null, first, second | null}.
  show(panes, look) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.disable(gl.DEPTH_TEST);
    gl.bindVertexArray(this.empty);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(...look.paper, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.SCISSOR_TEST);
    for (const pane of panes) {
      const [left, right] = pane.clip ?? [pane.x, pane.x + pane.width];
      if (right <= left) continue;
      gl.viewport(pane.x, pane.y, pane.width, pane.height);
      gl.scissor(left, pane.y, right - left, pane.height);
      if (!pane.first) continue;
      const first = pane.first.targets[0].textures[0];
      this.use(this.composite, {
        first,
        second: pane.second ? pane.second.targets[0].textures[0] : first,
        isDifference: Boolean(pane.second),
        showNegative: look.showNegative,
        exposure: look.exposure,
        differenceScale: look.scale,
        paper: look.paper,
      });
      gl.drawArrays(gl.TRIANGLES, 0, 3);
    }
  }

  // The averages as they are: RGBA floats, A the covered share of the pixel.
  read(image) {
    const gl = this.gl;
    const pixels = new Float32Array(this.width * this.height * 4);
    gl.bindFramebuffer(gl.FRAMEBUFFER, image.targets[0].framebuffer);
    gl.readPixels(0, 0, this.width, this.height, gl.RGBA, gl.FLOAT, pixels);
    return pixels;
  }
}
