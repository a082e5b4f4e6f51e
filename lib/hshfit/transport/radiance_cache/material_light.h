#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/light/lights.h>
#include <hshfit/transport/radiance_cache/incoming_functions.h>
#include <hshfit/transport/surface_scene.h>

#include <cstdint>
#include <string>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

/// The way in which a material gets its indirect light.
enum class LightWay {
    irradiance,    ///< diffuse: records of one number for each colour
    coefficients,  ///< the dot product of the coefficients of light and of f cos(theta_i)
    sampled,       ///< directions drawn from its sampler
};

struct MaterialChoiceOptions {
    std::string basis = "hsh";
    int order = 10;  ///< the highest
    /// The share of the energy of f cos(theta_i), over all outgoing directions, that may be lost:
    /// each material gets the lowest order within it, and is sampled where there is none.
    double loss = 0.005;
};

/// A material's reflection as coefficients by outgoing direction, or the reason for none.
struct MaterialLight {
    LightWay way = LightWay::sampled;
    Rgb diffuse{};           ///< f, for irradiance
    std::uint32_t kind = 0;  ///< of the functions, for the other records
    int order = 0;
    double loss = 0;     ///< of energy at that order, or at the highest
    std::string reason;  ///< of sampling, where it is not the loss
    int walks = 1;       ///< of each line of sight, if sampled

    std::size_t channels = 0;
    OutgoingSet outgoing = {};
    std::vector<float> values = {};  ///< [outgoing][channel][function]

    /// Coefficients of f cos(theta_i) for an outgoing direction: out[channel][function].
    void at(const IncomingFunctions& functions, const Direction& wo, float* out) const;
};

/// Functions and materials of a scene. kinds[0] is irradiance.
struct MaterialLights {
    std::vector<IncomingFunctions> kinds = {};
    std::vector<MaterialLight> materials = {};
};

/// Chooses a way for each material. Throws UsageError for an unknown basis, one that is not
/// orthonormal, and orders that it cannot have.
MaterialLights chooseLight(const SurfaceScene& scene, const MaterialChoiceOptions& options);

}  // namespace hshfit::inline transport::inline radiance_cache
