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

    bool operator==(const ProposalLobe&) const = default;
};

/// 1e-4 * 20000^(code / 255): from 1e-4 to 2 in steps of 4 %.
double proposalWidth(std::uint8_t code);

/// A small density for a BRDF, as shaders can store it: two lobes, and the cosine with the rest of
/// the shares, 8/255 or more:
///     pdf = (1 - share_0 - share_1) cos / pi + sum_k share_k ggx_k(wo, wi)
/// Shares and widths are interpolated between rows, so that the density is continuous in wo and
/// equals the density of the samples everywhere. Eight bytes per row.
struct Proposal {
    using Row = std::array<ProposalLobe, 2>;
    /// Rows by outgoing elevation (proposalPlace). Only the second lobe may be a retro one, and
    /// then is in all rows.
    std::vector<Row> rows;

    std::size_t bytes() const { return rows.size() * sizeof(Row); }
    bool isotropic() const;  ///< whether the widths along x and y are the same
    bool operator==(const Proposal&) const = default;
};
/// The most rows, and the largest sum of a row's two shares, in 255ths.
inline constexpr std::size_t mostProposalRows = 256;
inline constexpr int mostProposalShare = 247;

/// The place of wo, wo.z >= 0, between `rows` rows, in [0, rows - 1]:
///     s = 1 - sqrt(1 - tan(theta_o / 2)),   place = s rows - 1/2, clamped.
/// Rows are nearer to each other towards the horizon: with 16 the first is at 7.0 degrees and the
/// last 0.06 degrees above the horizon.
double proposalPlace(const Direction& wo, std::size_t rows);
/// The outgoing direction of a row, at azimuth 0.
Direction directionOfRow(std::size_t row, std::size_t rows);

/// The parameters at one outgoing direction, lobe by lobe.
struct ProposalMix {
    std::array<double, 2> share, widthX, widthY;
    std::array<bool, 2> retro;
};
ProposalMix mixAt(const Proposal& proposal, const Direction& wo);

struct ProposalOptions {
    std::size_t elevations = 16;  ///< rows
};

/// The lobes that minimise the second moment of f cos / pdf, |f| averaged over channels, at each
/// row (over three azimuths if f is not isotropic): the best lobe of a grid of widths, the best
/// second one beside it, then steps of both widths. The second lobe is a retro one if that is
/// better on average. Lobes of BRDFs that are not isotropic have widths along x and y. Values of
/// f that are not finite count as 0.
Proposal fitProposal(const Brdf& brdf, const ProposalOptions& options = {});

/// Throws UsageError for what is no proposal: no row or more than mostProposalRows, shares above
/// mostProposalShare, a `retro` of the first lobe, or one that changes between rows.
void checkProposal(const Proposal& proposal);
/// Throws as checkProposal.
std::shared_ptr<const Sampler> proposalSampler(Proposal proposal);

}  // namespace hshfit::inline sampling
