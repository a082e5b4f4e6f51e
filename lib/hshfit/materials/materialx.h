#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline materials {

/// One input of a shading node: a number, or a colour in linear Rec. 709.
struct MaterialXInput {
    std::string name;
    std::vector<double> values;  ///< 1: float, 3: color3
};

/// A MaterialX 1.39 document (Academy Software Foundation) with one `node`, such as "gltf_pbr",
/// and a surfacematerial of it; `doc` is the material's own description. Names become valid
/// ones of MaterialX: letters, digits and underscores.
/// Throws NumericError for a number that is not finite, UsageError for other counts of values.
std::string materialXText(std::string_view name, std::string_view node,
                          const std::vector<MaterialXInput>& inputs, std::string_view doc);

/// The name of the surfacematerial.
std::string materialXName(std::string_view name);

}  // namespace hshfit::inline materials
