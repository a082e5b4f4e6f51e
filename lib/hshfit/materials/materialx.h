#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline materials {

/// One input of a shading node: a number, a colour in linear Rec. 709, or a tangent.
struct MaterialXInput {
    std::string name;
    std::vector<double> values;  ///< 1: float, 3: color3
    /// The one value is an angle in degrees, by which the surface's tangent is turned about its
    /// normal, counter-clockwise as seen from outside: a vector3 in the world.
    bool tangent = false;
};

/// A MaterialX 1.39 document (Academy Software Foundation) with one `node`, such as "gltf_pbr",
/// a surfacematerial of it, and the nodes tangent, normal and rotate3d for each turned tangent
/// (rotate3d turns clockwise where its amount is positive); `doc` is the material's own
/// description. Names become valid ones of MaterialX: letters, digits and underscores. Throws
/// NumericError for a number that is not finite, UsageError for other counts of values.
std::string materialXText(std::string_view name, std::string_view node,
                          const std::vector<MaterialXInput>& inputs, std::string_view doc);

/// The name of the surfacematerial.
std::string materialXName(std::string_view name);

}  // namespace hshfit::inline materials
