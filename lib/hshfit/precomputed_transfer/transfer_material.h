#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/light/lights.h>

#include <optional>
#include <span>
#include <string>

namespace hshfit::inline precomputed_transfer {

/// A material as precomputed transfer sees it.
struct TransferMaterial {
    std::string name, source;  ///< the source is the BRDF's specification
    /// f is constant: all of its reflection is in `albedo`, exactly.
    bool diffuse = true;
    /// pi f, or the albedo under light from everywhere, the mean of directional albedos weighted
    /// with cos(theta_o).
    Rgb albedo{};
    /// f cos(theta_i) in HSH, for the product with matrices: by elevation, or on the parabolic map
    /// of directions if anisotropic; none where it is diffuse or was not asked for.
    std::optional<Coefficients> response = {};

    /// Coefficients over wi for an outgoing direction of the frame, [R, G, B][slot]. Directions
    /// below the horizon, which interpolated normals bring about, count as on it. Needs a response.
    void towards(const Direction& wo, std::span<double> out) const;
};

/// `localOrder` bands of HSH in the response; 0: none. Throws UsageError for a BRDF of spectra,
/// NumericError as `project` does.
TransferMaterial transferMaterial(const std::string& name, const Brdf& brdf, int localOrder);

/// Elevations at which a response is kept, and width and height of an anisotropic one's map.
constexpr int responseElevations = 32, responseSide = 32;

}  // namespace hshfit::inline precomputed_transfer
