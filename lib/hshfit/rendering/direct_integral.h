#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/light/light_samples.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace hshfit::inline rendering {

struct IntegrationOptions {
    /// The bound of the estimated error over the radiance, summed over R, G and B. It is a sum of
    /// magnitudes of differences between two levels; the error itself is about a tenth of it
    /// (tests/lib/rendering).
    double tolerance = 5e-3;
    /// Evaluations of f at a point after which the rest is taken as it is.
    std::size_t maxEvaluations = std::size_t{1} << 18;
};

/// Outgoing radiance at a point, by direct integration.
struct PointRadiance {
    Rgb radiance{};
    double error = 0;             ///< estimated, summed over R, G and B
    std::size_t evaluations = 0;  ///< of f
    std::size_t notFinite = 0;    ///< values of f that were left out
    bool cut = false;             ///< ended by maxEvaluations
};

/// L(wo) = integral of L_i(wi) f(wi, wo) cos(theta_i) over the hemisphere above a surface, without
/// shadows, for f grey or RGB. Pictures, and skies as pictures of 1024 columns, are cut into cells,
/// each one direction with the cell's flux, and panels into cells of 3 x 3 Gauss nodes: wherever
/// four parts of a cell differ from the whole, they are cut further, and about the lobes of f
/// always, so that narrow ones are not missed. Discs and directional lights are sampled by
/// sampleLights at growing levels. Immutable; safe to use from many threads.
class DirectIntegral {
public:
    /// `tolerance`: the least that `at` is asked for, which decides how coarse its first cells are.
    explicit DirectIntegral(std::span<const Light> lights,
                            double tolerance = IntegrationOptions{}.tolerance);
    ~DirectIntegral();
    DirectIntegral(const DirectIntegral&) = delete;
    DirectIntegral& operator=(const DirectIntegral&) = delete;

    /// `wo` in the frame, above its horizon. `underEven`: the part from even light, if it is known.
    PointRadiance at(const Brdf& brdf, const Frame& frame, const Direction& wo,
                     const IntegrationOptions& options = {},
                     const std::optional<PointRadiance>& underEven = {}) const;

    /// Radiance of all lights that shine alike from all around.
    Rgb evenRadiance() const;

    /// The angle in radians over which the light, but for its edges, falls to 1/e at the most. It
    /// is known of skies whose brightness about the sun is an exponential, and about a quarter of
    /// the shortest wave of a series of coefficients; 0 with any other light.
    double finest() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace hshfit::inline rendering
