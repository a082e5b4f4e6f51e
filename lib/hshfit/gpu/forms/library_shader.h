#pragma once

#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/forms/function_table.h>
#include <hshfit/gpu/shader.h>

#include <cstddef>
#include <memory>
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
    /// The functions as a table. A material then has a texel with t and the number n of texels of
    /// the table that it needs, and three for each: the q_k of four functions for R, for G and for
    /// B, q_0 being 1. Beyond n all are 0.
    std::shared_ptr<const FunctionTable> table = {};
    /// The texels of the first material, of the second, …; without a table the fourth lanes are 0.
    std::vector<double> materials;
    /// Further texels of each material, whole numbers up to 2048, which `f` does not need:
    /// proposals for sampling (proposals/proposal_shader.h). [material][further][lane]
    std::vector<double> furtherTexels = {};
    std::size_t further = 0;

    std::size_t stride() const {  ///< texels of a material
        return 1 + (table ? 3 * table->groups() : parts.size());
    }
    std::size_t width() const { return stride() + further; }  ///< with the further texels
    std::size_t count() const { return materials.size() / (4 * stride()); }
};

/// The same with a table; q_k of more than 2048 are rounded to halves.
SharedSums tabledSums(const SharedSums& sums, const TableSize& size);

/// The texels of all materials in float16: a row for each material, 2048 of them a layer, the
/// further ones last.
Texels materialTexels(const SharedSums& sums);

/// A snippet with one function for all materials:
///     PREFIX_material(material, wo, wi)     f(wo, wi) in 1/sr, linear Rec. 709
/// `material` counts from 0. The functions stand in the text, or are looked up in the table, a
/// second texture with a filter; the texels of the materials are read like the texels of a form in
/// a texture (form_shader.h). Throws UsageError for OSL, whose textures take no whole numbers as
/// places.
std::string libraryShaderSource(Language language, const SharedSums& sums,
                                const std::string& prefix);

}  // namespace hshfit::gpu::inline forms
