#include <hshfit/gpu/timing/shader_time.h>

#include <hshfit/gpu/vulkan/spirv.h>

#include <algorithm>
#include <cmath>

namespace hshfit::gpu::inline timing {
namespace {

constexpr std::size_t timedPixels = std::size_t{timedSide} * timedSide;
constexpr std::uint32_t groups = timedPixels / 64;

ShaderTime summarised(std::vector<double> times) {
    std::sort(times.begin(), times.end());
    const auto quantile = [&](double q) {
        return times[static_cast<std::size_t>(
            std::lround(q * static_cast<double>(times.size() - 1)))];
    };
    return {quantile(0.5), quantile(0.25), quantile(0.75)};
}

}  // namespace

std::vector<ShaderTime> timeShaders(const ComputeDevice& device,
                                    std::span<const TimedShader> shaders,
                                    const ShaderTimeOptions& options) {
    std::vector<ComputeProgram> programs;
    for (const TimedShader& shader : shaders) {
        programs.emplace_back(device, compileGlsl(shader.source), shader.resources);
        programs.back().run(groups);
    }
    std::vector<std::vector<double>> times(shaders.size());
    for (int repeat = 0; repeat < options.repeats; ++repeat) {
        for (std::size_t k = 0; k < programs.size(); ++k) {
            const double seconds = programs[k].run(groups);
            times[k].push_back(1e15 * seconds / static_cast<double>(timedPixels));
        }
    }
    std::vector<ShaderTime> result;
    for (std::size_t k = 0; k < programs.size(); ++k) {
        result.push_back(summarised(std::move(times[k])));
        if (options.done) options.done();
    }
    return result;
}

}  // namespace hshfit::gpu::inline timing
