#pragma once

#include <hshfit/gpu/timing/timed_shader.h>

#include <functional>
#include <span>
#include <vector>

namespace hshfit::gpu::inline timing {

/// Nanoseconds for a million pixels.
struct ShaderTime {
    double median = 0;
    double low = 0, high = 0;  ///< quartiles of the repeats
};

struct ShaderTimeOptions {
    int repeats = 9;
    std::function<void()> done = {};  ///< after each shader
};

/// Times of shaders on a device. Repeats are interleaved: every shader once, then every one again,
/// so that a slow spell of the device falls on all alike; the first round warms up and does not
/// count. Throws NumericError where a shader does not compile or run.
std::vector<ShaderTime> timeShaders(const ComputeDevice& device,
                                    std::span<const TimedShader> shaders,
                                    const ShaderTimeOptions& options = {});

}  // namespace hshfit::gpu::inline timing
