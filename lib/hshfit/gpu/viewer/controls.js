// The page: state, controls, camera, panes, numbers.

const element = (id) => document.getElementById(id);
const radio = (name) => document.querySelector(`input[name=${name}]:checked`).value;

// What `#key=value&…` behind the address sets, so that a view can be kept or sent.
function stateFromAddress(state) {
  for (const [key, text] of new URLSearchParams(location.hash.slice(1))) {
    if (!(key in state)) continue;
    const old = state[key];
    if (typeof old === 'number' && text !== '' && Number.isFinite(+text)) state[key] = +text;
    else if (typeof old === 'boolean') state[key] = text === 'true' || text === '1';
    else if (typeof old === 'string') state[key] = text;
    if (key === 'exposure') state.exposureSet = true;
    if (key === 'scale') state.scaleSet = true;
  }
  return state;
}

function significant(x, digits = 3) {
  if (x === 0) return '0';
  return Math.abs(x) >= 1e-3 && Math.abs(x) < 1e4
    ? String(+x.toPrecision(digits))
    : x.toExponential(digits - 1);
}

class Viewer {
  constructor(data) {
    this.data = data;
    this.canvas = element('canvas');
    this.renderer = new Renderer(this.canvas, data);
    const [image] = this.renderer.images;
    this.state = stateFromAddress({
      order: data.order,
      shape: 'sphere',
      lighting: 'both',
      layout: 'panes',
      clamp: true,
      intensity: 0,
      sky: 0,
      skyTurn: 0,
      skyTilt: 0,
      exposure: 0,
      exposureSet: false,
      pair: 0,
      scale: -1,
      scaleSet: false,
      azimuth: 15,
      elevation: 12,
      distance: 1,
      lightAzimuth: -30,
      lightElevation: 32,
      dividers: '25,50,75',
      frames: 32,
      cycles: 8,
    });
    this.autoExposure = !this.state.exposureSet;
    this.exposureWanted = this.autoExposure;
    this.pairs = this.makePairs();
    this.state.order = Math.min(Math.max(Math.round(this.state.order), 1), data.order);
    this.dividers = this.state.dividers.split(',').map((x) => +x / 100);
    this.numbers = null;
    this.settled = false;
    this.scheduled = false;
    this.last = image;
    this.bind();
    this.changed();
  }

  // The pairs whose difference can be shown: every other picture against the exact one, and the
  // first two of them.
  makePairs() {
    const images = this.renderer.images,
      exact = images.find((image) => image.exact);
    const others = images.filter((image) => !image.exact);
    const pairs = exact ? others.map((image) => [image, exact]) : [];
    if (others.length > 1) pairs.push([others[0], others[1]]);
    const select = element('pair');
    pairs.forEach(([a, b], i) => select.add(new Option(`${a.name} − ${b.name}`, i)));
    select.disabled = pairs.length === 0;
    this.state.pair = Math.min(Math.max(this.state.pair | 0, 0), Math.max(pairs.length - 1, 0));
    return pairs;
  }

  bind() {
    const redraw = (key, id = key) => {
      element(id).addEventListener('input', (event) => {
        this.state[key] =
          event.target.type === 'checkbox' ? event.target.checked : +event.target.value;
        if (key === 'exposure') this.autoExposure = false;
        if (key === 'scale') this.state.scaleSet = true;
        if (key.startsWith('skyT')) this.showLight();
        if (['exposure', 'scale', 'pair'].includes(key)) this.shown();
        else this.changed();
      });
    };
    ['order', 'clamp', 'intensity', 'skyTurn', 'skyTilt', 'exposure', 'scale', 'pair'].forEach((key) =>
      redraw(key),
    );
    for (const key of ['shape', 'lighting', 'layout']) {
      document.querySelectorAll(`input[name=${key}]`).forEach((input) => {
        input.checked = input.value === this.state[key];
        input.addEventListener('change', () => {
          this.state[key] = radio(key);
          if (key !== 'layout') this.exposureWanted = this.autoExposure;
          this.changed();
        });
      });
    }
    element('autoExposure').addEventListener('click', () => {
      this.autoExposure = this.exposureWanted = true;
      this.shown();
    });
    element('autoScale').addEventListener('click', () => {
      this.state.scaleSet = false;
      this.shown();
    });
    element('controls').addEventListener('submit', (event) => event.preventDefault());
    new ResizeObserver(() => this.changed()).observe(element('stage'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.shown());
    this.canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      showMessage('The graphics device was reset. Reload the page to go on.');
    });
    bindCamera(this);
    this.bindLight();
  }

  // Something that every picture depends on.
  changed() {
    this.renderer.restart();
    this.measured = -1;
    this.lastChange = performance.now();
    this.settled = false;
    this.schedule();
  }

  // Something that only their display depends on.
  shown() {
    this.schedule();
  }

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.update();
    });
  }

  update() {
    const { renderer, state } = this;
    this.arrange();
    if (!this.panes) return;
    this.chooseSize();
    const scene = this.scene();
    const frames = state.frames * (scene.environmentStrength > 0 ? Math.max(state.cycles, 1) : 1);
    if (renderer.frame < frames) renderer.step(scene, state.frames);
    if (this.exposureWanted) this.setExposure();
    const done = renderer.frame >= frames;
    const due = done || !this.numbers || renderer.frame % 16 === 0;
    if (due && this.measured !== renderer.frame) this.measure();
    renderer.show(this.panes, this.look());
    element('rendering').hidden = true;
    this.writeTexts(done ? '' : `averaging, frame ${renderer.frame} of ${frames}`);
    this.settled = done && !this.coarse;
    if (!this.settled) this.schedule();
  }

  // Half the size while something moves, where whole frames take longer than 70 ms.
  chooseSize() {
    const now = performance.now(),
      [pane] = this.panes;
    if (!this.coarse && !this.settled && this.renderer.frame > 1) {
      this.slow = now - this.lastUpdate > 70;
    }
    this.lastUpdate = now;
    this.coarse = Boolean(this.slow && this.numbers) && now - this.lastChange < 300;
    const scale = this.coarse ? 0.5 : 1,
      { frame } = this.renderer;
    this.renderer.resize(Math.round(pane.width * scale), Math.round(pane.height * scale));
    if (this.renderer.frame !== frame) this.measured = -1;
  }

  scene() {
    const { state, renderer } = this,
      rad = Math.PI / 180;
    const around = (azimuth, elevation) => [
      Math.cos(elevation * rad) * Math.sin(azimuth * rad),
      Math.sin(elevation * rad),
      Math.cos(elevation * rad) * Math.cos(azimuth * rad),
    ];
    const { radius, extent } = renderer.shapes[state.shape];
    const towards = around(state.azimuth, state.elevation),
      aspect = renderer.width / renderer.height;
    // The shape fills 86 % of the pane, one way or the other.
    const half = 15 * rad;
    const reach =
      (Math.max(extent[0] / aspect, extent[1]) / Math.tan(half) / 0.86) * state.distance;
    const lightDistance = 3.2 * radius,
      strength = 2 ** state.intensity;
    return {
      shape: state.shape,
      order: state.order,
      clamp: state.clamp,
      sky: state.sky,
      skyTurn: state.skyTurn * rad,
      skyTilt: state.skyTilt * rad,
      eye: towards.map((x) => x * reach),
      camera: lookAt(towards, reach, half, aspect, radius),
      light: around(state.lightAzimuth, state.lightElevation).map((x) => x * lightDistance),
      lightDistance,
      pointStrength: state.lighting === 'sky' ? 0 : strength,
      environmentStrength: state.lighting === 'point' ? 0 : strength,
    };
  }

  look() {
    const paper = getComputedStyle(element('stage'))
      .backgroundColor.match(/[\d.]+/g)
      .slice(0, 3);
    return {
      paper: paper.map((x) => x / 255),
      exposure: 2 ** this.state.exposure,
      scale: 10 ** this.state.scale,
      showNegative: !this.state.clamp,
    };
  }

  // The exposure at which 99 % of the surface is at or below 0.8 of white.
  setExposure() {
    const pixels = this.renderer.read(this.renderer.images[0]),
      found = [];
    for (let k = 0; k < pixels.length; k += 4) {
      if (pixels[k + 3] > 0.5) found.push(Math.max(pixels[k], pixels[k + 1], pixels[k + 2]));
    }
    found.sort((a, b) => a - b);
    const high = found[Math.floor(0.99 * (found.length - 1))];
    const stops = high > 0 ? Math.log2(0.8 / high) : 0;
    this.state.exposure = Math.round(10 * Math.min(Math.max(stops, -10), 10)) / 10;
    this.exposureWanted = false;
  }

  // Largest and mean difference of every pair over the pixels on the shape; their share below 0.
  measure() {
    this.measured = this.renderer.frame;
    const pictures = new Map(
      this.renderer.images.map((image) => [image, this.renderer.read(image)]),
    );
    this.numbers = this.pairs.map(([a, b]) => compared(pictures.get(a), pictures.get(b)));
    this.negative = new Map([...pictures].map(([image, pixels]) => [image, negativeShare(pixels)]));
  }

  writeTexts(progress) {
    const { state } = this;
    const text = (id, value) => {
      if (element(id).textContent !== value) element(id).textContent = value;
    };
    for (const key of ['order', 'intensity', 'skyTurn', 'skyTilt', 'exposure', 'scale', 'pair']) {
      element(key).value = state[key];
    }
    element('clamp').checked = state.clamp;
    element('negativeNote').hidden = state.clamp;
    const signed = (x) => `${x < 0 ? '−' : '+'}${Math.abs(x).toFixed(1)}`;
    text('orderText', `${state.order}, ${state.order ** 2} coefficients`);
    text('intensityText', `× ${significant(2 ** state.intensity)}`);
    text('skyTurnText', `${Math.round(state.skyTurn)}°`);
    text('skyTiltText', `${Math.round(state.skyTilt)}°`);
    text('exposureText', `${signed(state.exposure)} stops`);
    const factor = 2 ** state.exposure;
    const row = this.numbers?.[state.pair];
    if (row && !state.scaleSet) {
      state.scale = Math.round(10 * Math.log10(Math.max(row.high * factor, 1e-4))) / 10;
      element('scale').value = state.scale;
      this.renderer.show(this.panes, this.look());
    }
    text('scaleText', significant(10 ** state.scale, 2));
    document.querySelectorAll('.legend span').forEach((span) => {
      const s = significant(10 ** state.scale, 2);
      span.replaceChildren(
        ...[`−${s}`, '0', `+${s}`].map((x) => {
          const b = document.createElement('b');
          b.style.fontWeight = 400;
          b.textContent = x;
          return b;
        }),
      );
    });
    text('progress', progress);
    if (this.numbers) writeNumbers(this, factor);
  }
}

function compared(a, b) {
  let largest = 0,
    sum = 0,
    squares = 0,
    reference = 0,
    count = 0;
  const all = [];
  for (let k = 0; k < a.length; k += 4) {
    if (!(b[k + 3] > 0)) continue;
    let most = 0;
    for (let c = k; c < k + 3; ++c) {
      const difference = Math.abs(a[c] - b[c]);
      most = Math.max(most, difference);
      sum += difference / 3;
      squares += difference * difference;
      reference += b[c] * b[c];
    }
    largest = Math.max(largest, most);
    all.push(most);
    ++count;
  }
  all.sort((x, y) => x - y);
  return {
    largest,
    mean: count ? sum / count : 0,
    high: all[Math.floor(0.995 * (count - 1))] ?? 0,
    relative: reference > 0 ? Math.sqrt(squares / reference) : NaN,
  };
}

function negativeShare(pixels) {
  let below = 0,
    count = 0;
  for (let k = 0; k < pixels.length; k += 4) {
    if (!(pixels[k + 3] > 0)) continue;
    ++count;
    if (Math.min(pixels[k], pixels[k + 1], pixels[k + 2]) < 0) ++below;
  }
  return count ? below / count : 0;
}

function writeNumbers(viewer, factor) {
  const cells = (tag, values) => {
    const row = document.createElement('tr');
    values.forEach((value, i) => {
      const cell = document.createElement(i === 0 ? 'th' : tag);
      cell.textContent = value;
      if (i === 0) cell.scope = 'row';
      row.append(cell);
    });
    return row;
  };
  const table = element('numbers');
  const open = !viewer.state.clamp;
  table.tHead.replaceChildren(
    cells('th', ['', 'max', 'mean', 'r.m.s.', ...(open ? ['below 0'] : [])]),
  );
  table.tBodies[0].replaceChildren(
    ...viewer.pairs.map(([a, b], i) => {
      const { largest, mean, relative } = viewer.numbers[i];
      return cells('td', [
        `${a.name} − ${b.name}`,
        significant(largest * factor),
        significant(mean * factor, 2),
        Number.isFinite(relative) ? `${significant(100 * relative)} %` : '–',
        ...(open ? [`${significant(100 * viewer.negative.get(a))} %`] : []),
      ]);
    }),
  );
}
