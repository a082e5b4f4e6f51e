// The fragment shaders of the three kinds of pictures, put together.

const shaderHead =
  '#version 300 es\nprecision highp float;\nprecision highp int;\n' +
  'precision highp sampler2D;\nprecision highp sampler2DArray;\n';

function fitSource({ skyOrder, shaders }, fit) {
  return (
    `${shaderHead}${fit.shader}\n#define SKY_ORDER ${skyOrder}\n` +
    `#define FIT_EVAL ${fit.prefix}_eval\n#define FIT_RAW ${fit.prefix}_evalRaw\n` +
    `#define FIT_SHADE ${fit.prefix}_shadeWorld\n#define FIT_HAS_COSINE ${fit.hasCosine}\n` +
    shaders.fit +
    shaders.shadeFragment
  );
}

const sampledHead = ({ samples }) =>
  `${shaderHead}const float PI = 3.14159265358979;\n#define SAMPLES ${samples}\n`;

// f from the table, without a main.
function exactTableSource({ shaders }, e) {
  const mirrored = e.isotropic && e.bilateral;
  const range = (Math.PI * (e.reciprocal ? 1 : 2)) / (mirrored ? 2 : 1);
  return (
    `${sampledHead(e)}` +
    `#define EXACT_ISOTROPIC ${e.isotropic}\n#define EXACT_BILATERAL ${e.bilateral}\n` +
    `#define EXACT_MIRRORED ${mirrored}\n#define EXACT_RANGE ${range.toFixed(15)}\n` +
    `#define EXACT_AZIMUTHS ${e.azimuths}\n#define EXACT_REST ${e.rest}\n` +
    `#define EXACT_LAST_THETA ${e.lastTheta.toFixed(15)}\n${shaders.exact}`
  );
}

const exactSource = (data, e) => exactTableSource(data, e) + sampledTail(data);

const sampledTail = ({ shaders }) => shaders.environment + shaders.sampled + shaders.shadeFragment;

// A form by its own snippet.
function formSource(data, form) {
  return (
    `${sampledHead(form)}${form.shader}\n` +
    'vec3 asColour(float value) { return vec3(value); }\n' +
    'vec3 asColour(vec3 value) { return value; }\n' +
    `vec3 materialBrdf(vec3 wo, vec3 wi) { return asColour(${form.prefix}_eval(wo, wi)); }\n` +
    sampledTail(data)
  );
}
