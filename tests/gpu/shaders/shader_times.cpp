// Times of compute shaders on one Vulkan device, taken in turns.
//
//     shader_times REPEATS FILE.spv…
//
// Each shader reads wo and wi of a pair at binding 3 (two vec4) and writes a vec4 at binding 4, 64
// pairs a group, over 2^20 pairs of directions uniform on both hemispheres. For each file a line
// with the median and the least time of a pair in nanoseconds. The device is the software one; with
// HSHFIT_TEST_GPU set, any other. The first line has its name.

#include "runners.h"
#include "vk_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <numbers>
#include <random>

namespace hshfit::shaders {
namespace {

constexpr std::uint32_t pairs = 1U << 20U, groupSize = 64;

std::vector<std::uint32_t> wordsOf(const char* path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file || bytes.empty() || bytes.size() % 4 != 0)
        throw std::runtime_error(fmt::format("{}: is no SPIR-V", path));
    std::vector<std::uint32_t> words(bytes.size() / 4);
    std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<char*>(words.data()));
    return words;
}

void fillPairs(float* numbers) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (std::uint32_t k = 0; k < 2 * pairs; ++k, numbers += 4) {
        const double z = 1e-6 + (1 - 1e-6) * uniform(random), s = std::sqrt(1 - z * z);
        const double phi = 2 * std::numbers::pi * uniform(random);
        numbers[0] = static_cast<float>(s * std::cos(phi));
        numbers[1] = static_cast<float>(s * std::sin(phi));
        numbers[2] = static_cast<float>(z);
        numbers[3] = 0;
    }
}

double nanosecondsOf(Device& device, const Pipeline& pipeline) {
    const std::clock_t before = std::clock();
    device.submit(
        [&](VkCommandBuffer commands) { pipeline.dispatch(commands, pairs / groupSize); });
    const double time = 1e9 * static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    return time / pairs;
}

void measure(int repeats, int count, char** paths) {
    Device device(false);
    fmt::print("{}\n", device.name());
    Buffer in(device, std::size_t{pairs} * 32, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    Buffer out(device, std::size_t{pairs} * 16, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    fillPairs(static_cast<float*>(in.data));
    const auto type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    Buffer block(device, 16384, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    std::fill_n(static_cast<unsigned char*>(block.data), 16384, 0x3c);
    const std::vector<Pipeline::Resource> resources{
        {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, {}, {block.buffer, 0, VK_WHOLE_SIZE}},
        {3, type, {}, {in.buffer, 0, VK_WHOLE_SIZE}},
        {4, type, {}, {out.buffer, 0, VK_WHOLE_SIZE}}};
    std::vector<std::unique_ptr<Pipeline>> pipelines;
    for (int i = 0; i < count; ++i)
        pipelines.push_back(std::make_unique<Pipeline>(device, wordsOf(paths[i]), resources));
    std::vector<std::vector<double>> times(pipelines.size());
    // The first round warms up.
    for (int r = -1; r < repeats; ++r) {
        for (std::size_t i = 0; i < pipelines.size(); ++i) {
            const double time = nanosecondsOf(device, *pipelines[i]);
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
