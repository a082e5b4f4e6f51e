#pragma once

#include "kept_shader.h"

#include <hshfit/brdf/directions.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/shader.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// A job that evaluates the same directions with a snippet and with C++.
namespace hshfit::shaders {

/// 64 x 64 pairs of directions that single precision holds exactly; a few of them below the
/// horizon.
struct Pairs {
    static constexpr int side = 64;
    std::vector<Direction> wo, wi;
};
Pairs directionPairs();

/// SH coefficients of a light, [slot][colour], that single precision holds exactly.
struct Environment {
    int order = 5;
    std::size_t colours = 3;
    std::vector<double> values;
};
Environment randomEnvironment(int order, std::size_t colours);

/// Tangent, bitangent and normal of surfaces in the world: the tangent is 0.6 of the horizontal one
/// and 0.8 of the upward one, so that no angle of the frame is special.
std::array<Direction, 3> frameOf(const Direction& normal);

/// The inputs that a snippet is run on.
struct ShaderJob {
    gpu::Payload payload;
    Pairs pairs;
    Environment environment;
    /// `shadeWorld` instead of `shade`: the surface of a pair has the normal wi and the tangent of
    /// `frameOf`, wo is in that frame, and the environment in the world.
    bool world = false;
    /// For a form (gpu/forms): where its numbers are, "constants", "block" or "texture"; it
    /// has no light, and evalRaw is eval. `payload` has the head and the texels.
    std::string form = {};
    /// Three uniform numbers in place of wi; outputs are as in tests/gpu/proposals.
    bool sampling = false;
    /// For a map of materials: its levels after the first, which is in `payload` with what the
    /// texels share as its basis texels, and u, v and level of each pair, which snippets take
    /// before wo.
    std::vector<gpu::Texels> levels = {};
    std::vector<double> places = {};
    /// For a map of filtered lobes with harmonics: all levels of these, from the map's level 1 on.
    std::vector<gpu::Texels> harmonics = {};

    std::size_t channels() const { return payload.head.channels.count(); }
    std::size_t lights() const { return environment.colours; }
    /// Per pair: evalRaw and eval for every channel, shade for every colour.
    std::size_t outputs() const { return sampling ? 5 + channels() : 2 * channels() + lights(); }
};
ShaderJob makeJob(gpu::Payload payload, int environmentOrder);

/// [pair][output], in double precision: sums by `Reconstruction` (with basis textures, by a lookup
/// of its own), shade as a quadrature of the reconstruction times the light, for every seventh
/// pair; NaN for the others, which `compare` leaves out.
std::vector<double> reference(const ShaderJob& job);

/// The reference relative to the largest magnitude, of eval and shade each.
Wanted wantedOf(const ShaderJob& job, std::span<const double> expected);

/// Values [pair][channel], which a shader writes as evalRaw and as eval; any light will do.
Wanted writtenTwice(const ShaderJob& job, std::span<const double> values,
                    std::span<const double> scales);

/// Largest difference, of the largest magnitude, of eval and shade each.
struct Difference {
    double eval = 0, shade = 0;
};
Difference compare(const ShaderJob& job, std::span<const double> expected,
                   std::span<const float> found);

}  // namespace hshfit::shaders
