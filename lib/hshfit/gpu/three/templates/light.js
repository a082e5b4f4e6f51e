
// Environments in the world of three.js, +y up: radiance as coefficients [slot][R, G, B] of the
// functions above, slot l (l + 1) + m.

// Of the JSON that `hshfit light SPEC -o FILE` writes (+z up there).
export function environmentFromFile(file) {
  const { format, basis, domain, coefficients } = file;
  if (format !== 'hshfit-light' || basis?.name !== 'sh' || domain !== 'sphere') {
    throw new Error('not a file of light in spherical harmonics over the whole sphere');
  }
  if (coefficients.length !== 1 && coefficients.length !== 3) {
    throw new Error(`${coefficients.length} channels of light; this material takes 1 or 3`);
  }
  const order = basis.order;
  const given = Float64Array.from({ length: 3 * order * order }, (_, k) => {
    const slot = Math.floor(k / 3),
      l = Math.floor(Math.sqrt(slot)),
      odd = (slot - l * (l + 1)) % 2 !== 0;
    const channel = coefficients[Math.min(k % 3, coefficients.length - 1)];
    return basis.condon_shortley && odd ? -channel[slot] : channel[slot];
  });
  return rotated(order, zUpToYUp, given);
}

// Of a LightProbe: its nine coefficients of radiance, times its intensity.
export function environmentFromProbe(probe) {
  return Float64Array.from(probe.sh.coefficients.flatMap((v) => [v.x, v.y, v.z]),
    (x) => x * probe.intensity);
}

// As many coefficients as `slots` slots have: higher bands are left out, absent ones are 0.
export function withSlots(environment, slots) {
  const result = new Float32Array(3 * slots);
  if (environment) result.set(Array.prototype.slice.call(environment, 0, 3 * slots));
  return result;
}

// Radiance from a direction.
export function radianceFrom(environment, [x, y, z]) {
  const order = Math.round(Math.sqrt(environment.length / 3)),
    values = new Float64Array((order * (order + 1)) / 2),
    sum = [0, 0, 0],
    phi = Math.atan2(y, x);
  legendre(order, z, Math.hypot(x, y), values);
  for (let l = 0; l < order; ++l) {
    for (let m = -l; m <= l; ++m) {
      const turn = m < 0 ? Math.sin(-m * phi) : Math.cos(m * phi);
      const value = values[(l * (l + 1)) / 2 + Math.abs(m)] * turn;
      for (let c = 0; c < 3; ++c) sum[c] += value * environment[3 * (l * (l + 1) + m) + c];
    }
  }
  return sum;
}

// The same all around as RGBA floats, laid out as equirectangular textures of three.js: row 0 looks
// down, u = 1/2 + atan(z, x) / (2 pi). Radiance below 0, where the sum rings, becomes 0.
export function skyTexels(environment, width, height) {
  const texels = new Float32Array(4 * width * height);
  for (let k = 0; environment && k < width * height; ++k) {
    const phi = 2 * Math.PI * (((k % width) + 0.5) / width - 0.5),
      latitude = Math.PI * ((Math.floor(k / width) + 0.5) / height - 0.5);
    const across = Math.cos(latitude);
    const found = radianceFrom(environment, [
      across * Math.cos(phi),
      Math.sin(latitude),
      across * Math.sin(phi),
    ]);
    found.forEach((value, c) => (texels[4 * k + c] = Math.max(value, 0)));
  }
  return texels;
}
