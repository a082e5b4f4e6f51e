const data = JSON.parse(document.getElementById('data').textContent);
const element = (id) => document.getElementById(id);
const materials = data.materials;
const byName = new Map(materials.map((material) => [material.name, material]));
const twinNames = new Set(data.duplicates.flatMap((pair) => [pair.first, pair.second]));
const percent = (value) => `${(100 * value).toPrecision(3)} %`;
const short = (value) => String(Number(value.toPrecision(3)));
let chosen = null;

function made(tag, properties = {}, ...children) {
  const one = Object.assign(document.createElement(tag), properties);
  one.append(...children);
  return one;
}

function pictureOf(material, className = '') {
  return made('img', { src: `data:image/png;base64,${material.png}`, alt: '', className });
}

function linkTo(name, ...children) {
  const link = made('button', { type: 'button', className: 'link' }, ...children, name);
  link.addEventListener('click', () => choose(byName.get(name)));
  return link;
}

// A range of a number: two sliders whose steps are the sorted values of the materials, so that
// each step shows or hides one.
const ranges = [
  { key: 'albedo', label: 'Albedo', text: percent },
  { key: 'gloss', label: 'Gloss', text: percent },
  { key: 'chroma', label: 'Chroma', text: short },
];
for (const range of ranges) {
  range.values = materials.map((material) => material[range.key]).sort((a, b) => a - b);
  const last = range.values.length - 1;
  range.output = made('output');
  [range.low, range.high] = ['least', 'most'].map((end) => {
    const slider = made('input', { type: 'range', min: 0, max: last, step: 1 });
    slider.defaultValue = end === 'least' ? 0 : last;
    slider.setAttribute('aria-label', `${range.label}, ${end}`);
    return slider;
  });
  // Neither end passes the other.
  range.low.addEventListener('input', () => {
    if (Number(range.low.value) > Number(range.high.value)) range.high.value = range.low.value;
  });
  range.high.addEventListener('input', () => {
    if (Number(range.high.value) < Number(range.low.value)) range.low.value = range.high.value;
  });
  element('ranges').append(
    made('label', {}, range.label, range.output), range.low, range.high);
}

function boundsOf(range) {
  return [range.low, range.high].map((slider) => range.values[Number(slider.value)]);
}

function isShown(material) {
  const part = element('name').value.trim().toLowerCase();
  if (!material.name.toLowerCase().includes(part)) return false;
  if (element('onlyTwins').checked && !twinNames.has(material.name)) return false;
  for (const range of ranges) {
    const [low, high] = boundsOf(range);
    if (material[range.key] < low || material[range.key] > high) return false;
  }
  const width = Number(element('hueWidth').value);
  if (width === 180) return true;
  const gap = Math.abs(material.hue - Number(element('hue').value)) % 360;
  return material.chroma > 0.5 && Math.min(gap, 360 - gap) <= width;
}

function filter() {
  let shown = 0;
  for (const material of materials) {
    const isIn = isShown(material);
    material.button.classList.toggle('out', !isIn);
    material.button.tabIndex = isIn ? 0 : -1;
    shown += isIn ? 1 : 0;
  }
  for (const range of ranges) range.output.value = boundsOf(range).map(range.text).join(' to ');
  const width = Number(element('hueWidth').value);
  element('hueText').value = `${element('hue').value}°`;
  element('hueWidthText').value = width === 180 ? 'any hue, and grey' : `± ${width}°`;
  element('summary').textContent =
    shown === materials.length ? `All ${shown} shown` : `${shown} of ${materials.length} shown`;
}

const lines = document.createElementNS('http://www.w3.org/2000/svg', 'svg');

function place() {
  const stage = element('stage'),
    size = Number(element('size').value),
    gap = 8;
  // On a narrow screen the map is turned by a quarter.
  const upright = stage.clientWidth < 600 && data.width > data.height;
  const at = ({ place: { x, y } }) => (upright ? [data.height - y, x] : [x, y]);
  const [width, height] = (upright ? [data.height, data.width] : [data.width, data.height]).map(
    (length) => length * size + 2 * gap,
  );
  Object.assign(element('map').style, { width: `${width}px`, height: `${height}px` });
  element('map').style.setProperty('--ring', `${Math.min(Math.max(size / 28, 1), 2)}px`);
  lines.setAttribute('width', width);
  lines.setAttribute('height', height);
  for (const material of materials) {
    const [x, y] = at(material);
    material.middle = [x * size + gap, y * size + gap];
    Object.assign(material.button.style, {
      left: `${material.middle[0] - 0.46 * size}px`,
      top: `${material.middle[1] - 0.46 * size}px`,
      width: `${0.92 * size}px`,
      height: `${0.92 * size}px`,
    });
  }
  draw();
}

function draw() {
  lines.replaceChildren();
  const line = (a, b, className) => {
    const one = document.createElementNS('http://www.w3.org/2000/svg', 'line');
    const ends = { x1: a.middle[0], y1: a.middle[1], x2: b.middle[0], y2: b.middle[1] };
    for (const [key, value] of Object.entries(ends)) one.setAttribute(key, value);
    one.setAttribute('class', className);
    lines.append(one);
  };
  for (const pair of data.duplicates) line(byName.get(pair.first), byName.get(pair.second), 'twin');
  for (const one of chosen ? chosen.nearest : []) line(chosen, byName.get(one.name), 'near');
}

// The largest thumbnails with which the map is as wide as its place, of 28 to 96 pixels.
function fit() {
  const stage = element('stage'),
    upright = stage.clientWidth < 600 && data.width > data.height,
    size = Math.floor((stage.clientWidth - 16) / (upright ? data.height : data.width));
  element('size').value = Math.min(Math.max(size, 28), 96);
  place();
  // A map that is larger than its place begins in its middle.
  stage.scrollTo(
    (stage.scrollWidth - stage.clientWidth) / 2, (stage.scrollHeight - stage.clientHeight) / 2);
}

// Scrolls the map, and not the page, where a material is out of sight.
function reveal(material) {
  const stage = element('stage'),
    [x, y] = material.middle.map((at, k) => at - (k ? stage.scrollTop : stage.scrollLeft));
  if (x > 0 && x < stage.clientWidth && y > 0 && y < stage.clientHeight) return;
  stage.scrollTo(
    material.middle[0] - stage.clientWidth / 2, material.middle[1] - stage.clientHeight / 2);
}

function factsOf(material) {
  const error = material.error;
  const rows = [
    ['specification', made('code', {}, `${data.library}:${material.name}`)],
    ['source', material.source],
    ['form', `${material.kind}, ${material.bytes} bytes`],
    ['albedo', percent(material.albedo)],
    ['gloss', percent(material.gloss)],
    ['colour', material.chroma > 0.5
      ? `chroma ${short(material.chroma)}, hue ${Math.round(material.hue)}°` : 'grey'],
  ];
  if (error.largest > 0) {
    rows.push(['error of ln(f + 0.001)', short(error.log)],
      ['relative L2', short(error.relative_l2)],
      ['largest error', `${short(error.maximum)} of ${short(error.largest)} 1/sr`],
      ['FLIP', error.flip > 0 ? short(error.flip) : 'not measured']);
  } else {
    rows.push(['errors', 'not measured']);
  }
  if (material.fallback) rows.push(['own form', `it ${material.fallback}`]);
  const list = made('dl');
  for (const [name, value] of rows) {
    const shown = made('dd', {}, value);
    if (name === 'colour') {
      const swatch = made('span', { className: 'swatch' });
      swatch.style.background = material.colour;
      shown.prepend(swatch);
    }
    list.append(made('dt', {}, name), shown);
  }
  return list;
}

function nearestOf(material) {
  const body = made('tbody');
  for (const one of material.nearest) {
    body.append(
      made('tr', {},
        made('td', {}, linkTo(one.name, pictureOf(byName.get(one.name)))),
        made('td', {}, one.distance.toFixed(3)),
        made('td', {}, one.flip.toFixed(3))));
  }
  const head = ['Nearest', 'distance', 'FLIP'].map((text) => made('th', { scope: 'col' }, text));
  return made('table', {}, made('thead', {}, made('tr', {}, ...head)), body);
}

function choose(material) {
  chosen = material;
  const near = new Set(material.nearest.map((one) => one.name));
  for (const one of materials) {
    one.button.setAttribute('aria-pressed', String(one === material));
    one.button.classList.toggle('near', near.has(one.name));
  }
  element('facts').replaceChildren(
    made('h2', {}, material.name), pictureOf(material, 'large'), factsOf(material),
    ...(material.nearest.length > 0 ? [nearestOf(material)] : []));
  history.replaceState(null, '', `#${encodeURIComponent(material.name)}`);
  draw();
  reveal(material);
}

element('map').append(lines);
for (const material of materials) {
  material.button = made('button', { type: 'button', className: 'material', title: material.name },
    pictureOf(material));
  material.button.setAttribute('aria-label', material.name);
  material.button.setAttribute('aria-pressed', 'false');
  material.button.classList.toggle('twin', twinNames.has(material.name));
  material.button.addEventListener('click', () => choose(material));
  element('map').append(material.button);
}
element('twinCount').textContent = data.duplicates.length > 0 ? data.duplicates.length : 'none';
for (const pair of data.duplicates) {
  element('twinList').append(
    made('li', {}, linkTo(pair.first), ' and ', linkTo(pair.second),
      `: FLIP ${pair.flip.toFixed(3)}, distance ${pair.distance.toFixed(3)}`));
}
element('filters').addEventListener('input', filter);
element('filters').addEventListener('reset', () => setTimeout(filter));
element('filters').addEventListener('submit', (event) => event.preventDefault());
element('size').addEventListener('input', place);
addEventListener('resize', fit);
filter();
fit();
// The address of the page may name a material: merl.html#chrome-steel.
const named = materials.find((material) =>
  [material.name, encodeURIComponent(material.name)].includes(location.hash.slice(1)));
if (named) choose(named);
