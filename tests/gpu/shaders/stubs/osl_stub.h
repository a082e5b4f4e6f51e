#pragma once

// The part of OSL that the snippets use, in C++: the arithmetic is tested, the grammar is not.

#include "stub.h"

using string = const stub::Array*;

struct vector {
    float x, y, z;
    vector() = default;
    vector(float a, float b, float c) : x(a), y(b), z(c) {}
    float& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
};
using color = vector;

inline vector operator*(float a, vector b) {
    return {a * b.x, a * b.y, a * b.z};
}
inline vector operator*(vector a, vector b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline vector operator+(vector a, vector b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vector operator-(vector a, vector b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vector operator/(vector a, float b) {
    return {a.x / b, a.y / b, a.z / b};
}
inline float dot(vector a, vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline vector cross(vector a, vector b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline vector normalize(vector a) {
    return a / stub::root(dot(a, a));
}
inline float ceil(float a) {
    return __builtin_ceilf(a);
}
inline float step(float edge, float x) {
    return x < edge ? 0.0f : 1.0f;
}
inline float min(float a, float b) {
    return b < a ? b : a;
}
inline float max(float a, float b) {
    return a < b ? b : a;
}
inline vector max(vector a, vector b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
inline vector min(vector a, vector b) {
    return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
inline float mix(float a, float b, float t) {
    return a * (1 - t) + b * t;
}
inline float sqrt(float a) {
    return stub::root(a);
}

inline float exp(float a) {
    return __builtin_expf(a);
}
inline float exp2(float a) {
    return __builtin_exp2f(a);
}
inline float log(float a) {
    return __builtin_logf(a);
}
inline float pow(float a, float b) {
    return __builtin_powf(a, b);
}
inline vector exp(vector a) {
    return {exp(a.x), exp(a.y), exp(a.z)};
}
inline vector exp2(vector a) {
    return {exp2(a.x), exp2(a.y), exp2(a.z)};
}
inline float log2(float a) {
    return __builtin_log2f(a);
}
inline float clamp(float a, float low, float high) {
    return min(max(a, low), high);
}
inline float floor(float a) {
    return __builtin_floorf(a);
}

/// The level that OpenImageIO takes for a filter of a share of the picture: of the first level
/// where it is w <= 1 texels of the shorter side, 2 w - 1, and the rest of the finer one.
/// osl_texture_test finds the same with the real one.
inline float levelOf(const stub::Array* map, float width) {
    for (int k = 0; k < map->levels; ++k) {
        const stub::Array& level = map->finest[k];
        const int side = level.width < level.height ? level.width : level.height;
        const float w = width * static_cast<float>(side);
        if (w > 1) continue;
        return k == 0 ? 0.0f : static_cast<float>(k - 1) + max(2.0f * w - 1.0f, 0.0f);
    }
    return static_cast<float>(map->levels - 1);
}

/// Takes the keys and modes of OSL (stdlib.md, "Texture"); OSL itself ignores an unknown mode.
inline color texture(string map, float u, float v, float width, float, float, float,
                     const char* key, int subimage, const char* interp, const char* mode,
                     const char* wrap, const char* wrapMode, const char* rest, float& alpha) {
    const bool closest = __builtin_strcmp(mode, "closest") == 0;
    const char* found[] = {key, interp, closest ? "linear" : mode, wrap, wrapMode, rest};
    const char* wanted[] = {"subimage", "interp", "linear", "wrap", "clamp", "alpha"};
    for (int i = 0; i < 6; ++i)
        if (__builtin_strcmp(found[i], wanted[i]) != 0) exit(4);
    const float lod = levelOf(map, width);
    float lanes[4];
    for (int lane = 0; lane < 4; ++lane) {
        if (closest) {
            const stub::Array& level = map->finest[static_cast<int>(lod + 0.5f)];
            lanes[lane] =
                level.at(static_cast<int>(u * static_cast<float>(level.width)),
                         static_cast<int>(v * static_cast<float>(level.height)), subimage, lane);
        } else {
            lanes[lane] = map->sample(u, v, subimage, lane, lod);
        }
    }
    alpha = lanes[3];
    return {lanes[0], lanes[1], lanes[2]};
}
