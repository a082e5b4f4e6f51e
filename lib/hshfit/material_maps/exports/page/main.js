const data = JSON.parse(document.getElementById('data').textContent);
const element = (id) => document.getElementById(id);
const radians = (degrees) => (degrees * Math.PI) / 180;
const state = { shape: 0, repeats: 1, automatic: true, level: 0, coloured: false, azimuth: 60,
  elevation: 50, lamp: 8, light: 0, turn: 0, share: 0.5, exposure: 0,
  view: { azimuth: -90, elevation: 55, distance: 3.2 } };
const canvas = element('canvas');
const slope = Math.tan(radians(20));

const unit = (a) => a.map((x) => x / Math.hypot(...a));
const crossed = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const towards = (azimuth, elevation, distance) => [
  distance * Math.cos(radians(elevation)) * Math.cos(radians(azimuth)),
  distance * Math.cos(radians(elevation)) * Math.sin(radians(azimuth)),
  distance * Math.sin(radians(elevation)),
];

// Half the sides of the plane: the longer one is 1.
function halvesOf() {
  const [{ width, height }] = data.levels;
  return [Math.min(1, width / height), Math.min(1, height / width)];
}

// The environment, turned about the vertical.
function environmentNow() {
  const c = Math.cos(radians(state.turn)), s = Math.sin(radians(state.turn));
  const turned = rotated(data.order, [c, -s, 0, s, c, 0, 0, 0, 1],
    data.lights[state.light].coefficients);
  return Float32Array.from(turned, (x) => x * state.share);
}

function uniformsNow() {
  const { azimuth, elevation, distance } = state.view;
  const eye = towards(azimuth, elevation, distance), back = unit(eye);
  const right = [-Math.sin(radians(azimuth)), Math.cos(radians(azimuth)), 0];
  return {
    size: [canvas.width, canvas.height],
    halves: halvesOf(),
    eye,
    right,
    up: crossed(back, right),
    back,
    lamp: towards(state.azimuth, state.elevation, 2),
    ...(data.lights.length ? { environment: environmentNow() } : { fill: state.share }),
    slope,
    lampStrength: state.lamp,
    exposure: state.exposure,
    fixedLevel: state.level,
    repeats: state.repeats,
    shape: { whole: state.shape },
    automatic: { whole: state.automatic ? 1 : 0 },
    coloured: { whole: state.coloured ? 1 : 0 },
  };
}

let renderer = null, waiting = false;
function drawNow() {
  waiting = false;
  renderer.draw(uniformsNow());
  // In the middle of the plane, seen from above.
  const texels = (2 * state.view.distance * slope / canvas.height) / 2
    * Math.max(data.levels[0].width, data.levels[0].height) * state.repeats;
  element('levels').textContent = `A pixel is ${texels.toPrecision(2)} texels wide.`;
}
function draw() {
  if (!renderer || waiting) return;
  waiting = true;
  requestAnimationFrame(drawNow);
}

function show() {
  const words = { repeats: state.repeats, level: state.level.toFixed(1),
    azimuth: `${state.azimuth}°`, elevation: `${state.elevation}°`, lamp: state.lamp.toFixed(1),
    turn: `${state.turn}°`, share: state.share.toFixed(2), exposure: state.exposure.toFixed(1) };
  for (const [id, text] of Object.entries(words)) {
    if (!element(id)) continue;
    element(id).value = state[id];
    element(`${id}Text`).textContent = text;
  }
  element('shape').value = state.shape;
  if (element('light')) element('light').value = state.light;
  element('automatic').checked = state.automatic;
  element('coloured').checked = state.coloured;
  element('level').disabled = state.automatic;
  draw();
}

function resize() {
  const scale = window.devicePixelRatio || 1;
  canvas.width = Math.max(1, Math.round(canvas.clientWidth * scale));
  canvas.height = Math.max(1, Math.round(canvas.clientHeight * scale));
  draw();
}

function move(dx, dy, lamp) {
  const limit = (value, low, high) => Math.min(high, Math.max(low, value));
  const around = (angle) => ((angle + 540) % 360) - 180;
  if (lamp) {
    state.azimuth = Math.round(around(state.azimuth + dx));
    state.elevation = Math.round(limit(state.elevation - dy, 5, 90));
  } else {
    state.view.azimuth = around(state.view.azimuth - dx);
    state.view.elevation = limit(state.view.elevation + dy, state.shape === 0 ? 2 : -89, 89);
  }
  show();
}

function zoom(steps) {
  state.view.distance = Math.min(60, Math.max(1.2, state.view.distance * 1.1 ** steps));
  show();
}

function listen() {
  for (const id of ['repeats', 'level', 'azimuth', 'elevation', 'lamp', 'turn', 'share', 'exposure',
    'shape', 'light']) {
    element(id)?.addEventListener('input', (event) => {
      state[id] = Number(event.target.value);
      show();
    });
  }
  for (const id of ['automatic', 'coloured']) {
    element(id).addEventListener('change', (event) => {
      state[id] = event.target.checked;
      show();
    });
  }
  let held = null;
  canvas.addEventListener('pointerdown', (event) => {
    held = { x: event.clientX, y: event.clientY, lamp: event.shiftKey || event.button === 2 };
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    if (!held) return;
    move(0.4 * (event.clientX - held.x), 0.4 * (event.clientY - held.y), held.lamp);
    held.x = event.clientX;
    held.y = event.clientY;
  });
  canvas.addEventListener('pointerup', () => (held = null));
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    zoom(Math.sign(event.deltaY));
  }, { passive: false });
  canvas.addEventListener('keydown', (event) => {
    const step = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, -5], ArrowDown: [0, 5] };
    if (step[event.key]) move(...step[event.key], event.shiftKey);
    else if (event.key === '+') zoom(-1);
    else if (event.key === '-') zoom(1);
    else return;
    event.preventDefault();
  });
  window.addEventListener('resize', resize);
}

data.lights.forEach((light, k) => element('light')?.add(new Option(light.name, k)));
try {
  renderer = new MapRenderer(canvas, data);
  listen();
  resize();
  show();
} catch (error) {
  element('message').textContent = error.message;
  element('message').hidden = false;
}
// For tests: values of the shader, and pictures of a state.
window.mapPage = {
  state,
  data,
  draw: () => { show(); drawNow(); },
  check: () => renderer.check(data.tests),
};
