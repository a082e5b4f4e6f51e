#pragma once

// What the Metal and OSL stubs share: a job read from a file, texture arrays with a bilinear
// filter, and a main that evaluates every pair.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace stub {

struct Array {
    int width = 0, height = 0, layers = 0;
    std::vector<float> texels;

    float at(int x, int y, int layer, int lane) const {
        x = std::clamp(x, 0, width - 1);
        y = std::clamp(y, 0, height - 1);
        return texels[static_cast<std::size_t>(((layer * height + y) * width + x) * 4 + lane)];
    }
    float sample(float u, float v, int layer, int lane) const {
        const float px = u * static_cast<float>(width) - 0.5f;
        const float py = v * static_cast<float>(height) - 0.5f;
        const float fx = std::floor(px), fy = std::floor(py), s = px - fx, t = py - fy;
        const int x = static_cast<int>(fx), y = static_cast<int>(fy);
        return (1 - t) * ((1 - s) * at(x, y, layer, lane) + s * at(x + 1, y, layer, lane)) +
               t * ((1 - s) * at(x, y + 1, layer, lane) + s * at(x + 1, y + 1, layer, lane));
    }
};

struct Job {
    Array coefficients, basis;
    int pairs = 0, inputs = 0, outputs = 0;
    std::vector<float> numbers;
};
inline Job job;

template <class T>
void read(std::FILE* file, T* to, std::size_t count) {
    if (std::fread(to, sizeof(T), count, file) != count) std::exit(3);
}

inline void readArray(std::FILE* file, Array& array) {
    read(file, &array.width, 1);
    read(file, &array.height, 1);
    read(file, &array.layers, 1);
    array.texels.resize(static_cast<std::size_t>(array.width * array.height * array.layers * 4));
    read(file, array.texels.data(), array.texels.size());
}

/// evaluate(k, out) for every pair, of the job in `from`; results to `to`.
template <class Evaluate>
int runAll(const char* from, const char* to, Evaluate evaluate) {
    std::FILE* file = std::fopen(from, "rb");
    if (file == nullptr) return 2;
    readArray(file, job.coefficients);
    readArray(file, job.basis);
    read(file, &job.pairs, 1);
    read(file, &job.inputs, 1);
    read(file, &job.outputs, 1);
    job.numbers.resize(static_cast<std::size_t>(job.inputs));
    read(file, job.numbers.data(), job.numbers.size());
    std::fclose(file);
    std::vector<float> results(static_cast<std::size_t>(job.pairs * job.outputs));
    for (int k = 0; k < job.pairs; ++k) evaluate(k, results.data() + k * job.outputs);
    file = std::fopen(to, "wb");
    if (file == nullptr) return 2;
    const bool good = std::fwrite(results.data(), 4, results.size(), file) == results.size();
    return std::fclose(file) == 0 && good ? 0 : 2;
}

}  // namespace stub
