#pragma once

// The common parts of the Metal and OSL stubs: a job read from a file, texture arrays with a
// bilinear filter, and a main that evaluates every pair. No header of the C++ library: each costs
// half a second.

#include <stdio.h>
#include <stdlib.h>

namespace stub {

inline float root(float a) {
    return __builtin_sqrtf(a);
}

struct Array {
    int width, height, layers, levels;
    float* texels;  ///< of this level
    Array* finest;  ///< the levels, this one among them

    /// Between two levels.
    float sample(float u, float v, int layer, int lane, float lod) const {
        const float last = static_cast<float>(levels - 1);
        const float level = lod < 0 ? 0 : lod > last ? last : lod;
        const int finer = static_cast<int>(level);
        const float share = level - static_cast<float>(finer);
        const float a = finest[finer].sample(u, v, layer, lane);
        return share == 0 ? a
                          : (1 - share) * a + share * finest[finer + 1].sample(u, v, layer, lane);
    }

    float at(int x, int y, int layer, int lane) const {
        x = x < 0 ? 0 : x < width ? x : width - 1;
        y = y < 0 ? 0 : y < height ? y : height - 1;
        return texels[((layer * height + y) * width + x) * 4 + lane];
    }
    float sample(float u, float v, int layer, int lane) const {
        const float px = u * static_cast<float>(width) - 0.5f;
        const float py = v * static_cast<float>(height) - 0.5f;
        const float fx = __builtin_floorf(px), fy = __builtin_floorf(py), s = px - fx, t = py - fy;
        const int x = static_cast<int>(fx), y = static_cast<int>(fy);
        return (1 - t) * ((1 - s) * at(x, y, layer, lane) + s * at(x + 1, y, layer, lane)) +
               t * ((1 - s) * at(x, y + 1, layer, lane) + s * at(x + 1, y + 1, layer, lane));
    }
};

struct Job {
    Array coefficients, basis, harmonics;
    int pairs, inputs, outputs;
    float* numbers;
    float* block;  ///< a uniform block, if there is one
};
inline Job job;

template <class T>
void read(FILE* file, T* to, int count) {
    const auto n = static_cast<size_t>(count);
    if (fread(to, sizeof(T), n, file) != n) exit(3);
}

inline void readArray(FILE* file, Array& array) {
    read(file, &array.width, 1);
    read(file, &array.height, 1);
    read(file, &array.layers, 1);
    read(file, &array.levels, 1);
    array.finest = new Array[static_cast<size_t>(array.levels)];
    for (int k = 0; k < array.levels; ++k) {
        Array& level = array.finest[k];
        level = array;
        level.width = array.width >> k > 1 ? array.width >> k : 1;
        level.height = array.height >> k > 1 ? array.height >> k : 1;
        const int count = level.width * level.height * level.layers * 4;
        level.texels = new float[static_cast<size_t>(count)];
        read(file, level.texels, count);
    }
    array.texels = array.finest[0].texels;
}

/// evaluate(k, out) for every pair, of the job in `from`; results to `to`. Allocations stay to the
/// end of the process.
template <class Evaluate>
int runAll(const char* from, const char* to, Evaluate evaluate) {
    FILE* file = fopen(from, "rb");
    if (file == nullptr) return 2;
    readArray(file, job.coefficients);
    readArray(file, job.basis);
    readArray(file, job.harmonics);
    int length = 0;
    read(file, &length, 1);
    job.block = new float[static_cast<size_t>(length)];
    read(file, job.block, length);
    read(file, &job.pairs, 1);
    read(file, &job.inputs, 1);
    read(file, &job.outputs, 1);
    job.numbers = new float[static_cast<size_t>(job.inputs)];
    read(file, job.numbers, job.inputs);
    fclose(file);
    const auto count = static_cast<size_t>(job.pairs * job.outputs);
    auto* results = new float[count];
    for (int k = 0; k < job.pairs; ++k) evaluate(k, results + k * job.outputs);
    file = fopen(to, "wb");
    if (file == nullptr) return 2;
    const bool good = fwrite(results, 4, count, file) == count;
    return fclose(file) == 0 && good ? 0 : 2;
}

}  // namespace stub
