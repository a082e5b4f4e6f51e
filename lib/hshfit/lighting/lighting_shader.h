#pragma once

#include <hshfit/gpu/shader.h>
#include <hshfit/lighting/elevation_table.h>
#include <hshfit/lighting/prefilter.h>

#include <cstddef>
#include <span>
#include <string>

namespace hshfit::lighting {

/// A model as a shader sees it. The function is called PREFIX_coefficients(n, wo, light),
/// PREFIX_splitSum(n, wo, irradiance), PREFIX_ltc(n, wo, c0, c1, c2, c3) or PREFIX_prefiltered(n,
/// wo), all in the world, and gives what the library's `radiance` does, in single precision. With
/// several azimuths, the tangent follows n. With `materials` the function takes the number of a
/// material first.
struct LightingShader {
    enum class Kind { coefficients, splitSum, cosines, prefiltered };
    Kind kind = Kind::coefficients;
    int order = 0;           ///< of coefficients
    std::size_t levels = 0;  ///< of the cube
    std::size_t taps = 0;    ///< of a split sum whose lobes are not their own mirror images
    const Prefilter* engine = nullptr;  ///< of prefiltered
    std::size_t lobes = 0;              ///< of prefiltered
    bool inPlane = true;                ///< lobes are their own mirror images
    /// For prefiltered with one azimuth: the table has a row of texels for each material, in which
    /// the material's rows by elevation follow one another.
    bool materials = false;
    ElevationRows rows = {};
    AzimuthNodes azimuths = {};
    std::size_t texels = 0;  ///< of a row
    std::string prefix = "hsh";
    std::string source, generator;  ///< for comments
};

/// The name of the function without its prefix: coefficients, splitSum, ltc or prefiltered.
std::string lightingFunction(const LightingShader& shader);

/// The languages that have such shaders: GLSL ES, GLSL, HLSL, Slang and WGSL.
std::span<const gpu::Language> lightingLanguages();

/// The snippet. Throws UsageError for a language without one and for a prefix that no shading
/// language takes.
std::string lightingShaderSource(gpu::Language language, const LightingShader& shader);

}  // namespace hshfit::lighting
