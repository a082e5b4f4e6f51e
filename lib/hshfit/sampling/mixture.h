#pragma once

#include <hshfit/sampling/sampler.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline sampling {

/// Shares of a mixture's parts in a bin of outgoing elevation (elevation_bins.h); they sum to 1.
struct MixtureRow {
    std::vector<double> shares;
    bool reflects = true;  ///< false: f cos was 0 wherever it was looked at
};

/// sum_k share_k pdf_k, the shares by outgoing elevation. The third number chooses the part and,
/// rescaled, goes on to it.
class MixtureSampler final : public Sampler {
public:
    /// At least one row, each with a share per part.
    MixtureSampler(SamplerList parts, std::vector<MixtureRow> rows);

    std::string_view name() const override { return "mixture"; }
    Sample sample(const Direction& wo, const Uniforms& u) const override;
    double pdf(const Direction& wo, const Direction& wi) const override;

    const SamplerList& parts() const { return parts_; }
    const MixtureRow& row(const Direction& wo) const;
    const std::vector<MixtureRow>& rows() const { return rows_; }
    /// Whether there is anything to sample for this wo. If not, samples are the cosine's.
    bool reflects(const Direction& wo) const { return wo.z > 0 && row(wo).reflects; }

private:
    SamplerList parts_;
    std::vector<MixtureRow> rows_;
};

}  // namespace hshfit::inline sampling
