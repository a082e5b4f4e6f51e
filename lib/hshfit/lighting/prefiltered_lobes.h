#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/lighting/elevation_table.h>
#include <hshfit/lighting/prefilter.h>

#include <cstddef>
#include <vector>

namespace hshfit::lighting {

/// A BRDF as lookups in an environment that an engine has prefiltered, whatever its light:
///     radiance = max(0, d P(n, 1) + sum over k of s_k P(axis_k, r_k))
/// P(a, r) is the engine's lookup about an axis a at roughness r (prefilter.h); P(n, 1) is the
/// irradiance over pi. d, s_k (RGB), r_k and axis_k depend on the view.
///
/// For each row they are those whose kernel is nearest to f cos(theta_i): least squares of the
/// coefficients of both in spherical harmonics of 64 bands, band l with the weight 0.3 / l, and
/// band 0, the albedo, with 100. Light takes no part.
///
/// Texels of a row: R, G, B of d; for each lobe R, G, B of s and r. Where lobes are their own
/// mirror images (lobesInPlane) a texel for every four lobes follows with the angles of the axes
/// from the normal, away from the viewer, radians. Else an axis for each lobe follows: its x, y, z
/// in the frame in which wo has y = 0.
struct PrefilteredTable {
    static constexpr std::size_t mostLobes = 6;
    static constexpr int bands = 64;

    const Prefilter* engine = nullptr;
    std::size_t lobes = 0;
    bool inPlane = true;
    ElevationTable table = {};
    /// The rest of the weighted squares in each row, as the root of its share.
    std::vector<double> residuals = {};
    /// Squares of f cos(theta_i) and of what the lobes leave, for turnedError: [row][channel][l].
    std::vector<double> squares = {}, left = {};
};

/// The relative error of the radiance under lights of every turn, the mean over theta_o of
///     sqrt(sum over l of E_l |D_l|^2 / (2 l + 1) / the same with f in place of D),
/// where E_l is the sum of squares of the lights' coefficients in band l, and |D_l|^2 the sum of
/// squares of the coefficients of f cos(theta_i) less the lobes, over channels and 64 bands. Errors
/// between rows and within texels of cubes are not seen.
double turnedError(const PrefilteredTable& table, std::span<const Light> lights);

/// With 1 to `mostLobes` lobes. Throws UsageError for another number and for channels that are not
/// grey or RGB; NumericError where f is not finite.
PrefilteredTable fitPrefiltered(const Brdf& brdf, const Prefilter& engine, std::size_t lobes,
                                ElevationRows rows = {},
                                std::size_t azimuthSteps = AzimuthNodes::defaultSteps);

/// Radiance of a surface in the world under the engine's cube; `tangent` as in HarmonicShading.
Rgb radiance(const PrefilteredTable& table, const EnvironmentCube& cube, const Direction& normal,
             const Direction& viewer, const Direction& tangent = {0, 0, 0});

}  // namespace hshfit::lighting
