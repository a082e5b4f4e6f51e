#version 300 es
// One pane: a picture, or the difference of two in false colour.
precision highp float;
in vec2 place;
uniform sampler2D first, second;
uniform bool isDifference, showNegative;
uniform float exposure, differenceScale;  // exposure: factor
uniform vec3 paper;
out vec4 result;

vec3 encoded(vec3 linear) {
    vec3 c = clamp(linear, 0.0, 1.0);
    return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

// Blue where the first is darker, orange where it is brighter, dark grey where both agree.
vec3 falseColour(float x) {
    vec3 middle = vec3(0.10, 0.10, 0.11);
    vec3 side = x < 0.0 ? vec3(0.16, 0.55, 1.0) : vec3(1.0, 0.55, 0.08);
    float t = min(abs(x), 1.0);
    return t < 0.5 ? mix(middle, side, t * 2.0) : mix(side, vec3(1.0), (t - 0.5) * 1.4);
}

float signedLargest(vec3 v) {
    float high = max(v.r, max(v.g, v.b)), low = min(v.r, min(v.g, v.b));
    return high > -low ? high : low;
}

void main() {
    vec4 a = texture(first, place), b = texture(second, place);
    // Sums over the covered part of a pixel, made means over it.
    a.rgb /= max(a.a, 1e-4);
    b.rgb /= max(b.a, 1e-4);
    vec3 colour;
    if (isDifference) {
        colour = falseColour(signedLargest(a.rgb - b.rgb) * exposure / differenceScale);
    } else {
        float low = min(a.r, min(a.g, a.b)) * exposure;
        colour = encoded(a.rgb * exposure);
        // Magenta from the first 1/200 below 0, so that faint ringing shows too.
        if (showNegative && low < -0.005) {
            colour = mix(vec3(0.45, 0.0, 0.36), vec3(1.0, 0.2, 0.9), min(1.0, -low * 4.0));
        }
    }
    result = vec4(mix(paper, colour, a.a), 1.0);
}
