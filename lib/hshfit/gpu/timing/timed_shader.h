#pragma once

#include <hshfit/gpu/vulkan/compute.h>
#include <hshfit/representation/representation.h>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu::inline timing {

/// A compute shader that evaluates a form once for each pixel of a square of `timedSide` pixels
/// within the picture of a sphere, seen along the normal of its middle under one directional light,
/// and stores the sum over channels as buffer `sumsBinding`.
struct TimedShader {
    std::string source;  ///< GLSL 4.50 for Vulkan
    std::vector<ComputeResource> resources = {};
};
constexpr int timedSide = 1024;
constexpr std::uint32_t sumsBinding = 3;

/// The shader that export writes of the form, with its numbers as constants, block or texture as
/// there. Coefficients per outgoing direction are as rounded as the file, in the number type of
/// fewest bytes that holds them. Throws UsageError for a form without a shader of its own.
TimedShader timedShader(const Representation& form);

/// The same for the formula of Lambert and lobes of GGX, with its numbers as constants: what forms
/// stand beside.
TimedShader lobesShader(int lobes);

/// The same without the form, which stores the cosine between wo and wi: what the measurement
/// takes.
TimedShader bareShader();

}  // namespace hshfit::gpu::inline timing
