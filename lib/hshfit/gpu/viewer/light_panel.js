// The panel of the environment: choice of the light, its picture, turns, pictures dropped in.

Object.assign(Viewer.prototype, {
  bindLight() {
    this.listLights();
    const select = element('sky');
    select.addEventListener('input', () => {
      this.state.sky = +select.value;
      this.lightChanged();
    });
    const canvas = element('skyPicture');
    // The picture follows the pointer: its middle lies behind the shape, and azimuths grow leftwards.
    onDrag(canvas, (x, y, dx, dy) => {
      this.turnSky((-360 * dx) / canvas.clientWidth, (-180 * dy) / canvas.clientHeight);
    });
    canvas.addEventListener('keydown', (event) => {
      const arrow = arrows[event.key];
      if (!arrow) return;
      this.turnSky(-5 * arrow[0], 5 * arrow[1]);
      event.preventDefault();
    });
    element('skyFile').addEventListener('change', (event) => {
      if (event.target.files.length) this.drop(event.target.files[0]);
      event.target.value = '';
    });
    const page = document.documentElement;
    for (const kind of ['dragover', 'dragleave', 'drop']) {
      page.addEventListener(kind, (event) => {
        event.preventDefault();
        page.classList.toggle('dropping', kind === 'dragover');
        if (kind === 'drop' && event.dataTransfer.files.length) {
          this.drop(event.dataTransfer.files[0]);
        }
      });
    }
    this.showLight();
  },

  listLights() {
    const { environments } = this.renderer,
      select = element('sky');
    this.state.sky = Math.min(Math.max(this.state.sky | 0, 0), environments.length - 1);
    select.replaceChildren(...environments.map(({ name }, i) => new Option(name, i)));
    select.value = this.state.sky;
    select.hidden = environments.length < 2;
  },

  lightChanged() {
    this.exposureWanted = this.autoExposure;
    this.showLight();
    this.changed();
  },

  // Degrees.
  turnSky(turn, tilt) {
    const wrapped = (x) => ((((x + 180) % 360) + 360) % 360) - 180;
    this.state.skyTurn = wrapped(this.state.skyTurn + turn);
    this.state.skyTilt = Math.min(Math.max(this.state.skyTilt + tilt, -90), 90);
    this.showLight();
    this.changed();
  },

  async drop(file) {
    const note = element('skyNote');
    note.classList.remove('warning');
    note.textContent = `${file.name}: being read and projected …`;
    await new Promise((done) => setTimeout(done));
    try {
      const environment = await droppedEnvironment(file, this.data.skyOrder);
      this.renderer.environments.push(environment);
      this.state.sky = this.renderer.environments.length - 1;
      if (this.state.lighting === 'point') {
        this.state.lighting = 'both';
        document.querySelector('input[name=lighting][value=both]').checked = true;
      }
      this.listLights();
      this.lightChanged();
    } catch (error) {
      note.textContent = `${file.name} cannot be used: ${error.message}.`;
      note.classList.add('warning');
      if (!(error instanceof Refused)) throw error;
    }
  },

  // The light as it stands around the pictures, row 0 the zenith, the viewer's back at both sides.
  showLight() {
    const canvas = element('skyPicture'),
      context = canvas.getContext('2d');
    const { width, height } = canvas,
      environment = this.renderer.environments[this.state.sky];
    const rad = Math.PI / 180;
    const m = turnAndTilt(this.state.skyTurn * rad, this.state.skyTilt * rad);
    const image = context.createImageData(width, height),
      mean = environment.coefficients.slice(0, 3).reduce((a, b) => a + b) / 3;
    const scale = mean > 0 ? 0.7 / (mean / Math.sqrt(4 * Math.PI)) : 1;
    for (let k = 0; k < width * height; ++k) {
      const theta = (Math.PI * (Math.floor(k / width) + 0.5)) / height,
        phi = 1.5 * Math.PI - (2 * Math.PI * ((k % width) + 0.5)) / width;
      const d = [Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)];
      const own = [0, 1, 2].map((i) => m[i] * d[0] + m[3 + i] * d[1] + m[6 + i] * d[2]);
      environment.at(own).forEach((x, c) => {
        image.data[4 * k + c] = 255 * ((scale * x) / (1 + scale * x)) ** (1 / 2.2);
      });
      image.data[4 * k + 3] = 255;
    }
    context.putImageData(image, 0, 0);
    const note = element('skyNote');
    note.classList.remove('warning');
    note.textContent = environment.note;
  },
});
