#pragma once

#include <hshfit/transport/radiance_cache/hemisphere_strata.h>
#include <hshfit/transport/radiance_cache/surface_irradiance.h>

#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The gradient of a record's coefficients under motion along the surface.
enum class Gradient {
    none,
    /// The points that rays have met stay, and their directions and solid angles change (Gautron et
    /// al. 2004, after Eq. 22). Blind to what comes into sight.
    hitPoints,
    /// The edges between strata move at the nearer of the two distances (Ward & Heckbert 1992):
    /// sees what comes into sight, and is 0 under even light.
    strata,
};

/// Incident radiance at a point of a surface, by coefficients in its frame, and how they change.
struct Record {
    Point position{};
    Frame frame{Orientation{}};
    std::uint32_t kind = 0;  ///< of IncomingFunctions
    double radius = 0;       ///< R_i of Eq. 23
    double longRadius = 0;   ///< along longAxis, where it is larger
    Direction longAxis{1, 0, 0};
    double distance = 0;  ///< harmonic mean of the distances met; a miss counts as infinite
    /// [part][R, G, B][function]: coefficients, their derivatives per length along the frame's
    /// tangent and bitangent and, for irradiance, their derivatives by turns about these two.
    std::vector<float> values = {};

    static std::size_t partsOf(const IncomingFunctions& functions) {
        return functions.basis() ? 3 : 5;
    }
    static std::size_t valuesOf(const IncomingFunctions& functions) {
        return partsOf(functions) * 3 * functions.size();
    }
    std::span<const float> part(std::size_t k, std::size_t functions) const {
        return {values.data() + k * 3 * functions, 3 * functions};
    }
    std::span<float> part(std::size_t k, std::size_t functions) {
        return {values.data() + k * 3 * functions, 3 * functions};
    }
};

/// The light that a record's rays meet: radiance from `met` towards its wo, adding the rays traced.
struct GatherScene {
    const LightWalk* walk = nullptr;
    const SurfaceIrradiance* surfaces = nullptr;
    /// Shorter distances count as this one in derivatives: nothing that near is told apart.
    double nearest = 0;
};

struct Gathered {
    Record record;  ///< radii are left 0
    /// [xx, xy, yy][function], if the strata have bends: second derivatives along the frame's
    /// tangent and bitangent, R, G and B together, by the edges between strata as for the gradient.
    std::vector<float> bends = {};
    bool sound = true;  ///< numbers are finite, and rays do not start on another surface
};

/// Traces one ray into each cell and makes a record of what they find (Eq. 22, stratified): the
/// mean radiance is taken out of the sum and put back by its exact coefficients, so that even light
/// has no noise.
Gathered gather(const SurfaceHit& hit, std::uint32_t kind, const IncomingFunctions& functions,
                const HemisphereStrata& strata, Gradient gradient, const GatherScene& scene,
                RandomNumbers random, std::size_t& rays);

}  // namespace hshfit::inline transport::inline radiance_cache
