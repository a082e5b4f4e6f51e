// mips.mjs DRIVER PROGRAM: files of the target mips on a GPU that reads BC5 and BC7, every level, against the
// normals and widths of the map that they are made of.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { read } from 'ktx-parse';
import { decoded, expect, finish, here, withBrowser } from './browser.mjs';
import { levelNumbers, levelSize, normalOf, widths } from './mip_numbers.mjs';

const [driver, program] = [process.argv[2], resolve(process.argv[3])];
const folder = mkdtempSync(join(tmpdir(), 'hshfit-mips-'));
const BC5 = 141,
  BC7 = 145; // VkFormat

// In the page: every level as floats, rows as in the file.
function decode({ format, sizes, levels }) {
  const gl = document.createElement('canvas').getContext('webgl2');
  gl.getExtension('EXT_color_buffer_float');
  const extension = gl.getExtension(format === 'bc5' ? 'EXT_texture_compression_rgtc' : 'EXT_texture_compression_bptc');
  if (!extension) return null;
  const kind = format === 'bc5' ? extension.COMPRESSED_RED_GREEN_RGTC2_EXT : extension.COMPRESSED_RGBA_BPTC_UNORM_EXT;
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texStorage2D(gl.TEXTURE_2D, levels.length, kind, ...sizes[0]);
  levels.forEach((text, k) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    gl.compressedTexSubImage2D(gl.TEXTURE_2D, k, 0, 0, ...sizes[k], kind, bytes);
  });
  const shader = (type, text) => {
    const made = gl.createShader(type);
    gl.shaderSource(made, `#version 300 es\nprecision highp float;\n${text}`);
    gl.compileShader(made);
    return made;
  };
  const drawing = gl.createProgram();
  gl.attachShader(drawing, shader(gl.VERTEX_SHADER, 'void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }'));
  gl.attachShader(drawing, shader(gl.FRAGMENT_SHADER, 'uniform sampler2D map; uniform int level; out vec4 result; void main() { result = texelFetch(map, ivec2(gl_FragCoord.xy), level); }'));
  gl.linkProgram(drawing);
  gl.useProgram(drawing);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  return sizes.map(([width, height], k) => {
    const target = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, target);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32F, width, height);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, target);
    gl.viewport(0, 0, width, height);
    gl.uniform1i(gl.getUniformLocation(drawing, 'level'), k);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const pixels = new Float32Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, pixels);
    if (gl.getError()) throw new Error('WebGL refuses the file');
    const bytes = new Uint8Array(pixels.buffer);
    let text = '';
    for (let at = 0; at < bytes.length; at += 8192) text += String.fromCharCode(...bytes.subarray(at, at + 8192));
    return btoa(text);
  });
}

await finish(async () => {
  try {
    const maps = join(here, '../../../examples/maps');
    execFileSync(program, ['svbrdf', join(maps, 'bumpy.json'), '-o', 'bumpy', '--form', 'ellipse', '--checks', '1', '--quiet'], { cwd: folder });
    const { stderr, status } = spawnSync(program, ['export', 'bumpy/material.json', '-o', 'out', '--target', 'mips,ktx2'], { cwd: folder, encoding: 'utf8' });
    expect(status === 0, stderr);
    const bound = (role) => Number(stderr.match(new RegExp(`${role}.*mean, ([0-9.e-]+) at most`))[1]);
    const open = (name) => read(readFileSync(join(folder, 'out', name)));
    const map = open('material.map.ktx2');
    await withBrowser(driver, async (page) => {
      await page.goto('http://localhost/');
      for (const [role, format, vulkan] of [['normal', 'bc5', BC5], ['roughness', 'bc7', BC7]]) {
        const file = open(`material.${role}.ktx2`);
        expect(file.vkFormat === vulkan && file.levels.length === map.levels.length, `${role}: format ${file.vkFormat}`);
        const sizes = file.levels.map((_, k) => levelSize(file, k));
        const levels = file.levels.map(({ levelData }) => Buffer.from(levelData).toString('base64'));
        const found = await page.evaluate(decode, { format, sizes, levels });
        if (!found) {
          console.log(`skipped: this browser has no ${format}`);
          continue;
        }
        let worst = 0;
        found.forEach((text, level) => {
          const texels = decoded(text, Float32Array),
            numbers = levelNumbers(map, level);
          for (let texel = 0; texel < texels.length / 4; ++texel) {
            const number = numbers(texel);
            if (role === 'roughness') {
              worst = Math.max(worst, Math.abs(texels[4 * texel + 1] - Math.sqrt(widths(number).shorter)));
              continue;
            }
            const [x, y] = [0, 1].map((c) => 2 * texels[4 * texel + c] - 1);
            const seen = [x, y, Math.sqrt(Math.max(0, 1 - x * x - y * y))],
              right = normalOf(number);
            const cosine = seen.reduce((sum, value, c) => sum + value * right[c], 0);
            worst = Math.max(worst, (180 / Math.PI) * Math.acos(Math.min(1, cosine)));
          }
        });
        console.log(`${role}: at most ${worst.toPrecision(3)} from the map, ${bound(role)} stated`);
        // The map's numbers are halves, and its bound is written with three digits.
        expect(worst > 0.5 * bound(role) && worst < 1.02 * bound(role) + 1e-3, `${role} is off by ${worst}`);
      }
    }, { files: (path) => (path === '/' ? { contentType: 'text/html', body: '<!DOCTYPE html><title>mips</title>' } : null) });
  } finally {
    rmSync(folder, { recursive: true, force: true });
  }
});
