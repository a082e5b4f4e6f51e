// Real spherical harmonics, slot l (l + 1) + m, orthonormal over the sphere, odd m without the
// Condon-Shortley sign; coefficients as [slot][R, G, B]. The world has +z up. No page is needed.

// Normalised Legendre functions, those of m > 0 times the square root of 2: out[l (l + 1) / 2 + m].
function legendre(order, z, s, out) {
  const factor = (l, m) => Math.sqrt((4 * l * l - 1) / (l * l - m * m));
  let start = Math.sqrt(1 / (4 * Math.PI));
  for (let m = 0; m < order; ++m) {
    if (m > 0) start *= s * Math.sqrt((2 * m + 1) / (2 * m));
    let before = 0,
      now = start * (m > 0 ? Math.SQRT2 : 1);
    for (let l = m; l < order; ++l) {
      if (l > m) {
        const b = l > m + 1 ? factor(l, m) / factor(l - 1, m) : 0;
        [before, now] = [now, factor(l, m) * z * now - b * before];
      }
      out[(l * (l + 1)) / 2 + m] = now;
    }
  }
}

const gauss6 = [
  [0.2386191860831969, 0.46791393457269104],
  [0.6612093864662645, 0.36076157304813861],
  [0.9324695142031521, 0.17132449237917036],
].flatMap(([x, w]) => [
  [-x, w],
  [x, w],
]);

// Integrals of the Legendre functions times sin(theta) from `top` to `low`, radians.
function legendreIntegrals(order, top, low) {
  const sums = new Float64Array((order * (order + 1)) / 2),
    values = new Float64Array(sums.length);
  const parts = Math.ceil((low - top) / 0.2),
    half = (low - top) / parts / 2;
  for (let k = 0; k < parts; ++k) {
    const middle = top + (2 * k + 1) * half;
    for (const [x, w] of gauss6) {
      const theta = middle + half * x,
        s = Math.sin(theta);
      legendre(order, Math.cos(theta), s, values);
      for (let i = 0; i < sums.length; ++i) sums[i] += half * w * s * values[i];
    }
  }
  return sums;
}

// Coefficients of a latitude-longitude picture that is constant within a pixel: integrals over the
// pixels, no pixel is a point. `values` are [row][column][`stride` numbers, R, G and B first]; row 0
// is the zenith, and the azimuth is pi - 2 pi column / width.
function projectLatlong(order, width, height, values, stride) {
  const result = new Float64Array(3 * order * order),
    step = (2 * Math.PI) / width;
  const cosines = [],
    sines = [];
  for (let m = 0; m < order; ++m) {
    const share = m === 0 ? step : (2 * Math.sin((m * step) / 2)) / m;
    const angle = (k) => m * (Math.PI - (k + 0.5) * step);
    cosines.push(Float64Array.from({ length: width }, (_, k) => share * Math.cos(angle(k))));
    sines.push(Float64Array.from({ length: width }, (_, k) => share * Math.sin(angle(k))));
  }
  for (let row = 0; row < height; ++row) {
    const rings = legendreIntegrals(
      order,
      (Math.PI * row) / height,
      (Math.PI * (row + 1)) / height,
    );
    const first = row * width * stride;
    for (let c = 0; c < 3; ++c) {
      for (let m = 0; m < order; ++m) {
        const cosine = cosines[m],
          sine = sines[m];
        let a = 0,
          b = 0;
        for (let k = 0, at = first + c; k < width; ++k, at += stride) {
          a += cosine[k] * values[at];
          b += sine[k] * values[at];
        }
        for (let l = m; l < order; ++l) {
          const ring = rings[(l * (l + 1)) / 2 + m];
          result[3 * (l * (l + 1) + m) + c] += ring * a;
          if (m > 0) result[3 * (l * (l + 1) - m) + c] += ring * b;
        }
      }
    }
  }
  return result;
}

// The matrices of a rotation on bands 0 to order - 1, [l][m + l][m' + l], from its 3 x 3 matrix,
// rows first (Ivanic & Ruedenberg 1996, corrected 1998).
function rotationBands(order, matrix) {
  const axes = [1, 2, 0];
  const one = axes.map((i) => axes.map((j) => matrix[3 * i + j]));
  const bands = [[[1]], one].slice(0, order);
  for (let l = 2; l < order; ++l) {
    const old = bands[l - 1];
    const p = (i, a, b) => {
      const r = one[i + 1],
        row = old[a + l - 1];
      if (b === l) return r[2] * row[2 * l - 2] - r[0] * row[0];
      if (b === -l) return r[2] * row[0] + r[0] * row[2 * l - 2];
      return r[1] * row[b + l - 1];
    };
    const element = (m, n) => {
      const a = Math.abs(m),
        below = Math.abs(n) < l ? (l + n) * (l - n) : 2 * l * (2 * l - 1);
      let sum = 0;
      if (a < l) sum += Math.sqrt(((l + m) * (l - m)) / below) * p(0, m, n);
      if (m === 0) {
        return sum - Math.sqrt((2 * (l - 1) * l) / below) * 0.5 * (p(1, 1, n) + p(-1, -1, n));
      }
      const v = 0.5 * Math.sqrt(((l + a - 1) * (l + a)) / below),
        root = a === 1 ? Math.SQRT2 : 1;
      if (m > 0) sum += v * (root * p(1, m - 1, n) - (a === 1 ? 0 : p(-1, -m + 1, n)));
      else sum += v * ((a === 1 ? 0 : p(1, m + 1, n)) + root * p(-1, -m - 1, n));
      if (a < l - 1) {
        const w = -0.5 * Math.sqrt(((l - a - 1) * (l - a)) / below);
        sum +=
          w * (m > 0 ? p(1, m + 1, n) + p(-1, -m - 1, n) : p(1, m - 1, n) - p(-1, -m + 1, n));
      }
      return sum;
    };
    const band = [];
    for (let m = -l; m <= l; ++m) {
      band.push(Array.from({ length: 2 * l + 1 }, (_, k) => element(m, k - l)));
    }
    bands.push(band);
  }
  return bands;
}

// Coefficients of f(R^-1 d) from those of f(d).
function rotated(order, matrix, coefficients) {
  const result = new Float64Array(coefficients.length);
  rotationBands(order, matrix).forEach((band, l) => {
    const first = l * l;
    band.forEach((row, i) => {
      for (let c = 0; c < 3; ++c) {
        let sum = 0;
        row.forEach((x, j) => {
          sum += x * coefficients[3 * (first + j) + c];
        });
        result[3 * (first + i) + c] = sum;
      }
    });
  });
  return result;
}

// 3 x 3 matrices, rows first.
const multiplied = (a, b) =>
  Array.from(
    { length: 9 },
    (_, k) =>
      a[k - (k % 3)] * b[k % 3] +
      a[k - (k % 3) + 1] * b[3 + (k % 3)] +
      a[k - (k % 3) + 2] * b[6 + (k % 3)],
  );

// Turned about the world's vertical, then tilted about its +x; radians.
function turnAndTilt(turn, tilt) {
  const [c, s, d, t] = [Math.cos(turn), Math.sin(turn), Math.cos(tilt), Math.sin(tilt)];
  return multiplied([1, 0, 0, 0, d, -t, 0, t, d], [c, -s, 0, s, c, 0, 0, 0, 1]);
}

// The world with +z up, to that of the pictures, with +y up: (x, y, z) to (x, z, -y).
const zUpToYUp = [1, 0, 0, 0, 0, 1, 0, -1, 0];
