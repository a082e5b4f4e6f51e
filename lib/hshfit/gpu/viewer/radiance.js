// Radiance pictures (.hdr, .pic): text lines up to an empty one, a line with the size, then pixels
// of three mantissas and a common exponent (G. Ward, "Real Pixels", Graphics Gems II, 1991), each
// row plain, or run-length encoded by pixel or by channel.

// A file that the page cannot use, with the reason; other errors are faults of the page.
class Refused extends Error {}

class RadianceBytes {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  next() {
    if (this.at >= this.bytes.length) throw new Refused('the picture is cut short');
    return this.bytes[this.at++];
  }

  line() {
    let text = '';
    for (let byte = this.next(); byte !== 10; byte = this.next()) {
      if (text.length > 2000) throw new Refused('its head is no text');
      text += String.fromCharCode(byte);
    }
    return text.trim();
  }
}

// Width and height, after the head was read.
function radianceSize(input) {
  for (let line = input.line(); line !== ''; line = input.line()) {
    const format = /^FORMAT=(.*)$/.exec(line);
    if (format && format[1].trim() !== '32-bit_rle_rgbe') {
      throw new Refused(`its FORMAT is ${format[1]}; 32-bit_rle_rgbe is read`);
    }
  }
  const line = input.line();
  const size = /^-Y\s+(\d+)\s+\+X\s+(\d+)$/.exec(line);
  if (!size) throw new Refused(`its size is '${line}'; rows from above, -Y H +X W, are read`);
  const [height, width] = [Number(size[1]), Number(size[2])];
  if (width < 1 || height < 1 || width * height > 1 << 28) {
    throw new Refused(`it has ${width} x ${height} pixels`);
  }
  return { width, height };
}

// Four channels one after the other: 128 + n repeats the next byte n times, n copies n bytes.
function channelRuns(input, row, width) {
  for (let channel = 0; channel < 4; ++channel) {
    for (let x = 0; x < width; ) {
      const code = input.next();
      const count = code > 128 ? code - 128 : code;
      if (count === 0 || x + count > width) throw new Refused('a run passes its row');
      const repeated = code > 128 ? input.next() : 0;
      for (let k = 0; k < count; ++k, ++x) {
        row[4 * x + channel] = code > 128 ? repeated : input.next();
      }
    }
  }
}

// Pixel by pixel from `first` on; mantissas 1, 1, 1 repeat the pixel before, and the exponents of
// consecutive ones are the bytes of the count, the lowest first.
function pixelRuns(input, row, width, first) {
  let shift = 0;
  for (let x = 0; x < width; ) {
    const pixel = x === 0 && first ? first : [0, 0, 0, 0].map(() => input.next());
    if (pixel[0] === 1 && pixel[1] === 1 && pixel[2] === 1 && x > 0) {
      const count = pixel[3] * 2 ** shift;
      shift += 8;
      if (x + count > width) throw new Refused('a run passes its row');
      for (let k = 0; k < count; ++k, ++x) row.copyWithin(4 * x, 4 * (x - 1), 4 * x);
    } else {
      row.set(pixel, 4 * x++);
      shift = 0;
    }
  }
}

// R, G, B of each pixel, rows from above; bytes that are no such picture throw Refused.
function readRadiance(bytes) {
  const input = new RadianceBytes(bytes);
  const { width, height } = radianceSize(input);
  const row = new Uint8Array(4 * width);
  const values = new Float32Array(3 * width * height);
  for (let y = 0; y < height; ++y) {
    const first = [0, 0, 0, 0].map(() => input.next());
    const byChannel = first[0] === 2 && first[1] === 2 && first[2] < 128;
    if (byChannel && 256 * first[2] + first[3] === width) {
      channelRuns(input, row, width);
    } else {
      pixelRuns(input, row, width, first);
    }
    for (let x = 0; x < width; ++x) {
      const scale = row[4 * x + 3] === 0 ? 0 : 2 ** (row[4 * x + 3] - 136);
      for (let c = 0; c < 3; ++c) values[3 * (y * width + x) + c] = row[4 * x + c] * scale;
    }
  }
  return { width, height, values, stride: 3 };
}
