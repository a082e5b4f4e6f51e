#pragma once

#include <hshfit/gpu/proposals/proposal_record.h>
#include <hshfit/gpu/shader.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::gpu::inline proposals {

struct ProposalShaderOptions {
    std::string prefix = "hsh";  ///< of every name, the same as in the snippet before it
    bool cosine = false;         ///< whether PREFIX_eval gives f cos(theta_i); for the comment
};

/// Text that goes after the snippet of the same prefix (shader.h, forms/form_shader.h):
///     PREFIX_sample(wo, u1, u2, u3)  a direction in proportion to the density, from uniform
///     numbers
///                                    in [0, 1); the zero vector if wo is not above the horizon
///     PREFIX_pdf(wo, wi)             its density per steradian; integrates to 1 over the
///     hemisphere PREFIX_lobePdf(…)              density of one lobe
/// The rows stand in the text as constants. It has no loop, no texture and no trigonometric
/// function; angles go through polynomials, which agree with the library's to single precision.
std::string proposalSource(Language language, const ProposalRecord& record,
                           const ProposalShaderOptions& options = {});

/// An isotropic proposal as lanes of texels, one texel for each row: share and width code of the
/// first lobe, then of the second, with 256 added to the width code of a retro lobe. Half precision
/// holds these whole numbers. Throws UsageError for one that is not isotropic.
std::vector<double> proposalTexels(const Proposal& proposal);

/// Proposals of many materials in the texture of a snippet with one function for all of them
/// (forms/library_shader.h).
struct MaterialProposals {
    std::string prefix = "hsh";  ///< of the snippet
    std::size_t first = 0;       ///< the texel of a material that has the first row
    std::size_t rows = 0;        ///< of one row, the texels have it twice
};

/// Text that goes after that snippet, with `sample` and `pdf` of every material:
///     PREFIX_material_sample(material, wo, u1, u2, u3)
///     PREFIX_material_pdf(material, wo, wi)
/// In Metal the texture of the materials comes before the material. Throws UsageError for OSL.
std::string materialProposalSource(Language language, const MaterialProposals& proposals);

}  // namespace hshfit::gpu::inline proposals
