#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The lobe of FacetNormals in closed form for shaders, in the axes of D: Mustache templates of the
/// statements of functions, with words of the language (gpu/shader_data.h), `numbers` and `flags`.
struct FacetText {
    /// A number of the statements: a parameter of the model, at its value.
    struct Number {
        std::string word, parameter;
        double value = 0;
    };
    std::string_view axes;         ///< of alpha along x and y, from `node`, by PREFIX_axes(node)
    std::string_view density;      ///< of D(h) in 1/sr
    std::string_view terms;        ///< of three terms of the lobe over D, times cos(theta_i)
    std::string_view smooth = {};  ///< of the smooth term, where it is not 1
    std::vector<Number> numbers = {};
    std::vector<std::string> flags = {};
    /// Indices of refraction, each "ior" and "k", of exact reflectances.
    std::vector<std::vector<Number>> indices = {};
};

/// Text for the D of GGX or of a Gaussian of slopes, with Smith's masking or with the factor of one
/// of the variants of Ward's model; `flags` choose.
FacetText facetText(std::vector<FacetText::Number> numbers, std::vector<std::string> flags);

}  // namespace hshfit::brdfs
