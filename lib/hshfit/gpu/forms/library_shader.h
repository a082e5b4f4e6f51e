#pragma once

#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/shader.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::gpu::inline forms {

/// Materials that are exponentials of sums of shared functions, as a GPU reads them:
///     f = max(exp(min(Phi_0 + sum_k q_k Phi_k, top)) - offset, 0),   top = topFirst + topStep t,
/// Phi_0 (the mean) and Phi_k (the components) being sums of the functions of the halfway form
/// (halfway_terms.h), smooth and of the lobe together.
struct SharedSums {
    /// Kind halfway; channel k has the coefficients of Phi_k.
    Representation functions;
    double offset = 0, topFirst = 0, topStep = 1;
    /// A texel: scale times its R, G and B is a part of q_k of function k.
    struct Part {
        std::size_t function = 0;
        double scale = 1;
    };
    std::vector<Part> parts;  ///< of a material; one more texel has t
    /// Texels that have, in place of parts, the coefficients of a material's own sum
    /// Phi_0 + sum_k q_k Phi_k, in the order of halfwayStream; 0: parts.
    std::size_t folded = 0;
    /// The texels of the first material, of the second, …; the fourth lanes are 0.
    std::vector<double> materials;

    std::size_t stride() const { return parts.size() + folded + 1; }  ///< texels of a material
    std::size_t count() const { return materials.size() / (4 * stride()); }
};

/// The same materials with a sum each: a pair costs one sum for three channels instead of one for
/// every function, and a material takes as many numbers as that sum has.
SharedSums foldedSums(const SharedSums& sums);

/// The texels of all materials in float16, one after another in rows of `formWidth`.
Texels materialTexels(const SharedSums& sums);

/// A snippet with one function for all materials:
///     PREFIX_material(material, wo, wi)     f(wo, wi) in 1/sr, linear Rec. 709
/// `material` counts from 0. The functions stand in the text; the texels of the materials are read
/// as those of a form in a texture (form_shader.h), stride() of them. Throws UsageError for OSL,
/// whose textures take no whole numbers as places.
std::string libraryShaderSource(Language language, const SharedSums& sums,
                                const std::string& prefix);

}  // namespace hshfit::gpu::inline forms
