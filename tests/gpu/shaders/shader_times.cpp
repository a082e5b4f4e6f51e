// Times of compute shaders on one Vulkan device, taken in turns.
//
//     shader_times REPEATS FILE.spv…
//
// Each shader reads wo and wi of a pair at binding 3 (two vec4) and writes a vec4 at binding 4, 64
// pairs a group, over 2^20 pairs of directions uniform on both hemispheres. For each file a line
// with the median and the least time of a pair in nanoseconds. The device is the software one; with
// HSHFIT_TEST_GPU set, any other. The first line has its name.

#include "runners.h"
#include "spirv_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>

namespace hshfit::shaders {
namespace {

constexpr std::uint32_t pairs = 1U << 20U, groupSize = 64;

std::vector<float> pairNumbers() {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    std::vector<float> numbers;
    for (std::uint32_t k = 0; k < 2 * pairs; ++k) {
        const double z = 1e-6 + (1 - 1e-6) * uniform(random), s = std::sqrt(1 - z * z);
        const double phi = 2 * std::numbers::pi * uniform(random);
        for (const double number : {s * std::cos(phi), s * std::sin(phi), z, 0.0})
            numbers.push_back(static_cast<float>(number));
    }
    return numbers;
}

double nanosecondsOf(gpu::ComputeProgram& program) {
    const std::clock_t before = std::clock();
    program.run(pairs / groupSize);
    const double time = 1e9 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    return time / pairs;
}

void measure(int repeats, int count, char** paths) {
    const auto device = vulkanDevice(false);
    fmt::print("{}\n", device->name());
    using Kind = gpu::ComputeResource::Kind;
    const std::vector<gpu::ComputeResource> resources{
        {.binding = 0,
         .kind = Kind::uniforms,
         .numbers = std::vector<float>(4096, std::bit_cast<float>(0x3c3c3c3cU))},
        {.binding = 3, .numbers = pairNumbers()},
        {.binding = 4, .count = std::size_t{pairs} * 4}};
    std::vector<gpu::ComputeProgram> programs;
    for (int i = 0; i < count; ++i) programs.emplace_back(*device, wordsOf(paths[i]), resources);
    std::vector<std::vector<double>> times(programs.size());
    // The first round warms up.
    for (int r = -1; r < repeats; ++r) {
        for (std::size_t i = 0; i < programs.size(); ++i) {
            const double time = nanosecondsOf(programs[i]);
            if (r >= 0) times[i].push_back(time);
        }
    }
    for (std::size_t i = 0; i < times.size(); ++i) {
        std::ranges::sort(times[i]);
        fmt::print("{} {:.3f} {:.3f}\n", paths[i], times[i][times[i].size() / 2], times[i][0]);
    }
}

}  // namespace
}  // namespace hshfit::shaders

int main(int count, char** arguments) {
    try {
        const int repeats = count > 2 ? std::atoi(arguments[1]) : 0;
        if (repeats < 1) throw std::runtime_error("shader_times REPEATS FILE.spv…");
        hshfit::shaders::measure(repeats, count - 2, arguments + 2);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
    return 0;
}
