#include <hshfit/sampling/mixture.h>

#include <hshfit/sampling/internal/elevation_bins.h>
#include <hshfit/sampling/internal/folded.h>

#include <cassert>
#include <utility>

namespace hshfit::inline sampling {

MixtureSampler::MixtureSampler(SamplerList parts, std::vector<MixtureRow> rows)
    : parts_(std::move(parts)), rows_(std::move(rows)) {
    assert(!rows_.empty());
}

const MixtureRow& MixtureSampler::row(const Direction& wo) const {
    return rows_[elevationBin(wo, rows_.size())];
}

Sample MixtureSampler::sample(const Direction& wo, const Uniforms& u) const {
    if (!(wo.z > 0)) return {};
    const std::vector<double>& shares = row(wo).shares;
    double before = 0;
    std::size_t chosen = 0;
    for (std::size_t k = 0; k < shares.size(); ++k) {
        if (shares[k] == 0) continue;
        chosen = k;
        if (u[2] < before + shares[k]) break;
        before += shares[k];
    }
    constexpr double last = 1 - 0x1p-53;
    const double rest = std::clamp((u[2] - before) / shares[chosen], 0.0, last);
    const Direction wi = parts_[chosen]->sample(wo, {u[0], u[1], rest}).wi;
    return {wi, pdf(wo, wi)};
}

double MixtureSampler::pdf(const Direction& wo, const Direction& wi) const {
    if (!aboveHorizon(wo, wi)) return 0;
    const std::vector<double>& shares = row(wo).shares;
    double sum = 0;
    for (std::size_t k = 0; k < shares.size(); ++k)
        if (shares[k] > 0) sum += shares[k] * parts_[k]->pdf(wo, wi);
    return sum;
}

}  // namespace hshfit::inline sampling
