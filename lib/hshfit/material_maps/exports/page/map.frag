// A plane of the map's proportions in z = 0, or the unit sphere, seen by rays. The world has +z up.
uniform vec2 size, halves;
uniform vec3 eye, right, up, back, lamp;
#if ENVIRONMENT > 0
uniform vec3 environment[ENVIRONMENT];
#else
uniform float fill;
#endif
uniform float slope, lampStrength, exposure, fixedLevel, repeats;
uniform int shape;
uniform bool automatic, coloured;
out vec4 colour;

vec3 rayOf(vec2 pixel) {
    vec2 clip = (2.0 * pixel - size) / size.y * slope;
    return normalize(clip.x * right + clip.y * up - back);
}

// Where a ray meets the shape, and whether it does: beside it, the nearest place.
vec3 meetingOf(vec3 ray, out bool met) {
    if (shape == 0) {
        float along = -eye.z / ray.z;
        vec3 p = eye + along * ray;
        met = along > 0.0 && all(lessThanEqual(abs(p.xy), halves));
        return p;
    }
    float middle = -dot(eye, ray);
    float gap = middle * middle - dot(eye, eye) + 1.0;
    met = gap >= 0.0 && middle > 0.0;
    return normalize(eye + (middle - sqrt(max(gap, 0.0))) * ray);
}

vec2 placeOf(vec3 p) {
    if (shape == 0) return vec2(0.5, 0.5) + 0.5 * vec2(p.x, -p.y) / halves;
    return vec2(0.5 + atan(p.y, p.x) / 6.283185307, acos(clamp(p.z, -1.0, 1.0)) / 3.141592654);
}

vec2 changeOf(vec2 from, vec2 to) {
    vec2 change = to - from;
    if (shape == 1) change.x -= floor(change.x + 0.5);
    return change * repeats;
}

vec3 levelColour(float level) {
    return clamp(vec3(abs(level - 3.0) - 1.0, 2.0 - abs(level - 2.0), 2.0 - abs(level - 4.0)), 0.0, 1.0);
}

void main() {
    bool met, ignored;
    vec3 ray = rayOf(gl_FragCoord.xy);
    vec3 p = meetingOf(ray, met);
    if (!met || (shape == 0 && eye.z <= 0.0)) {
        colour = vec4(0.07, 0.07, 0.08, 1.0);
        return;
    }
    vec2 place = placeOf(p);
    vec2 dx = changeOf(place, placeOf(meetingOf(rayOf(gl_FragCoord.xy + vec2(1.0, 0.0)), ignored)));
    vec2 dy = changeOf(place, placeOf(meetingOf(rayOf(gl_FragCoord.xy + vec2(0.0, 1.0)), ignored)));
    float lod = automatic ? hsh_level(dx, dy) : fixedLevel;
    vec2 uv = place * repeats;

    vec3 n = vec3(0.0, 0.0, 1.0), t = vec3(1.0, 0.0, 0.0);
    if (shape == 1) {
        n = p;
        float across = length(p.xy);
        t = across > 1e-6 ? vec3(-p.y, p.x, 0.0) / across : vec3(0.0, 1.0, 0.0);
    }
    vec3 b = cross(n, t), toLamp = lamp - p, wi = normalize(toLamp);
    vec3 localWo = vec3(dot(-ray, t), dot(-ray, b), dot(-ray, n));
    vec3 localWi = vec3(dot(wi, t), dot(wi, b), dot(wi, n));
    vec3 f = vec3(hsh_eval(uv, lod, localWo, localWi));
#ifndef COSINE_INCLUDED
    f *= max(localWi.z, 0.0);
#endif
    vec3 light = f * lampStrength / dot(toLamp, toLamp);
#if ENVIRONMENT > 0
    light += max(hsh_shadeWorld(uv, lod, -ray, t, b, n, environment), 0.0);
#else
    // Eight lamps far away, towards the corners of a cube.
    for (int k = 0; k < 8 && fill > 0.0; ++k) {
        vec3 d = (vec3(k & 1, (k >> 1) & 1, k >> 2) * 2.0 - 1.0) * 0.577350269;
        vec3 local = vec3(dot(d, t), dot(d, b), dot(d, n));
        light += fill * vec3(hsh_eval(uv, lod, localWo, local));
    }
#endif
    light *= exp2(exposure);
    if (coloured) light = 0.25 * light + 0.75 * levelColour(lod);
    vec3 codes = mix(1.055 * pow(max(light, 0.0), vec3(1.0 / 2.4)) - 0.055, 12.92 * light,
                     vec3(lessThanEqual(light, vec3(0.0031308))));
    colour = vec4(clamp(codes, 0.0, 1.0), 1.0);
}
