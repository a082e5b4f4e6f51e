// The environment and its spherical harmonics.

// [direction, colour, power]: a soft studio. `order` bands hold it exactly.
function studio(order) {
  const narrow = order - 1;
  return [
    [[0, 1, 0], [0.05, 0.05, 0.06], 0], // from everywhere
    [[0, 1, 0], [0.28, 0.33, 0.42], 1], // sky
    [[-0.62, 0.55, 0.56], [3.2, 3.0, 2.7], narrow], // key
    [[0.9, 0.25, 0.35], [0.9, 1.05, 1.3], narrow], // cool rim
    [[0.1, 0.35, -0.93], [1.6, 1.45, 1.2], narrow], // behind
    [[0.25, -0.8, 0.55], [0.22, 0.18, 0.14], Math.min(2, narrow)], // floor
  ].map(([axis, colour, power]) => ({ axis: unit(axis), colour, power }));
}

// 2 pi times the integral of ((1 + t)/2)^power P_l(t), l < order (Funk-Hecke), by the ratio
// a_{l+1}/a_l = (power - l)/(power + l + 2).
function zonal(power, order) {
  const a = [(4 * Math.PI) / (power + 1)];
  for (let l = 0; l + 1 < order; ++l) a.push((a[l] * (power - l)) / (power + l + 2));
  return a;
}

// GLSL: adds a light's SH coefficients, unrolled. Slot l (l + 1) + m, orthonormal over the sphere;
// odd m take `sign`.
function skySource(order, sign) {
  const lines = [
    `void addLight(vec3 d, vec3 colour, int first, inout vec3 sky[${order * order}]) {`,
    '    float p, q, r, c = 1.0, s = 0.0;',
  ];
  const number = (x) => x.toExponential(12).replace('e+', 'e');
  const factor = (l, m) => Math.sqrt((4 * l * l - 1) / (l * l - m * m));
  let start = Math.sqrt(1 / (4 * Math.PI));
  for (let m = 0; m < order; ++m) {
    if (m > 0) {
      start *= Math.sqrt((2 * m + 1) / (2 * m));
      lines.push('    p = c; c = d.x * c - d.y * s; s = d.x * s + d.y * p;');
    }
    const scale = m > 0 ? Math.SQRT2 * (m % 2 ? sign : 1) : 1;
    lines.push(`    r = 0.0; q = ${number(start * scale)};`);
    for (let l = m; l < order; ++l) {
      if (l > m) {
        const b = l > m + 1 ? factor(l, m) / factor(l - 1, m) : 0;
        lines.push(`    p = q; q = ${number(factor(l, m))} * d.z * q - ${number(b)} * r; r = p;`);
      }
      const light = `colour * (skyZonal[first + ${l}] * q`;
      lines.push(`    sky[${l * (l + 1) + m}] += ${light}${m > 0 ? ' * c' : ''});`);
      if (m > 0) lines.push(`    sky[${l * (l + 1) - m}] += ${light} * s);`);
    }
  }
  return lines.join('\n') + '\n}\n';
}

// `lights` turned about the vertical axis.
function turnedSky(lights, angle) {
  const c = Math.cos(angle),
    s = Math.sin(angle);
  return lights.map(({ axis, colour, power }) => ({
    axis: [c * axis[0] + s * axis[2], axis[1], c * axis[2] - s * axis[0]],
    colour,
    power,
  }));
}
