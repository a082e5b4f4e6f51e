// viewer.mjs DRIVER FOLDER: the viewer page, opened from disk, draws what it should.
import { pathToFileURL } from 'node:url';
import { join } from 'node:path';
import { decoded, expect, finish, readJson, withBrowser } from './browser.mjs';

const [driver, folder] = process.argv.slice(2);
const address = pathToFileURL(join(folder, 'viewer.html')).href;
const viewport = { width: 600, height: 480 };

const settled = (page) => page.waitForFunction(() => window.viewer?.settled);

async function open(page, state) {
  await page.goto('about:blank');
  await page.goto(`${address}#frames=1&cycles=1&lighting=point&${state}`);
  await settled(page);
}

// Numbers of the pairs, and the means of the pictures over the shape.
const facts = (page) =>
  page.evaluate(() => ({
    numbers: window.viewer.numbers,
    names: window.viewer.pairs.map(([a, b]) => `${a.name} − ${b.name}`),
    means: window.viewer.renderer.images.map((image) => {
      const pixels = window.viewer.renderer.read(image);
      let sum = 0,
        count = 0;
      for (let k = 0; k < pixels.length; k += 4) {
        if (pixels[k + 3] > 0) {
          sum += pixels[k] + pixels[k + 1] + pixels[k + 2];
          ++count;
        }
      }
      return sum / count / 3;
    }),
  }));

async function provePage(page, complaints) {
  await open(page, 'order=8');
  const high = await facts(page),
    pictures = [await page.screenshot()];
  expect(high.means.length === 3 && high.means.every((mean) => mean > 1e-3), `means ${high.means}`);
  await open(page, 'order=2');
  const low = await facts(page);
  high.names.slice(0, 2).forEach((name, i) => {
    console.log(
      `${name}: r.m.s. ${low.numbers[i].relative} at order 2, ${high.numbers[i].relative} at 8`,
    );
    expect(high.numbers[i].relative < 0.5 * low.numbers[i].relative, `${name} does not converge`);
  });

  // The slider, by keyboard, and all buttons.
  await page.focus('#order');
  pictures.push(await page.screenshot());
  await page.keyboard.press('ArrowRight');
  await page.waitForFunction(() => window.viewer.state.order === 3);
  await settled(page);
  const third = await facts(page);
  expect(third.numbers[0].relative < low.numbers[0].relative, 'the slider changes no picture');
  pictures.push(await page.screenshot());
  const press = async (selector) => {
    await page.click(selector);
    await settled(page);
    pictures.push(await page.screenshot());
  };
  await press('#clamp');
  expect(
    (await page.evaluate(() => window.viewer.negative.get(window.viewer.renderer.images[1]))) > 0,
    'order 3 of Phong has no negative values',
  );
  await press('label:has([value=teapot])');
  await press('label:has([value=sky])');
  await press('label:has([value=split])');
  await page.focus('.divider');
  await page.keyboard.press('ArrowLeft');
  pictures.push(await page.screenshot());
  const names = new Set(pictures.map((picture) => picture.toString('base64')));
  expect(
    names.size === pictures.length,
    `only ${names.size} of ${pictures.length} pictures differ`,
  );
  expect(complaints.length === 0, `console: ${complaints.join('; ')}`);
}

// The studio's light, whose bands beyond those of the page the pictures by coefficients miss.
async function proveStudio(page) {
  await open(page, 'order=8&lighting=sky&cycles=24');
  const { numbers, names } = await facts(page);
  console.log(`studio: ${names[0]}: r.m.s. ${numbers[0].relative}`);
  expect(numbers[0].relative < 0.12, 'the studio differs');
}

// A Radiance file of two bands: radiance 1 + 0.9 d . axis, with an axis for each colour.
function radianceFile(width, axes) {
  const height = width / 2;
  const head = Buffer.from(`#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y ${height} +X ${width}\n`);
  const pixels = Buffer.alloc(4 * width * height);
  for (let row = 0; row < height; ++row) {
    const theta = (Math.PI * (row + 0.5)) / height;
    for (let column = 0; column < width; ++column) {
      const phi = Math.PI - (2 * Math.PI * (column + 0.5)) / width;
      const d = [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
      const at = 4 * (row * width + column);
      axes.forEach((axis, c) => {
        const value = 1 + 0.9 * axis.reduce((sum, x, i) => sum + x * d[i], 0);
        pixels[at + c] = Math.round(value * 128);
      });
      pixels[at + 3] = 129;
    }
  }
  return Buffer.concat([head, pixels]);
}

const dropped = async (page, name, bytes) => {
  const count = await page.evaluate(() => window.viewer.renderer.environments.length);
  await page.evaluate(
    ([text, fileName]) => {
      const file = new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], fileName);
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(file);
      document.body.dispatchEvent(
        new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }),
      );
    },
    [bytes.toString('base64'), name],
  );
  await page.waitForFunction(
    (old) =>
      window.viewer.renderer.environments.length > old ||
      document.querySelector('#skyNote').classList.contains('warning'),
    count,
  );
  await settled(page);
  return page.textContent('#skyNote');
};

// A picture dropped in is projected and turned; what coefficients give agrees with the quadrature
// of the exact pane, which reads the picture itself.
async function proveDrop(page) {
  const axes = [
    [0.6, 0, 0.8],
    [0, -0.6, 0.8],
    [-0.48, 0.6, -0.64],
  ];
  await open(page, 'order=8&lighting=sky&cycles=12&skyTurn=70&skyTilt=-35');
  const note = await dropped(page, 'two-bands.hdr', radianceFile(256, axes));
  expect(/256 x 128 pixels, projected to 10 bands/.test(note), `note: ${note}`);
  // radiance = sqrt(4 pi) Y_00 + 0.9 sqrt(4 pi / 3) (axis . (Y_11, Y_1-1, Y_10)).
  const coefficients = await page.evaluate(() => [
    ...window.viewer.renderer.environments.at(-1).coefficients,
  ]);
  const one = 0.9 * Math.sqrt((4 * Math.PI) / 3);
  const expected = coefficients.map((_, k) => {
    const slot = Math.floor(k / 3),
      axis = axes[k % 3];
    if (slot === 0) return Math.sqrt(4 * Math.PI);
    return slot < 4 ? one * axis[[1, 2, 0][slot - 1]] : 0;
  });
  const gap = Math.max(...expected.map((x, k) => Math.abs(x - coefficients[k])));
  // Mantissas of 8 bits, means of pixels taken at their middles.
  console.log(`dropped: coefficients differ by ${gap}`);
  expect(gap < 2e-3, `coefficients differ by ${gap}`);
  const { numbers, names } = await facts(page);
  console.log(`dropped: ${names[0]}: r.m.s. ${numbers[0].relative}`);
  expect(numbers[0].relative < 0.04, 'shadeWorld and quadrature disagree');

  // Turned with the mouse: other coefficients by rotation, no new projection, and still right.
  const before = await page.evaluate(() => [...window.viewer.renderer.sky.light]);
  await page.locator('#skyPicture').scrollIntoViewIfNeeded();
  const box = await page.locator('#skyPicture').boundingBox();
  await page.mouse.move(box.x + 60, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + 150, box.y + 60, { steps: 4 });
  await page.mouse.up();
  await settled(page);
  const turned = await page.evaluate(() => ({
    light: [...window.viewer.renderer.sky.light],
    state: [window.viewer.state.skyTurn, window.viewer.state.skyTilt],
  }));
  const wanted = [70 - (90 * 360) / box.width, -35 - (20 * 180) / box.height];
  expect(
    turned.state.every((x, k) => Math.abs(x - wanted[k]) < 2),
    `turned to ${turned.state} instead of ${wanted}`,
  );
  expect(
    turned.light.some((x, k) => Math.abs(x - before[k]) > 0.1),
    'the mouse turns nothing',
  );
  const after = await facts(page);
  console.log(`turned: r.m.s. ${after.numbers[0].relative}`);
  expect(after.numbers[0].relative < 0.04, 'wrong after a turn with the mouse');

  for (const [name, bytes, reason] of [
    ['text.txt', Buffer.from('no picture'), /no picture that this browser reads/],
    ['short.hdr', radianceFile(64, axes).subarray(0, 5000), /cannot be used/],
    ['square.hdr', Buffer.concat([Buffer.from('#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n'),
      Buffer.alloc(16, 100)]), /twice as wide as high/],
    ['a.exr', Buffer.from([0x76, 0x2f, 0x31, 1, 2, 0, 0, 0]), /OpenEXR/],
  ]) {
    const text = await dropped(page, name, bytes);
    expect(reason.test(text), `${name}: '${text}'`);
  }
}

// The page says that it is rendering until the first picture is there, and opens with both lights.
async function proveOpening(page) {
  await page.addInitScript(() => {
    const next = window.requestAnimationFrame.bind(window);
    const held = [];
    window.requestAnimationFrame = (draw) => held.push(draw);
    window.showFrames = () => {
      window.requestAnimationFrame = next;
      held.forEach(next);
    };
  });
  await page.goto(`${address}#frames=1&cycles=1`, { waitUntil: 'domcontentloaded' });
  expect(await page.isVisible('#rendering'), 'the page says nothing before the first picture');
  await page.evaluate(() => window.showFrames());
  await settled(page);
  expect(await page.isHidden('#rendering'), 'the page says that it is rendering after it has');
  const { means } = await facts(page);
  expect((await page.evaluate(() => window.viewer.state.lighting)) === 'both', 'one light only');
  expect(means.every((mean) => mean > 1e-2), `black: ${means}`);
}

// All numbers are finite on the teapot under both kinds of light.
async function proveFinite(page) {
  await page.goto('about:blank');
  await page.goto(
    `${pathToFileURL(join(folder, 'viewer_ward.html')).href}` +
      '#frames=4&cycles=2&lighting=both&shape=teapot',
  );
  await settled(page);
  const { numbers, means } = await facts(page);
  const values = numbers.flatMap(({ largest, mean, relative }) => [largest, mean, relative]);
  expect([...values, ...means].every(Number.isFinite), `not finite: ${values}`);
}

// In the page: f of the exact pane's shader for pairs of directions.
function lookUp(inputs) {
  const { renderer, data } = window.viewer,
    gl = renderer.gl,
    side = 64;
  const image = renderer.images.find(({ exact }) => exact),
    { exact } = image;
  const program = makeProgram(
    gl,
    data.shaders.screenVertex,
    `${exactTableSource(data, exact)}
    uniform sampler2D wos, wis;
    out vec4 result;
    void main() {
      ivec2 at = ivec2(gl_FragCoord.xy);
      result = vec4(exactBrdf(texelFetch(wos, at, 0).xyz, texelFetch(wis, at, 0).xyz), 1.0);
    }`,
    'look-up',
  );
  const vectors = (first) => {
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texImage2D(
      gl.TEXTURE_2D,
      0,
      gl.RGBA32F,
      side,
      side,
      0,
      gl.RGBA,
      gl.FLOAT,
      Float32Array.from({ length: 4 * side * side }, (_, i) =>
        i % 4 === 3 ? 0 : inputs[6 * (i >> 2) + first + (i % 4)],
      ),
    );
    return texture;
  };
  const wos = vectors(0),
    wis = vectors(3),
    target = renderer.target(side, side, 1);
  gl.disable(gl.SCISSOR_TEST);
  gl.viewport(0, 0, side, side);
  renderer.use(program, { exactTable: { array: image.texture }, wos, wis });
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = new Float32Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.FLOAT, pixels);
  return [...pixels.filter((_, i) => i % 4 === 0)];
}

// The tables as GLSL reads them, against the same in C++, above 5 degrees of elevation. Filters
// weight texels to 1/256 or better.
async function proveTable(page, name) {
  await page.goto('about:blank');
  await page.goto(`${pathToFileURL(join(folder, `${name}.html`)).href}#frames=1`);
  await settled(page);
  const job = readJson(join(folder, `${name}_table.json`));
  const inputs = [...decoded(job.inputs, Float32Array)],
    expected = decoded(job.expected, Float64Array);
  const found = await page.evaluate(lookUp, inputs);
  let wrong = 0,
    all = 0;
  expected.forEach((f, k) => {
    const [cosO, cosI] = [inputs[6 * k + 2], inputs[6 * k + 5]];
    if (Math.min(cosO, cosI) > 0 && Math.min(cosO, cosI) < 0.087) return;
    wrong += (found[k] - f) ** 2;
    all += f * f;
  });
  const relative = Math.sqrt(wrong / all);
  console.log(`${name}: table in GLSL against C++: r.m.s. ${relative}`);
  expect(relative < 1e-3, `${name}: the table is read wrongly`);
}

async function proveMessage(page) {
  await page.addInitScript(() => {
    const old = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      return kind === 'webgl2' ? null : old.call(this, kind, ...rest);
    };
  });
  await page.goto(address);
  await page.waitForSelector('#message:not([hidden])');
  const text = await page.textContent('#message');
  expect(/WebGL 2/.test(text) && (await page.isVisible('#message')), `message: '${text}'`);
}

await finish(async () => {
  await withBrowser(
    driver,
    async (page, complaints) => {
      await provePage(page, complaints);
      await proveStudio(page);
      await proveDrop(page);
      await proveFinite(page);
      await proveTable(page, 'viewer');
      await proveTable(page, 'viewer_ward');
    },
    { viewport },
  );
  await withBrowser(driver, proveOpening, { viewport });
  await withBrowser(driver, proveMessage, { viewport });
});
