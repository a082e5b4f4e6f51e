#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/irradiance/irradiance.h>
#include <hshfit/lighting/elevation_table.h>
#include <hshfit/lighting/environment_cube.h>
#include <hshfit/lighting/lobe_kernel.h>

#include <cstddef>
#include <span>

namespace hshfit::lighting {

/// A split sum for one isotropic BRDF, in the place of the split sum for GGX of Karis 2013, "Real
/// Shading in Unreal Engine 4":
///     radiance = even(theta_o) E(n) / pi + rest(theta_o) P(axis(theta_o), level(theta_o))
/// E is irradiance in nine coefficients, P the light convolved with the BRDF's own lobe
/// (lobe_kernel.h), twice as wide from level to level. Axis and level are such that the first
/// moment of the lobe is kept: exact under light that is constant or linear in the direction, but
/// for interpolation between rows. A row is two texels: R, G, B of `even` and the level; R, G, B of
/// `rest` and the axis' angle from the normal, away from the viewer, radians.
struct SplitSumTable {
    LobeKernel kernel;
    double misplaced = 0;    ///< the share of the light, the mean over rows
    double firstScale = 1;   ///< of the kernel at level 0
    std::size_t levels = 1;  ///< scale doubles from each to the next
    double firstWidth = 1;   ///< acos of the mean cosine at level 0, radians
    ElevationTable table = {};

    std::size_t bytes() const { return table.values.size() * sizeof(float); }
};

/// The even part is taken with the one of evenShares that misplaces the least light.
/// Throws UsageError for a BRDF that is not isotropic; NumericError where f is not finite.
SplitSumTable fitSplitSum(const Brdf& brdf, ElevationRows rows = {});

/// The light convolved for a table. The face of level 0 is the power of two that has four texels in
/// the width of its kernel, at most `mostFace`.
EnvironmentCube prefilter(const SplitSumTable& table, std::span<const Light> lights,
                          std::size_t mostFace = 128);

/// Nine coefficients of the irradiance of `lights`.
irradiance::NineRgb irradianceNine(std::span<const Light> lights);

/// Radiance of a surface in the world.
Rgb radiance(const SplitSumTable& table, const EnvironmentCube& cube,
             const irradiance::NineRgb& irradiance, const Direction& normal,
             const Direction& viewer);

}  // namespace hshfit::lighting
