#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::inline filtered_maps::inline exports {

/// The lobe of a map's model in closed form: Mustache templates of the statements of functions.
/// Their words are in gpu/shader_data.h and in `words` and `flags`. Directions are in the frame of
/// a facet, in the axes of D, and above its horizon. All take `node`, of which x and y are the
/// widths of D there, and z and w the parameters of the map's nodes.
struct LobeText {
    using Words = std::vector<std::pair<std::string, std::string>>;

    std::string_view axes;         ///< two numbers, which the others ask PREFIX_axes(node) for
    std::string_view density;      ///< D of h in 1/sr
    std::string_view terms;        ///< of wi and wo, up to three terms over D, times cos(theta_i)
    std::string_view smooth = {};  ///< of wi and wo, of the diffuse part over albedo / pi; none: 1
    Words words = {};
    std::vector<std::string> flags = {};
    std::vector<Words> indices = {};  ///< rows of the section "indices"
};

/// The lane of `node` that has the parameter k of the map's nodes.
constexpr std::string_view nodeLanes[] = {"node.z", "node.w"};

}  // namespace hshfit::inline filtered_maps::inline exports
