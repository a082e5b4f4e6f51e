// Numbers of the page as bytes: little-endian, base64.
function numbersOf(text, Type) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

function compiled(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
      throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error(gl.getProgramInfoLog(program));
  return program;
}

// The scene on the GPU. Light: [slot][R, G, B].
class Renderer {
  constructor(canvas, data) {
    const gl = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error('This page needs WebGL 2, which this browser does not offer here.');
    this.gl = gl;
    this.data = data;
    const { vertex, fragment } = data.shaders;
    this.diffuse = this.programOf(vertex, fragment);
    if (data.clusters)
      this.glossyProgram = this.programOf(vertex.replace('\n', '\n#define GLOSSY\n'), fragment);
    this.shape();
    this.kinds = data.kinds.map(({ channels, values }) => ({
      channels,
      values: numbersOf(values, Float32Array),
    }));
    this.limit = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    this.glossy();
  }

  // A program, and the places of its uniforms.
  programOf(vertex, fragment) {
    const gl = this.gl,
      program = compiled(gl, vertex, fragment),
      places = {};
    for (let k = 0; k < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++k) {
      const { name } = gl.getActiveUniform(program, k);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  // Texels [k] in rows of a width that a GPU takes, filled up with zeros.
  texture(values, channels, texture = this.gl.createTexture()) {
    const gl = this.gl,
      count = Math.max(1, values.length / channels),
      width = Math.min(2048, count),
      height = Math.ceil(count / width);
    const padded = new Float32Array(width * height * channels);
    padded.set(values);
    const [inside, format] = channels === 1 ? [gl.R32F, gl.RED] : [gl.RGBA32F, gl.RGBA];
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texImage2D(gl.TEXTURE_2D, 0, inside, width, height, 0, format, gl.FLOAT, padded);
    return texture;
  }

  shape() {
    const gl = this.gl,
      data = this.data;
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    const attribute = (at, values, size, whole) => {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(at);
      if (whole) gl.vertexAttribIPointer(at, size, gl.UNSIGNED_INT, 0, 0);
      else gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
      return buffer;
    };
    this.positions = numbersOf(data.positions, Float32Array);
    attribute(0, this.positions, 3, false);
    attribute(1, numbersOf(data.normals, Float32Array), 3, false);
    attribute(2, Uint32Array.from({ length: this.positions.length / 3 }, (_, k) => k), 1, true);
    this.sums = new Float32Array(this.positions.length);
    this.sumBuffer = attribute(3, this.sums, 3, false);
    this.sortTriangles();
  }

  // A range of indices for the fronts and one for the backs of each material of the scene.
  sortTriangles() {
    const gl = this.gl,
      triangles = numbersOf(this.data.triangles, Uint32Array),
      materials = numbersOf(this.data.materialOf, Uint32Array);
    const groups = this.data.sceneMaterials.flatMap(() => [[], []]);
    for (let t = 0; t < triangles.length; t += 3) {
      const side = t < 3 * this.data.fronts ? 0 : 1;
      groups[2 * materials[triangles[t]] + side].push(...triangles.subarray(t, t + 3));
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint32Array.from(groups.flat()), gl.STATIC_DRAW);
    let first = 0;
    this.ranges = groups.map(({ length }) => {
      const range = { first, length };
      first += length;
      return range;
    });
  }

  // The vectors of a kind times light, for each vertex.
  illuminateVectors({ channels, values }) {
    const gl = this.gl,
      slots = this.data.order ** 2,
      count = this.sums.length / 3,
      [red, green, blue] = [0, 1, 2].map((c) =>
        Float32Array.from({ length: slots }, (_, i) => this.light[3 * i + c]),
      );
    for (let v = 0; v < count; ++v) {
      let at = v * channels * slots,
        r = 0,
        g = 0,
        b = 0;
      if (channels === 1) {
        for (let i = 0; i < slots; ++i, ++at) {
          const x = values[at];
          r += x * red[i];
          g += x * green[i];
          b += x * blue[i];
        }
      } else {
        for (let i = 0; i < slots; ++i, ++at) {
          r += values[at] * red[i];
          g += values[at + slots] * green[i];
          b += values[at + 2 * slots] * blue[i];
        }
      }
      this.sums[3 * v] = r;
      this.sums[3 * v + 1] = g;
      this.sums[3 * v + 2] = b;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.sumBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, this.sums, gl.DYNAMIC_DRAW);
  }

  glossy() {
    const { clusters, materials } = this.data;
    this.rows = [];
    const responses = [];
    for (const material of materials) {
      this.rows.push(material.response && clusters ? responses.length / 4 : -1);
      if (!material.response || !clusters) continue;
      const from = numbersOf(material.response, Float32Array),
        functions = this.data.localOrder ** 2;
      // [elevation, or row and column of the map][channel][slot].
      const directions = material.side ** 2 || this.data.elevations,
        channels = from.length / directions / functions;
      for (let k = 0; k < directions * functions; ++k) {
        const row = Math.floor(k / functions);
        for (let c = 0; c < 3; ++c)
          responses.push(from[(row * channels + (c % channels)) * functions + (k % functions)]);
        responses.push(0);
      }
    }
    const functions = this.data.localOrder ** 2 || 1;
    this.rows = this.rows.map((first) => (first < 0 ? -1 : first / functions));
    this.responses = this.texture(Float32Array.from(responses), 4);
    this.incident = this.gl.createTexture();
    this.texture(new Float32Array(4), 4, this.incident);
    if (!clusters) {
      this.weights = this.texture(new Float32Array(1), 1);
      return;
    }
    this.bases = numbersOf(clusters.bases, Float32Array);
    const of = numbersOf(clusters.of, Uint32Array),
      weights = numbersOf(clusters.weights, Float32Array),
      stride = clusters.components + 1;
    const texels = new Float32Array(of.length * stride);
    of.forEach((cluster, v) => {
      texels[v * stride] = cluster;
      for (let k = 1; k < stride; ++k)
        texels[v * stride + k] = weights[v * clusters.components + k - 1];
    });
    this.weights = this.texture(texels, 1);
  }

  // Means and components times light: what comes to a vertex, by function above it.
  illuminate(light, kind) {
    this.light = Float32Array.from(light);
    this.illuminateVectors(this.kinds[kind]);
    const { clusters, order, localOrder } = this.data;
    if (!clusters) return;
    const slots = order ** 2,
      functions = localOrder ** 2,
      { channels } = clusters,
      number = this.bases.length / channels / functions / slots;
    const texels = new Float32Array(4 * number * functions);
    for (let b = 0; b < number; ++b) {
      for (let j = 0; j < functions; ++j) {
        for (let c = 0; c < 3; ++c) {
          const first = ((b * channels + (c % channels)) * functions + j) * slots;
          let sum = 0;
          for (let i = 0; i < slots; ++i) sum += this.bases[first + i] * light[3 * i + c];
          texels[4 * (b * functions + j) + c] = sum;
        }
      }
    }
    this.texture(texels, 4, this.incident);
  }

  use({ program, places }, { camera, eye, exposure }) {
    const gl = this.gl,
      data = this.data;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.camera, false, camera);
    gl.uniform1f(places.exposure, exposure);
    if (program === this.diffuse.program) return;
    gl.uniform3fv(places.eye, eye);
    gl.uniform1i(places.localOrder, data.localOrder);
    gl.uniform1i(places.elevations, data.elevations);
    gl.uniform1i(places.components, data.clusters.components);
    const { incident, weights, responses } = this;
    Object.entries({ incident, weights, responses }).forEach(([name, texture], unit) => {
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.uniform1i(places[name], unit);
    });
    gl.activeTexture(gl.TEXTURE0);
  }

  // `chosen`: for each material of the scene the one in its place, and an albedo.
  draw(view, chosen) {
    const gl = this.gl;
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.bindVertexArray(this.array);
    const isGlossy = ({ material }) => this.rows[material] >= 0;
    for (const kind of [this.diffuse, this.glossyProgram]) {
      const drawn = chosen.map((one, k) => [one, this.ranges.slice(2 * k, 2 * k + 2)]).filter(
        ([one]) => isGlossy(one) === (kind === this.glossyProgram),
      );
      if (drawn.length === 0) continue;
      this.use(kind, view);
      for (const [{ albedo, material }, ranges] of drawn) {
        if (kind === this.diffuse) gl.uniform3fv(kind.places.albedo, albedo);
        else {
          gl.uniform1i(kind.places.row, this.rows[material]);
          gl.uniform1i(kind.places.side, this.data.materials[material].side);
        }
        ranges.forEach(({ first, length }, side) => {
          // Backs stay behind: at an outline they meet the fronts at one depth.
          gl.polygonOffset(4 * side, 4 * side);
          if (length > 0) gl.drawElements(gl.TRIANGLES, length, gl.UNSIGNED_INT, 4 * first);
        });
      }
    }
  }
}
