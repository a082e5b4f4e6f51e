// Shapes as triangle meshes: positions and normals, six floats a vertex, made from formulas.

// A patch f(u, v) over the unit square; normals from differences, outward by `centre(p)`.
function patch(f, columns, rows, inside) {
  const vertices = [],
    indices = [];
  const step = 1e-3;
  for (let j = 0; j <= rows; ++j) {
    for (let i = 0; i <= columns; ++i) {
      const u = i / columns,
        v = Math.min(Math.max(j / rows, 1e-4), 1 - 1e-4);
      const p = f(i / columns, j / rows),
        at = f(u, v);
      const du = sub(f(u + step, v), f(u - step, v));
      const dv = sub(f(u, Math.min(v + step, 1)), f(u, Math.max(v - step, 0)));
      let n = unit(cross(du, dv));
      if (dot(n, sub(at, inside(at, v))) < 0) n = n.map((x) => -x);
      vertices.push(...p, ...n);
    }
  }
  const normal = (k) => vertices.slice(6 * k + 3, 6 * k + 6);
  const position = (k) => vertices.slice(6 * k, 6 * k + 3);
  const triangle = (a, b, c) => {
    const facing = cross(sub(position(b), position(a)), sub(position(c), position(a)));
    const outward = [0, 1, 2].map((k) => normal(a)[k] + normal(b)[k] + normal(c)[k]);
    indices.push(...(dot(facing, outward) < 0 ? [a, c, b] : [a, b, c]));
  };
  for (let j = 0; j < rows; ++j) {
    for (let i = 0; i < columns; ++i) {
      const k = j * (columns + 1) + i;
      triangle(k, k + 1, k + columns + 2);
      triangle(k, k + columns + 2, k + columns + 1);
    }
  }
  return { vertices, indices };
}

function joined(parts) {
  const vertices = [],
    indices = [];
  for (const part of parts) {
    const first = vertices.length / 6;
    for (const x of part.vertices) vertices.push(x);
    for (const i of part.indices) indices.push(first + i);
  }
  return { vertices: new Float32Array(vertices), indices: new Uint32Array(indices) };
}

// Points of a chain of cubic Bezier curves: 3 k + 1 points, t in [0, 1].
function bezier(points, t) {
  const segments = (points.length - 1) / 3;
  const s = Math.min(Math.max(t, 0) * segments, segments * (1 - 1e-9));
  const k = Math.floor(s),
    x = s - k,
    y = 1 - x;
  const weights = [y * y * y, 3 * x * y * y, 3 * x * x * y, x * x * x];
  return [0, 1].map((c) => weights.reduce((sum, w, i) => sum + w * points[3 * k + i][c], 0));
}

function revolved(profile, columns, rows) {
  const surface = (u, v) => {
    const [r, y] = bezier(profile, v);
    return [r * Math.cos(2 * Math.PI * u), y, r * Math.sin(2 * Math.PI * u)];
  };
  // Outward is away from a point further in along the curve's own normal.
  const inside = (p, v) => {
    const [r0, y0] = bezier(profile, Math.max(v - 1e-3, 0));
    const [r1, y1] = bezier(profile, Math.min(v + 1e-3, 1));
    const out = [y1 - y0, -(r1 - r0)];
    const around = Math.hypot(p[0], p[2]) || 1;
    return [p[0] - (out[0] * p[0]) / around, p[1] - out[1], p[2] - (out[0] * p[2]) / around];
  };
  return patch(surface, columns, rows, inside);
}

// A tube about a curve in the plane z = 0, with a radius along it.
function tube(path, radius, columns, rows) {
  const surface = (u, v) => {
    const c = bezier(path, v),
      a = bezier(path, v - 1e-3),
      b = bezier(path, v + 1e-3);
    const along = Math.hypot(b[0] - a[0], b[1] - a[1]);
    const n = [-(b[1] - a[1]) / along, (b[0] - a[0]) / along];
    const x = radius(v) * Math.cos(2 * Math.PI * u),
      z = radius(v) * Math.sin(2 * Math.PI * u);
    return [c[0] + n[0] * x, c[1] + n[1] * x, z];
  };
  return patch(surface, columns, rows, (p, v) => [...bezier(path, v), 0]);
}

function sphereShape() {
  const surface = (u, v) => {
    const theta = Math.PI * v,
      phi = 2 * Math.PI * u;
    return [Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi)];
  };
  const sphere = patch(surface, 128, 96, () => [0, 0, 0]);
  for (let k = 0; k < sphere.vertices.length; k += 6) {
    for (let c = 0; c < 3; ++c) sphere.vertices[k + 3 + c] = sphere.vertices[k + c];
  }
  return { ...joined([sphere]), radius: 1, extent: [1.04, 1.04] };
}

// A pot of our own: a revolved body and lid, a tapered spout, a bow for a handle.
function teapotShape() {
  const body = [
    [0, -0.78],
    [0.3, -0.78],
    [0.5, -0.78],
    [0.6, -0.73],
    [0.86, -0.6],
    [1.04, -0.36],
    [1.04, -0.06],
    [1.04, 0.24],
    [0.86, 0.46],
    [0.62, 0.54],
  ];
  const lid = [
    [0.65, 0.53],
    [0.67, 0.58],
    [0.6, 0.585],
    [0.56, 0.6],
    [0.44, 0.7],
    [0.22, 0.72],
    [0.1, 0.77],
    [0.05, 0.8],
    [0.06, 0.83],
    [0.1, 0.86],
    [0.16, 0.91],
    [0.12, 1],
    [0, 1],
  ];
  const spout = [
    [0.6, -0.3],
    [1.3, -0.34],
    [1.2, 0.28],
    [1.68, 0.52],
  ];
  const handle = [
    [-0.72, 0.4],
    [-1.2, 0.72],
    [-1.72, 0.5],
    [-1.62, 0.06],
    [-1.55, -0.25],
    [-1.25, -0.42],
    [-0.86, -0.42],
  ];
  const shape = joined([
    revolved(body, 128, 72),
    revolved(lid, 96, 72),
    tube(spout, (v) => 0.2 * (1 - v) ** 1.4 + 0.1, 48, 48),
    tube(handle, () => 0.085, 40, 72),
  ]);
  for (let k = 1; k < shape.vertices.length; k += 6) shape.vertices[k] -= 0.08;
  return { ...shape, radius: 1.6, extent: [1.82, 1.16] };
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const unit = (a) => {
  const n = Math.sqrt(dot(a, a)) || 1;
  return a.map((x) => x / n);
};
