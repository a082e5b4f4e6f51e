#pragma once

#include "bound_shader.h"

#include <limits>
#include <span>
#include <string>
#include <vector>

/// Shaders of tests kept in a folder, with the values that they have to give, so that another
/// machine can run them (tests/gpu/device.sh).
namespace hshfit::shaders {

/// The values that a shader has to write, [invocation][output].
struct Wanted {
    std::vector<double> values;  ///< NaN where any value will do
    std::vector<double> scales;  ///< that differences are divided by, one for each value
};

/// The largest difference over its scale. A NaN counts as 1e30.
double largestDifference(const Wanted& wanted, std::span<const float> found);

/// The most that a difference may be over its scale.
struct Bounds {
    double software;
    double gpu;  ///< whose filters blend texels with weights of 8 bits

    /// On the device of this run of tests: a GPU with HSHFIT_TEST_GPU set.
    double here() const;
};

/// Shaders of this kind are timed. They take the number of their evaluations at binding 3, and
/// their names begin with two digits, by which they are sorted.
constexpr const char* timedKind = "timed";

struct KeptShader {
    std::string kind;      ///< shaders of one kind share a row of the table
    std::string language;  ///< "glsl", "hlsl", …
    std::string name;
    BoundShader shader;
    Wanted wanted = {};  ///< nothing for shaders that are timed only
    Bounds bounds = {};
};

/// Writes NAME.json, with a name made from the members, and the numbers as files named by their
/// checksums, so that shaders share them.
void keepShader(const std::string& folder, const KeptShader& kept);
/// The paths of kept shaders, sorted by name.
std::vector<std::string> keptShaders(const std::string& folder);
KeptShader readKeptShader(const std::string& path);

}  // namespace hshfit::shaders
