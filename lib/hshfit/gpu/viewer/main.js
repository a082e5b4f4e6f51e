// Starts the page: the data, then the viewer, or a message that says what is missing.

function decoded(base64) {
  return new Uint16Array(bytesOf(base64).buffer);
}

// One or three numbers a texel as four.
function asRgba(halves, channels) {
  const count = halves.length / channels,
    rgba = new Uint16Array(4 * count);
  for (let k = 0; k < count; ++k) {
    for (let c = 0; c < 3; ++c) rgba[4 * k + c] = halves[channels * k + (channels === 3 ? c : 0)];
  }
  return rgba;
}

function start() {
  const data = JSON.parse(element('data').textContent);
  for (const fit of data.fits) fit.halves = decoded(fit.texels);
  if (data.form?.texels) data.form.values = new Float32Array(bytesOf(data.form.texels).buffer);
  if (data.exact.texels)
    data.exact.halves = asRgba(decoded(data.exact.texels), data.exact.channels);
  window.viewer = new Viewer(data);
}

// Shaders take a moment to compile: the page is there before.
requestAnimationFrame(() =>
  setTimeout(() => {
    try {
      start();
    } catch (error) {
      showMessage(
        error instanceof Unsupported
          ? error.message
          : `The pictures cannot be drawn here: ${error.message}`,
      );
      if (!(error instanceof Unsupported)) throw error;
    }
  }),
);
