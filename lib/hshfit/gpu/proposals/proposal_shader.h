#pragma once

#include <hshfit/gpu/proposals/proposal_record.h>
#include <hshfit/gpu/shader.h>

#include <string>

namespace hshfit::gpu::inline proposals {

struct ProposalShaderOptions {
    std::string prefix = "hsh";  ///< of every name, that of the snippet before it
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

}  // namespace hshfit::gpu::inline proposals
