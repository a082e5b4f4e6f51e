#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/lighting/environment_cube.h>

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace hshfit::lighting {

/// An environment as an engine prefilters it for GGX: level j of its cube map is the light
/// convolved with the kernel of one roughness r (alpha = r^2),
///     P_r(gamma) proportional to alpha^2 max(cos gamma, 0) / (h^2 (alpha^2 - 1) + 1)^2,
///     h^2 = (1 + cos gamma) / 2, the integral over the sphere 1,
/// GGX seen along the normal and weighted by the cosine (Karis 2013, "Real Shading in Unreal Engine
/// 4"). At r = 1 it is cos gamma / pi: the irradiance over pi. A lookup at any roughness mixes two
/// levels linearly.
struct Prefilter {
    std::string_view name, help;
    std::size_t levels = 0;  ///< 0: the mirror image; the last: roughness 1
    /// The level of a roughness in [0, 1] among `levels`, from 0 to levels - 1.
    double (*level)(double roughness, std::size_t levels) = nullptr;
    /// The level as a shader's expression in the roughness r, with {0} for the last level.
    const char* formula = nullptr;

    double levelOf(double roughness) const { return level(roughness, levels); }
    /// The roughness of a level, by bisection of levelOf: 0 for level 0.
    double roughnessOf(double level) const;
};

/// One row for each engine, with the formula from the engine's source
/// (docs/explanation/prefiltered.md).
std::span<const Prefilter> prefilters();
/// Throws UsageError with the known names.
const Prefilter& prefilterNamed(std::string_view name);

/// Zonal coefficients of P_r, bands 0 to bands - 1: p_l = integral of P_r P_l(cos gamma), p_0 = 1.
std::vector<double> kernelBands(double roughness, int bands);
/// The same for each level.
std::vector<std::vector<double>> levelBands(const Prefilter& prefilter, int bands);
/// The same for a lookup at a place among these levels, which mixes the two levels beside it.
std::vector<double> lookUpBands(std::span<const std::vector<double>> levels, double place);

/// The engine's cube of the light. The last level has faces of `lastFace` texels, 8 in engines, and
/// each before it twice as many. Level 0 has the mean over each texel, and the others are made from
/// it, as engines do.
EnvironmentCube prefiltered(const Prefilter& prefilter, std::span<const Light> lights,
                            std::size_t lastFace = 8);

}  // namespace hshfit::lighting
