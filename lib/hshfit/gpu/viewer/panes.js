// Where the pictures go, what lies over them, and the camera.

const exactName = 'Exact';

Object.assign(Viewer.prototype, {
  // Sizes the canvas and places panes and labels: four panes, or one picture cut by dividers.
  arrange() {
    const stage = element('stage'),
      ratio = Math.min(devicePixelRatio || 1, 2);
    const width = Math.round(stage.clientWidth * ratio),
      height = Math.round(stage.clientHeight * ratio);
    const key = [width, height, this.state.layout].join();
    if (key === this.arranged || width < 8 || height < 8) return;
    this.arranged = key;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    const split = this.state.layout === 'split';
    this.split = split;
    const gap = split ? 0 : Math.round(2 * ratio);
    const paneWidth = split ? width : Math.floor((width - gap) / 2);
    const paneHeight = split ? height : Math.floor((height - gap) / 2);
    this.panes = this.contents().map((content, i) => ({
      ...content,
      get first() {
        return content.first?.();
      },
      get second() {
        return content.second?.();
      },
      x: split || i % 2 === 0 ? 0 : width - paneWidth,
      y: split || i >= 2 ? 0 : height - paneHeight,
      width: paneWidth,
      height: paneHeight,
      clip: null,
    }));
    this.pixelRatio = ratio;
    this.makeLabels();
    this.cut();
    this.placeSun();
  },

  // Exact, the form or the first fit, the next fit, difference, whether or not there is one.
  contents() {
    const images = this.renderer.images;
    const exact = images.find((image) => image.exact),
      others = images.filter((image) => !image.exact);
    const pair = () => this.pairs[this.state.pair],
      { details } = this.data;
    return [
      { name: exactName, first: () => exact, why: this.data.exact.absent },
      { name: others[0].name, detail: details[0], first: () => others[0] },
      others[1]
        ? { name: others[1].name, detail: details[1], first: () => others[1] }
        : { name: 'Second basis', why: 'This page has one basis only.' },
      {
        name: 'Difference',
        first: () => pair()?.[0],
        second: () => pair()?.[1],
        why: 'There is nothing to compare with.',
      },
    ];
  },

  makeLabels() {
    const make = (className, text = '') => {
      const box = document.createElement('div');
      box.className = className;
      box.textContent = text;
      return box;
    };
    this.tags = this.panes.map((pane) => make('label', pane.name));
    this.panes.forEach(({ detail }, i) => {
      if (detail) this.tags[i].append(make('detail', detail));
    });
    this.absences = this.panes.map((pane) => make('absent', pane.first ? '' : pane.why));
    this.legend = make('legend');
    this.legend.append(document.createElement('i'), document.createElement('span'));
    this.legend.hidden = !this.panes[3].first;
    this.handles = this.split ? this.dividers.map((_, i) => makeDivider(this, i)) : [];
    const rules = this.split ? [] : [make('rule'), make('rule')];
    const [first] = this.panes,
      ratio = this.pixelRatio;
    if (rules.length) {
      Object.assign(rules[0].style, {
        left: 0,
        width: '100%',
        top: `${first.height / ratio}px`,
        height: '2px',
      });
      Object.assign(rules[1].style, {
        top: 0,
        height: '100%',
        left: `${first.width / ratio}px`,
        width: '2px',
      });
    }
    this.sun ??= makeSun(this);
    element('overlay').replaceChildren(
      ...rules,
      ...this.absences,
      ...this.tags,
      this.legend,
      ...this.handles,
      this.sun,
    );
  },

  // Cuts the split picture at the dividers, and puts labels where the panes are.
  cut() {
    const { width, height } = this.canvas,
      ratio = this.pixelRatio;
    const cuts = [0, ...this.dividers.map((x) => Math.round(x * width)), width];
    this.panes.forEach((pane, i) => {
      if (this.split) pane.clip = [cuts[i], cuts[i + 1]];
      const [left, right] = (pane.clip ?? [pane.x, pane.x + pane.width]).map((x) => x / ratio);
      const top = (height - pane.y - pane.height) / ratio;
      const place = (box, style) => Object.assign(box.style, style);
      place(this.tags[i], {
        left: `${left + 10}px`,
        top: `${top + 10}px`,
        maxWidth: `${Math.max(right - left - 18, 0)}px`,
      });
      this.tags[i].hidden = right - left < 30;
      place(this.absences[i], {
        left: `${left}px`,
        top: `${top}px`,
        width: `${right - left}px`,
        height: `${pane.height / ratio}px`,
      });
      this.absences[i].hidden = Boolean(pane.first) || right - left < 30;
      if (i === 3) {
        place(this.legend, {
          left: `${left + 10}px`,
          top: `${(height - pane.y) / ratio - 50}px`,
          maxWidth: `${Math.max(right - left - 18, 0)}px`,
        });
      }
    });
    this.handles.forEach((handle, i) => {
      handle.style.left = `${(this.dividers[i] * width) / ratio}px`;
      handle.setAttribute('aria-valuenow', Math.round(100 * this.dividers[i]));
    });
  },

  // The light as a disc over the first pane: its direction seen along the line of sight.
  placeSun() {
    const pane = this.panes[0],
      ratio = this.pixelRatio;
    const d = this.lightInView(),
      reach = (0.44 * Math.min(pane.width, pane.height)) / ratio;
    this.sun.style.left = `${(pane.x + pane.width / 2) / ratio + reach * d[0]}px`;
    const middle = (this.canvas.height - pane.y - pane.height / 2) / ratio;
    this.sun.style.top = `${middle - reach * d[1]}px`;
    this.sun.classList.toggle('behind', d[2] < 0);
    this.sun.hidden = this.state.lighting === 'sky';
    this.sunReach = reach;
  },

  viewFrame() {
    const rad = Math.PI / 180,
      a = this.state.azimuth * rad,
      e = this.state.elevation * rad;
    const z = [Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)];
    const x = [Math.cos(a), 0, -Math.sin(a)];
    return [x, cross(z, x), z];
  },

  lightInView() {
    const rad = Math.PI / 180,
      a = this.state.lightAzimuth * rad,
      e = this.state.lightElevation * rad;
    const d = [Math.cos(e) * Math.sin(a), Math.sin(e), Math.cos(e) * Math.cos(a)];
    return this.viewFrame().map((axis) => dot(axis, d));
  },

  setLightInView(x, y, front) {
    const radius = Math.hypot(x, y),
      s = radius > 1 ? 1 / radius : 1;
    const z = Math.sqrt(Math.max(0, 1 - Math.min(radius, 1) ** 2)) * (front ? 1 : -1);
    const frame = this.viewFrame(),
      at = [x * s, y * s, z];
    const d = [0, 1, 2].map((c) => frame.reduce((sum, axis, i) => sum + axis[c] * at[i], 0));
    this.state.lightAzimuth = (Math.atan2(d[0], d[2]) * 180) / Math.PI;
    this.state.lightElevation = (Math.asin(Math.min(Math.max(d[1], -1), 1)) * 180) / Math.PI;
    this.placeSun();
    this.changed();
  },

  turn(dx, dy) {
    this.state.azimuth = (this.state.azimuth + dx) % 360;
    this.state.elevation = Math.min(Math.max(this.state.elevation + dy, -88), 88);
    this.placeSun();
    this.changed();
  },

  zoom(factor) {
    this.state.distance = Math.min(Math.max(this.state.distance * factor, 0.4), 3);
    this.changed();
  },
});

// A perspective of `half` angle above and below the axis, from `reach` along `towards`.
function lookAt(towards, reach, half, aspect, radius) {
  const x = unit(cross([0, 1, 0], towards)),
    y = cross(towards, x);
  const near = Math.max(reach - 2 * radius, 0.05),
    far = reach + 2 * radius;
  const scale = 1 / Math.tan(half),
    a = (near + far) / (near - far),
    b = (2 * near * far) / (near - far);
  const rows = [x.map((v) => (v * scale) / aspect), y.map((v) => v * scale), towards];
  const columns = [];
  for (let c = 0; c < 3; ++c) columns.push(rows[0][c], rows[1][c], a * rows[2][c], -rows[2][c]);
  return [...columns, 0, 0, -a * reach + b, reach];
}

const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function bindCamera(viewer) {
  const canvas = viewer.canvas,
    pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('pointermove', (event) => {
    const old = pointers.get(event.pointerId);
    if (!old) return;
    const before = pointers.size === 2 ? spread() : 0;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 2) viewer.zoom(before / Math.max(spread(), 1));
    else if (event.shiftKey || event.buttons & 2) {
      viewer.turnSky(0.5 * (event.clientX - old.x), 0.5 * (event.clientY - old.y));
    } else viewer.turn(-0.4 * (event.clientX - old.x), 0.4 * (event.clientY - old.y));
  });
  for (const kind of ['pointerup', 'pointercancel']) {
    canvas.addEventListener(kind, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      viewer.zoom(Math.exp(0.0012 * event.deltaY));
    },
    { passive: false },
  );
  canvas.addEventListener('keydown', (event) => {
    const arrow = arrows[event.key];
    if (arrow && event.shiftKey) viewer.turnSky(5 * arrow[0], -5 * arrow[1]);
    else if (arrow) viewer.turn(5 * arrow[0], 5 * arrow[1]);
    else if (event.key === '+' || event.key === '=') viewer.zoom(0.9);
    else if (event.key === '-') viewer.zoom(1 / 0.9);
    else return;
    event.preventDefault();
  });
}

// Calls `moved(x, y, dx, dy)` with client coordinates while `handle` is dragged.
function onDrag(handle, moved) {
  let last = null;
  handle.addEventListener('pointerdown', (event) => {
    handle.setPointerCapture(event.pointerId);
    event.preventDefault();
    handle.focus();
    last = event;
  });
  handle.addEventListener('pointermove', (event) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const { clientX: x, clientY: y } = event;
    moved(x, y, x - last.clientX, y - last.clientY);
    last = event;
  });
}

function makeSun(viewer) {
  const sun = document.createElement('button');
  sun.type = 'button';
  sun.className = 'sun';
  sun.title = 'The point light. Double-click: to the other side.';
  sun.setAttribute(
    'aria-label',
    'Point light: arrow keys move it, Enter sends it to the other side',
  );
  const rays = [0, 45, 90, 135, 180, 225, 270, 315]
    .map((a) => `<path d="M0-8.5V-12.5" transform="rotate(${a})" stroke-width="2.4"/>`)
    .join('');
  sun.innerHTML = `<svg viewBox="-15 -15 30 30" aria-hidden="true"><circle r="6.5"/>${rays}</svg>`;
  onDrag(sun, (x, y) => {
    const box = viewer.canvas.getBoundingClientRect(),
      pane = viewer.panes[0];
    const ratio = viewer.canvas.width / box.width;
    viewer.setLightInView(
      (x - box.left - (pane.x + pane.width / 2) / ratio) / viewer.sunReach,
      ((viewer.canvas.height - pane.y - pane.height / 2) / ratio - (y - box.top)) / viewer.sunReach,
      viewer.lightInView()[2] >= 0,
    );
  });
  const other = () => {
    const d = viewer.lightInView();
    viewer.setLightInView(d[0], d[1], d[2] < 0);
  };
  sun.addEventListener('dblclick', other);
  sun.addEventListener('keydown', (event) => {
    const arrow = arrows[event.key],
      d = viewer.lightInView();
    if (arrow) viewer.setLightInView(d[0] + 0.05 * arrow[0], d[1] + 0.05 * arrow[1], d[2] >= 0);
    else if (event.key === 'Enter') other();
    else return;
    event.preventDefault();
  });
  return sun;
}

function makeDivider(viewer, index) {
  const divider = document.createElement('div');
  divider.className = 'divider';
  divider.tabIndex = 0;
  divider.setAttribute('role', 'separator');
  divider.setAttribute('aria-orientation', 'vertical');
  divider.setAttribute('aria-label', `Divider ${index + 1} of 3`);
  const move = (x) => {
    const ends = [0, ...viewer.dividers, 1];
    viewer.dividers[index] = Math.min(Math.max(x, ends[index]), ends[index + 2]);
    viewer.cut();
    viewer.shown();
  };
  onDrag(divider, (x) => {
    const box = viewer.canvas.getBoundingClientRect();
    move((x - box.left) / box.width);
  });
  divider.addEventListener('keydown', (event) => {
    const arrow = arrows[event.key];
    if (!arrow || !arrow[0]) return;
    move(viewer.dividers[index] + 0.01 * arrow[0]);
    event.preventDefault();
  });
  return divider;
}

function showMessage(text) {
  element('rendering').hidden = true;
  element('message').textContent = text;
  element('message').hidden = false;
}
