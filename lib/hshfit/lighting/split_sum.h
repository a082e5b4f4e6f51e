#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/irradiance/irradiance.h>
#include <hshfit/lighting/elevation_table.h>
#include <hshfit/lighting/environment_cube.h>
#include <hshfit/lighting/lobe_kernel.h>

#include <cstddef>
#include <span>

namespace hshfit::lighting {

/// A split sum for one BRDF, in the place of the split sum for GGX of Karis 2013, "Real
/// Shading in Unreal Engine 4":
///     radiance = even(wo) E(n) / pi + rest(wo) sum over k of w_k P(axis_k(wo), level(wo))
/// E is irradiance in nine coefficients, P the light convolved with the BRDF's own lobe
/// (lobe_kernel.h), twice as wide from level to level. Axis and level are such that the first
/// moment of the lobe is kept: exact under light that is constant or linear in the direction, but
/// for interpolation between rows.
///
/// Where lobes are their own mirror image (lobesInPlane), there is one tap, and a row is two
/// texels: R, G, B of `even` and the level; R, G, B of `rest` and the axis' angle from the normal,
/// away from the viewer, radians. Else taps spread a lobe along its widest direction (lobe_taps.h),
/// and a row is three texels: R, G, B of `even` and the level; R, G, B of `rest` and s cos(2 p);
/// the axis and s sin(2 p), for a spread of s radians at the angle p of AcrossAxis.
struct SplitSumTable {
    LobeKernel kernel;
    double misplaced = 0;    ///< the share of the light, the mean over rows
    double firstScale = 1;   ///< of the kernel at level 0
    std::size_t levels = 1;  ///< scale doubles from each to the next
    std::size_t taps = 0;    ///< 0: rows of two texels
    double firstWidth = 1;   ///< acos of the mean cosine at level 0, radians
    ElevationTable table = {};
};

/// The even part is taken with the one of evenShares that misplaces the least light, and taps are
/// the fewest, of 1 to 9, with less than 1.02 times the least.
/// Throws NumericError where f is not finite.
SplitSumTable fitSplitSum(const Brdf& brdf, ElevationRows rows = {},
                          std::size_t azimuthSteps = AzimuthNodes::defaultSteps);

/// The light convolved for a table. The face of level 0 is the power of two that has four texels in
/// the width of its kernel, at most `mostFace`.
EnvironmentCube prefilter(const SplitSumTable& table, std::span<const Light> lights,
                          std::size_t mostFace = 128);

/// Nine coefficients of the irradiance of `lights`.
irradiance::NineRgb irradianceNine(std::span<const Light> lights);

/// Radiance of a surface in the world; `tangent` as in HarmonicShading.
Rgb radiance(const SplitSumTable& table, const EnvironmentCube& cube,
             const irradiance::NineRgb& irradiance, const Direction& normal,
             const Direction& viewer, const Direction& tangent = {0, 0, 0});

}  // namespace hshfit::lighting
