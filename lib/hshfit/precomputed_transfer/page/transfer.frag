#version 300 es
precision highp float;

in vec3 radiance;
uniform float exposure;
out vec4 pixel;

void main() {
  vec3 x = clamp(radiance * exposure, 0.0, 1.0);
  vec3 low = 12.92 * x, high = 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055;
  pixel = vec4(mix(high, low, lessThanEqual(x, vec3(0.0031308))), 1.0);
}
