#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// GLSL 4.50 of a weighted sum of `lambert` and isotropic `ggx` with Schlick's reflectance and
/// correlated masking, `vec3 hsh_eval(vec3 wo, vec3 wi)` with its numbers as constants; 0 below the
/// horizon. To measure what such a material costs in a shader. None for any other specification;
/// throws UsageError for one that cannot be parsed.
std::optional<std::string> lobeShader(std::string_view spec);

}  // namespace hshfit::brdfs
