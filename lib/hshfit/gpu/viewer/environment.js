// Lights: their pictures, the textures that the exact pane samples, and pictures dropped in.

class Environment {
  // `values`: radiance [row][column][R, G, B]; coefficients [slot][R, G, B].
  constructor(name, width, height, values, coefficients, note) {
    Object.assign(this, { name, width, height, values, coefficients, note });
  }

  // Of a light in the page.
  static embedded(light) {
    const bytes = bytesOf(light.texels),
      values = new Float32Array((bytes.length / 4) * 3);
    for (let k = 0; 4 * k < bytes.length; ++k) {
      const scale = 2 ** (bytes[4 * k + 3] - 136);
      for (let c = 0; c < 3; ++c) values[3 * k + c] = bytes[4 * k + c] * scale;
    }
    return new Environment(
      light.name,
      light.width,
      light.height,
      values,
      Float64Array.from(light.coefficients),
      light.note,
    );
  }

  // The four numbers of a texel: radiance, and the density by which `alias` chooses its directions.
  textures() {
    const { width, height, values } = this,
      count = width * height;
    const texels = new Float32Array(4 * count),
      weights = new Float64Array(count);
    let total = 0;
    for (let row = 0; row < height; ++row) {
      const angle = this.solidAngle(row);
      for (let k = row * width; k < (row + 1) * width; ++k) {
        texels.set(values.subarray(3 * k, 3 * k + 3), 4 * k);
        weights[k] = angle * (values[3 * k] + values[3 * k + 1] + values[3 * k + 2]);
        total += weights[k];
      }
    }
    for (let k = 0; k < count; ++k) {
      const angle = this.solidAngle(Math.floor(k / width));
      const share = total > 0 ? weights[k] / total : angle / (4 * Math.PI);
      weights[k] = share * count;
      texels[4 * k + 3] = share / angle;
    }
    return { texels, alias: aliasTable(weights) };
  }

  solidAngle(row) {
    const z = (r) => Math.cos((Math.PI * r) / this.height);
    return ((z(row) - z(row + 1)) * 2 * Math.PI) / this.width;
  }

  // Radiance from a direction of the picture's own world.
  at([x, y, z]) {
    const u = (Math.PI - Math.atan2(y, x)) / (2 * Math.PI),
      v = Math.acos(Math.min(Math.max(z, -1), 1)) / Math.PI;
    const column = Math.min(Math.floor(u * this.width), this.width - 1),
      row = Math.min(Math.floor(v * this.height), this.height - 1);
    const k = 3 * (row * this.width + column);
    return [this.values[k], this.values[k + 1], this.values[k + 2]];
  }
}

function bytesOf(base64) {
  const text = atob(base64),
    bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}

// Walker's alias table of weights whose mean is 1: [share of its own, the other one] for each.
function aliasTable(weights) {
  const table = new Float32Array(2 * weights.length),
    rest = Float64Array.from(weights);
  const small = [],
    large = [];
  rest.forEach((x, k) => (x < 1 ? small : large).push(k));
  while (small.length && large.length) {
    const k = small.pop(),
      other = large[large.length - 1];
    table[2 * k] = rest[k];
    table[2 * k + 1] = other;
    rest[other] -= 1 - rest[k];
    if (rest[other] < 1) small.push(large.pop());
  }
  for (const k of [...small, ...large]) table.set([1, k], 2 * k);
  return table;
}

// Means over blocks of pixels, weighted by solid angle, so that at most `most` columns are left.
function reduced(width, height, values, stride, most) {
  const block = Math.ceil(width / most);
  if (block === 1 && stride === 3) return { width, height, values };
  const w = Math.ceil(width / block),
    h = Math.ceil(height / block);
  const sums = new Float64Array(3 * w * h),
    weights = new Float64Array(w * h);
  for (let row = 0; row < height; ++row) {
    const weight = Math.sin((Math.PI * (row + 0.5)) / height);
    for (let column = 0; column < width; ++column) {
      // By place, so that sizes that no block divides keep theirs.
      const at =
        Math.floor((row * h) / height) * w + Math.floor((column * w) / width);
      weights[at] += weight;
      for (let c = 0; c < 3; ++c) {
        sums[3 * at + c] += weight * values[stride * (row * width + column) + c];
      }
    }
  }
  return { width: w, height: h, values: Float32Array.from(sums, (x, k) => x / weights[(k / 3) | 0]) };
}

// Pixels of a picture file: Radiance by readRadiance, everything else by the browser.
async function pixelsOf(file) {
  const bytes = new Uint8Array(await file.arrayBuffer());
  if (bytes[0] === 35 && bytes[1] === 63) {
    return readRadiance(bytes);
  }
  if (bytes[0] === 0x76 && bytes[1] === 0x2f && bytes[2] === 0x31 && bytes[3] === 1) {
    throw new Refused(
      'browsers read no OpenEXR: drop a .hdr, or name the file when the page is made',
    );
  }
  let bitmap;
  try {
    bitmap = await createImageBitmap(new Blob([bytes]), {
      premultiplyAlpha: 'none',
      colorSpaceConversion: 'none',
    });
  } catch {
    throw new Refused('it is no picture that this browser reads, nor a Radiance picture (.hdr)');
  }
  const { width, height } = bitmap;
  const canvas = Object.assign(document.createElement('canvas'), { width, height });
  const context = canvas.getContext('2d', { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  const { data } = context.getImageData(0, 0, width, height);
  const linear = Float32Array.from({ length: 256 }, (_, k) =>
    k <= 10 ? k / 255 / 12.92 : ((k / 255 + 0.055) / 1.055) ** 2.4,
  );
  const values = new Float32Array(data.length);
  for (let k = 0; k < data.length; ++k) values[k] = linear[data[k]];
  return { width, height, values, stride: 4 };
}

// A picture file as light: projected pixel by pixel to `order` bands.
async function droppedEnvironment(file, order) {
  let { width, height, values, stride } = await pixelsOf(file);
  if (!(width > 0) || width !== 2 * height) {
    throw new Refused(
      `it has ${width} x ${height} pixels; a latitude-longitude picture is twice as wide as high`,
    );
  }
  if (values.some((x) => !(x >= 0 && x < Infinity))) {
    throw new Refused('it has pixels that are negative, infinite or no number');
  }
  const start = performance.now();
  const coefficients = projectLatlong(order, width, height, values, stride);
  const seconds = (performance.now() - start) / 1000;
  const kept = reduced(width, height, values, stride, 1024);
  return new Environment(
    file.name,
    kept.width,
    kept.height,
    kept.values,
    coefficients,
    `${file.name}: ${width} x ${height} pixels, projected to ${order} bands in ` +
      `${seconds.toFixed(2)} s.`,
  );
}
