const data = JSON.parse(document.getElementById('data').textContent);
const element = (id) => document.getElementById(id);
const radians = (degrees) => (degrees * Math.PI) / 180;
const state = { kind: data.kinds.length - 1, light: 0, hour: 0.5, turn: 0, tilt: 0,
  order: data.order, exposure: 0, camera: 0, orbit: null, spin: false };

// Vectors of the world, where +z is up.
const less = (a, b) => a.map((x, k) => x - b[k]);
const dotted = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
const unit = (a) => a.map((x) => x / Math.hypot(...a));
const crossed = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];

// The eye of the camera, or where the mouse has moved it around the camera's target.
function eyeOf(camera) {
  if (!state.orbit) return camera.position;
  const { azimuth, elevation, distance } = state.orbit;
  const c = Math.cos(elevation);
  return [c * Math.cos(azimuth), c * Math.sin(azimuth), Math.sin(elevation)].map(
    (x, k) => camera.target[k] + distance * x,
  );
}

// World to clip space, by columns.
function matrixOf(camera, eye) {
  const back = unit(less(eye, camera.target)),
    right = unit(crossed(camera.up, back)),
    up = crossed(back, right);
  const slope = 1 / Math.tan(camera.fieldOfView / 2),
    aspect = camera.width / camera.height;
  // The depth range is the scene's, as far as it lies ahead.
  const gap = Math.hypot(...less(eye, data.middle)),
    far = gap + 1.01 * data.radius,
    near = Math.max(gap - 1.01 * data.radius, far * 2e-3);
  const depth = (far + near) / (near - far),
    shift = (2 * far * near) / (near - far);
  const row = (axis, factor) => [...axis.map((x) => factor * x), -factor * dotted(axis, eye)];
  const x = row(right, slope / aspect),
    y = row(up, slope),
    z = row(back, 1);
  const columns = [];
  for (let k = 0; k < 4; ++k)
    columns.push(x[k], y[k], depth * z[k] + (k === 3 ? shift : 0), -z[k]);
  return Float32Array.from(columns);
}

// The coefficients of the chosen light, [slot][R, G, B], turned.
function lightNow() {
  const light = data.lights[state.light];
  let coefficients = light.coefficients;
  if (light.times) {
    const at = state.hour * (light.times.length - 1),
      first = Math.min(Math.floor(at), light.times.length - 2),
      share = at - first;
    const [a, b] = [light.times[first].coefficients, light.times[first + 1].coefficients];
    coefficients = a.map((x, k) => x * (1 - share) + b[k] * share);
  }
  const turned = rotated(data.order, turnAndTilt(radians(state.turn), radians(state.tilt)),
    coefficients);
  return turned.map((x, k) => (k < 3 * state.order ** 2 ? x : 0));
}

const chosen = data.sceneMaterials.map((material) => ({ material,
  albedo: data.materials[material].albedo }));
let renderer = null,
  stale = true,
  wanted = true;

function referenceNow() {
  const light = data.lights[state.light];
  const still = !state.orbit && state.turn === 0 && state.tilt === 0;
  return data.references.find(
    (one) => still && one.light === light.name && one.camera === data.cameras[state.camera].name,
  );
}

function showReference() {
  const found = referenceNow();
  element('reference').hidden = !found;
  if (found) element('reference').src = found.picture;
  element('referenceNote').textContent = found
    ? `Path tracing. ${found.note}`
    : data.references.length > 0
      ? 'No reference for this light and view.'
      : '';
  element('referenceFigure').hidden = data.references.length === 0;
}

const frames = [];
function draw(now) {
  requestAnimationFrame(draw);
  if (state.spin) {
    state.turn = ((now / 20 + 180) % 360) - 180;
    element('turn').value = state.turn;
    stale = wanted = true;
  }
  if (!wanted) return;
  wanted = state.spin;
  if (stale) renderer.illuminate(lightNow(), state.kind);
  stale = false;
  const camera = data.cameras[state.camera],
    eye = eyeOf(camera);
  const exposure = 2 ** state.exposure;
  renderer.draw({ camera: matrixOf(camera, eye), eye, exposure }, chosen);
  frames.push(performance.now());
  if (frames.length > 61) frames.shift();
  if (state.spin && frames.length > 2)
    element('rate').textContent =
      `${Math.round((1000 * (frames.length - 1)) / (frames.at(-1) - frames[0]))} frames a second`;
}

function changed(what) {
  wanted = true;
  stale = stale || what !== 'view';
  const light = data.lights[state.light];
  element('dayRow').hidden = !light.times;
  if (light.times) {
    const at = Math.round(state.hour * (light.times.length - 1));
    element('hourText').textContent = light.times[at].name;
  }
  element('turnText').textContent = `${Math.round(state.turn)}\u00b0`;
  element('tiltText').textContent = `${Math.round(state.tilt)}\u00b0`;
  element('orderText').textContent = state.order;
  element('exposureText').textContent = `${state.exposure.toFixed(1)} stops`;
  showReference();
}

function options(id, names, use) {
  names.forEach((name, k) => element(id).add(new Option(name, k)));
  element(id).addEventListener('change', () => use(Number(element(id).value)));
}

function slider(id, use, what) {
  element(id).addEventListener('input', () => {
    use(Number(element(id).value));
    changed(what);
  });
}

const toHex = (albedo) =>
  `#${albedo.map((x) => Math.round(255 * Math.max(0, Math.min(1, x)) ** (1 / 2.2))
    .toString(16).padStart(2, '0')).join('')}`;
const fromHex = (text) => [1, 3, 5].map((k) => (parseInt(text.slice(k, k + 2), 16) / 255) ** 2.2);

function materialControls() {
  data.sceneMaterials.forEach((material, slot) => {
    const row = document.createElement('div'),
      list = document.createElement('select'),
      colour = document.createElement('input');
    row.className = 'material';
    row.append(data.materials[material].name, list, colour);
    data.materials.forEach(({ name }, k) => list.add(new Option(name, k)));
    list.value = material;
    list.setAttribute('aria-label', `Material in place of ${data.materials[material].name}`);
    colour.type = 'color';
    colour.setAttribute('aria-label', `Albedo of ${data.materials[material].name}`);
    const show = () => {
      colour.value = toHex(chosen[slot].albedo);
      colour.disabled = renderer.rows[chosen[slot].material] >= 0;
      changed('view');
    };
    list.addEventListener('change', () => {
      const k = Number(list.value);
      chosen[slot] = { material: k, albedo: data.materials[k].albedo };
      show();
    });
    colour.addEventListener('input', () => {
      chosen[slot].albedo = fromHex(colour.value);
      changed('view');
    });
    element('materials').append(row);
    show();
  });
}

function turnCamera(dx, dy) {
  const camera = data.cameras[state.camera];
  if (!state.orbit) {
    const gap = less(camera.position, camera.target),
      distance = Math.hypot(...gap);
    state.orbit = { azimuth: Math.atan2(gap[1], gap[0]), elevation: Math.asin(gap[2] / distance),
      distance };
  }
  state.orbit.azimuth -= dx;
  state.orbit.elevation = Math.max(-1.55, Math.min(1.55, state.orbit.elevation + dy));
  changed('view');
}

function turnLight(dx, dy) {
  state.turn = ((state.turn + dx + 540) % 360) - 180;
  state.tilt = Math.max(-90, Math.min(90, state.tilt + dy));
  element('turn').value = state.turn;
  element('tilt').value = state.tilt;
  changed('light');
}

function mouse(canvas) {
  let last = null;
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('pointerdown', (event) => {
    last = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!last || event.buttons === 0) return;
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    last = [event.clientX, event.clientY];
    if (event.shiftKey || event.buttons === 2) turnLight(dx / 2, dy / 2);
    else turnCamera(dx / 150, dy / 150);
  });
  const zoom = (factor) => {
    turnCamera(0, 0);
    state.orbit.distance *= factor;
  };
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.exp(event.deltaY / 800));
  }, { passive: false });
  canvas.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, 0.05],
      ArrowDown: [0, -0.05] }[event.key];
    if (step) turnCamera(-step[0], step[1]);
    else if (event.key === '+') zoom(0.9);
    else if (event.key === '-') zoom(1 / 0.9);
    else return;
    event.preventDefault();
  });
}

function useLight(k) {
  state.light = k;
  const found = referenceNow();
  state.exposure = found ? found.stops : data.lights[k].stops;
  element('exposure').value = state.exposure;
  changed('light');
}

function useCamera(k) {
  state.camera = k;
  state.orbit = null;
  const camera = data.cameras[k],
    canvas = element('canvas');
  canvas.width = camera.width;
  canvas.height = camera.height;
  canvas.style.aspectRatio = `${camera.width} / ${camera.height}`;
  changed('view');
}

function start() {
  try {
    renderer = new Renderer(element('canvas'), data);
  } catch (error) {
    element('message').textContent = error.message;
    element('message').hidden = false;
    return;
  }
  options('light', data.lights.map(({ name }) => name), useLight);
  options('kind', data.kinds.map(({ name }) => name), (k) => {
    state.kind = k;
    changed('light');
  });
  element('kind').value = state.kind;
  options('camera', data.cameras.map(({ name }) => name), useCamera);
  slider('hour', (x) => (state.hour = x / 1000), 'light');
  slider('turn', (x) => (state.turn = x), 'light');
  slider('tilt', (x) => (state.tilt = x), 'light');
  slider('order', (x) => (state.order = x), 'light');
  slider('exposure', (x) => (state.exposure = x), 'view');
  element('spin').addEventListener('change', () => {
    state.spin = element('spin').checked;
    frames.length = 0;
    changed('light');
  });
  useCamera(0);
  materialControls();
  useLight(0);
  mouse(element('canvas'));
  window.transferPage = { data, state, renderer, chosen, frames, changed };
  requestAnimationFrame(draw);
}
start();
