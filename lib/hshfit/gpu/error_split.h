#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/payload.h>

#include <cstddef>
#include <functional>
#include <optional>

namespace hshfit::gpu {

/// Error of an exported representation against the BRDF that was projected, and its causes.
/// With |x| the root mean square of x cos(theta_i) over wi (d omega), `outgoing` directions spread
/// evenly over the hemisphere (not the map's own) and channels, each relative to |f|:
///     truncation     |f - A|   A: f projected at each of these directions themselves
///     interpolation  |A - I|   I: f projected at the map's directions, interpolated
///     form           |I - B|   B: the coefficients, interpolated: a window, factors, fewer bits
///     quantisation   |B - C|   C: the same as stored: rounded, and without chroma bands left out
///     total          |f - C|
/// The causes add in squares where they are independent; the total is measured, not summed.
struct ErrorSplit {
    double truncation = 0, interpolation = 0, form = 0, quantisation = 0, total = 0;
    double meanLog = 0;  ///< of C: mean |ln(1 + f c) - ln(1 + g c)|, negative g clamped
    std::size_t outgoing = 0;
};

struct ErrorSplitOptions {
    std::size_t outgoing = 64;
    double tolerance = 0;  ///< of the projections; 0: the BRDF's own
    int level = 2;         ///< of the quadrature (CompareOptions)
    /// Whether the coefficients are a plain projection of f, in which case I = B. Otherwise f is
    /// projected once more, at the map's directions.
    bool plain = true;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// `payload` was packed from `coefficients`. A single outgoing direction (map `direction`) is
/// measured at itself, without interpolation.
/// Throws NumericError where f is 0 or does not project.
ErrorSplit splitError(const Brdf& f, const Coefficients& coefficients, const Payload& payload,
                      const ErrorSplitOptions& options = {});

/// Largest and root-mean-square difference of bilinear lookups in the basis textures from the basis
/// itself over 4096 directions, the largest also above 6 degrees of elevation alone.
struct BasisTextureError {
    double largest = 0, largestAbove6 = 0, rms = 0;
};
/// None where the payload has no basis textures.
std::optional<BasisTextureError> basisTextureError(const Payload& payload);

}  // namespace hshfit::gpu
