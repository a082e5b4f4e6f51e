#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/sampler.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace hshfit::inline sampling {

/// One lobe of a proposal: visible normals of GGX (visible_normals.h), in four bytes.
struct ProposalLobe {
    std::uint8_t share = 0;               ///< in 255ths
    std::uint8_t widthX = 0, widthY = 0;  ///< proposalWidth
    std::uint8_t retro = 0;               ///< 1: turned by 180 degrees about the normal
};

/// 1e-4 * 20000^(code / 255): from 1e-4 to 2 in steps of 4 %.
double proposalWidth(std::uint8_t code);

/// A small density for a BRDF, as shaders can store it: for each bin of outgoing elevation
/// (elevation_bins.h) two lobes, and the cosine with the rest of the shares, 8/255 or more:
///     pdf = (1 - share_0 - share_1) cos / pi + sum_k share_k ggx_k(wo, wi)
/// Eight bytes per elevation.
struct Proposal {
    using Row = std::array<ProposalLobe, 2>;
    std::vector<Row> rows;

    std::size_t bytes() const { return rows.size() * sizeof(Row); }
};

struct ProposalOptions {
    std::size_t elevations = 16;
};

/// The lobes that minimise the second moment of f cos / pdf, |f| averaged over channels, at the
/// middle of each bin (over three azimuths if f is not isotropic): the best lobe of a grid of
/// widths, the best second one beside it, then steps of both widths. Lobes of BRDFs that are not
/// isotropic have widths along x and y. Values of f that are not finite count as 0.
Proposal fitProposal(const Brdf& brdf, const ProposalOptions& options = {});

/// Throws UsageError for a proposal without rows or with shares above 247/255.
std::shared_ptr<const Sampler> proposalSampler(Proposal proposal);

}  // namespace hshfit::inline sampling
