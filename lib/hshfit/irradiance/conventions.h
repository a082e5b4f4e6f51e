#pragma once

#include <hshfit/irradiance/irradiance.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline irradiance {

/// An engine's way to hold nine coefficients of light: the seven facts that have to be right, and
/// its numbers.
struct Convention {
    std::string_view name;  ///< as on the command line
    std::string_view engine;
    std::string_view signs;       ///< of functions of odd m
    std::string_view up;          ///< the axis, and our axes in the engine's
    std::string_view handedness;  ///< of the engine's axes
    std::string_view quantity;    ///< raw radiance, or convolved with the clamped cosine
    std::string_view divided;     ///< whether divided by pi
    std::string_view constants;   ///< whether constants of the basis are in the numbers
    std::string_view order;       ///< of l and m
    std::string_view source;      ///< the engine's code that was read
    std::string_view evidence;    ///< how the row was checked
    /// Degrees about +z by which light is turned before the numbers are taken. The numbers then
    /// equal the ones that the engine itself makes from the same panorama by `import`. No engine
    /// mirrors.
    double turn = 0;
    std::string_view import;
    Direction (*toEngine)(const Direction& world);
    /// Rows of numbers from raw coefficients in the engine's axes.
    std::vector<std::vector<double>> (*pack)(const NineRgb& radiance);
    std::string_view (*shader)();  ///< text with the place of the numbers, "@VALUES@"
    bool hlsl = false;             ///< the language of `shader`, otherwise GLSL
    int bands = 3;                 ///< that the numbers hold
    std::size_t redundant = 0;  ///< numbers at the end that texts may lack, and that are not read
};

/// three, unity, unity-csharp, filament, godot, unreal, babylon, gltf, playcanvas, cesium,
/// geomerics.
std::span<const Convention> conventions();
/// "all" or a name; throws UsageError with the names.
std::vector<const Convention*> selectConventions(std::string_view name);

/// The numbers of an engine for light whose coefficients in our world are `radiance`.
std::vector<std::vector<double>> engineValues(const Convention& convention,
                                              const NineRgb& radiance);
/// A function in the engine's language that holds the numbers and gives E / pi, or for three E,
/// at a normal in the engine's axes.
std::string engineShader(const Convention& convention, const NineRgb& radiance);

}  // namespace hshfit::inline irradiance
