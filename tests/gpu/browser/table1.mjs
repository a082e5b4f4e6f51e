// table1.mjs PROGRAM [DRIVER [ROUNDS]]: Table 1 of Gautron et al. 2004 as a ratio of shaders: time of
// a draw in which every pixel rotates RGB light in SH into its own frame, converts it and multiplies
// it with its material (shadeWorld as exported), HSH over SH at the paper's orders. Draws of both
// take turns; medians of times, and of the ratios of neighbouring draws, which other load of the machine
// affects alike. On a software renderer, as named in the output.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { expect, finish, withBrowser } from './browser.mjs';

const program = resolve(process.argv[2]);
const [driver, rounds] = [process.argv[3] ?? 'swiftshader', +(process.argv[4] ?? 15)];
const orders = [2, 3, 5, 8, 10];

// In the page: milliseconds of `rounds` draws of each job by turns, and what is drawn.
async function time({ jobs, rounds: count, side }) {
  const gl = document.createElement('canvas').getContext('webgl2');
  if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('no EXT_color_buffer_float');
  const vertex = `#version 300 es
    void main() {
      gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1);
    }`;
  const made = jobs.map(({ shader, slots, width, height, layers, texels }) => {
    const program = gl.createProgram();
    const fragment = `#version 300 es\n${shader}
      uniform vec3 light[${slots}];
      out vec4 result;
      void main() {
        // A frame and a view of its own for each pixel, from its place.
        vec2 at = (gl_FragCoord.xy + 0.5) / ${side}.0;
        float z = 2.0 * at.y - 1.0, r = sqrt(max(0.0, 1.0 - z * z)), phi = 6.2831853 * at.x;
        vec3 n = vec3(r * cos(phi), r * sin(phi), z), side = vec3(-sin(phi), cos(phi), 0.0);
        vec3 t = 0.6 * side + 0.8 * cross(n, side), b = cross(n, t);
        vec3 wo = normalize(n + 0.9 * t * at.x + 0.5 * b * at.y);
        result = vec4(hsh_shadeWorld(wo, t, b, n, light), 1.0);
      }`;
    for (const [type, source] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const one = gl.createShader(type);
      gl.shaderSource(one, source);
      gl.compileShader(one);
      if (!gl.getShaderParameter(one, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(one));
      gl.attachShader(program, one);
    }
    gl.linkProgram(program);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    for (const [key, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ]) {
      gl.texParameteri(gl.TEXTURE_2D_ARRAY, key, value);
    }
    const bytes = Uint8Array.from(atob(texels), (c) => c.charCodeAt(0));
    gl.texImage3D(
      gl.TEXTURE_2D_ARRAY,
      0,
      gl.RGBA16F,
      width,
      height,
      layers,
      0,
      gl.RGBA,
      gl.HALF_FLOAT,
      new Uint16Array(bytes.buffer),
    );
    gl.useProgram(program);
    const values = Float32Array.from({ length: 3 * slots }, (_, k) =>
      k < 3 ? 3.5 : 0.5 * Math.sin(7 * k),
    );
    gl.uniform3fv(gl.getUniformLocation(program, 'light'), values);
    return { program, texture, times: [] };
  });
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  const target = gl.createTexture();
  gl.activeTexture(gl.TEXTURE1);
  gl.bindTexture(gl.TEXTURE_2D, target);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, side, side);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.activeTexture(gl.TEXTURE0);
  gl.viewport(0, 0, side, side);
  const pixel = new Float32Array(4);
  const draw = ({ program, texture }) => {
    gl.useProgram(program);
    gl.bindTexture(gl.TEXTURE_2D_ARRAY, texture);
    const start = performance.now();
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    // Reading waits for the draw.
    gl.readPixels(side >> 1, (3 * side) >> 2, 1, 1, gl.RGBA, gl.FLOAT, pixel);
    return performance.now() - start;
  };
  for (const job of made) {
    draw(job);
    job.value = [...pixel];
  }
  for (let k = 0; k < count; ++k) {
    // Forth and back, so that drifts meet both.
    for (const job of k % 2 ? [...made].reverse() : made) job.times.push(draw(job));
  }
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  return {
    renderer: gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER),
    error: gl.getError(),
    times: made.map(({ times }) => times),
    values: made.map(({ value }) => value),
  };
}

function jobOf(folder, basis, order) {
  const name = `${basis}${order}`;
  const run = (...words) =>
    execFileSync(program, [...words, '--quiet'], { cwd: folder, encoding: 'utf8' });
  run(
    ...['project', 'phong:kd=0.3/0.2/0.1,ks=0.5,exponent=22', '-o', `${name}.json`, '--cosine'],
    ...['--basis', basis, '--order', String(order), '--outgoing', '32x32'],
  );
  const answer = JSON.parse(
    run(
      ...['export', `${name}.json`, '-o', name, '--target', 'bin,glsl-es', '--no-error', '--json'],
      ...['--environment-order', String(order)],
    ),
  );
  const file = (role) => answer.files.find((one) => one.role === role).path;
  return {
    shader: readFileSync(join(folder, name, file('shader')), 'utf8'),
    texels: readFileSync(join(folder, name, file('coef'))).toString('base64'),
    slots: order * order,
    width: 32,
    height: 32,
    layers: answer.layers,
  };
}

await finish(async () => {
  const folder = mkdtempSync(join(tmpdir(), 'hshfit-table1-'));
  try {
    await withBrowser(driver, async (page, complaints) => {
      console.log('order  SH, ms  HSH, ms  ratio');
      let renderer = '';
      for (const order of orders) {
        const jobs = ['sh', 'hsh'].map((basis) => jobOf(folder, basis, order));
        const found = await page.evaluate(time, { jobs, rounds, side: 256 });
        const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
        const [sh, hsh] = found.times.map(median);
        const ratio = median(found.times[1].map((x, k) => x / found.times[0][k]));
        renderer = found.renderer;
        console.log(
          `${String(order).padStart(5)}  ${sh.toFixed(2).padStart(6)}  ` +
            `${hsh.toFixed(2).padStart(7)}  ${ratio.toFixed(3)}`,
        );
        expect(found.error === 0, `WebGL error ${found.error}`);
        expect(
          found.values.flat().every(Number.isFinite) && found.values[0].some((x) => x !== 0),
          `drawn: ${found.values}`,
        );
      }
      console.log(renderer);
      expect(complaints.length === 0, complaints.join('; '));
    });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
