#include "proposal.h"

#include <hshfit/gpu/containers/containers.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace hshfit::jobs {
namespace {

constexpr double albedoTolerance = 1e-3;

class Clamped final : public Brdf {
public:
    explicit Clamped(const Brdf& brdf) : brdf_(brdf) {}

    std::string name() const override { return brdf_.name(); }
    const Channels& channels() const override { return brdf_.channels(); }
    const Laws& laws() const override { return brdf_.laws(); }
    std::vector<Lobe> lobes(const Direction& wo) const override { return brdf_.lobes(wo); }
    std::vector<double> kinks(const Direction& wo) const override { return brdf_.kinks(wo); }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        brdf_.eval(wo, wi, out);
        for (double& value : std::span(out, wi.count * channels().count()))
            value = std::max(value, 0.0);
    }

private:
    const Brdf& brdf_;
};

/// Whether quadrature and samples agree, within 5 standard errors and the tolerance. Quadrature can
/// agree with itself beside a peak that it does not see.
bool agree(const std::vector<double>& albedo, const Efficiency& efficiency) {
    const double most = *std::ranges::max_element(albedo);
    for (std::size_t c = 0; c < albedo.size(); ++c)
        if (!(std::abs(albedo[c] - efficiency.albedo[c]) <=
              5 * efficiency.albedoError[c] + albedoTolerance * most))
            return false;
    return true;
}

}  // namespace

gpu::ProposalRow efficiencyRow(const Brdf& brdf, const Sampler& sampler, const Direction& wo,
                               const EfficiencyTask& task) {
    gpu::ProposalRow row{efficiencyAt(brdf, sampler, wo, task.trials, task.seed)};
    const AlbedoEstimate found = estimateAlbedo(brdf, wo, task.albedo);
    if (found.converged) row.albedo = found.values;
    return row;
}

gpu::ProposalRecord proposalFor(const Brdf& brdf, const ProposalOptions& options) {
    const Clamped clamped(brdf);
    gpu::ProposalRecord record{fitProposal(clamped, options), {}};
    const auto sampler = proposalSampler(record.proposal);
    constexpr std::array elevations{0., 30., 60., 75., 85.};
    record.rows.resize(elevations.size());
    tbb::parallel_for(std::size_t{0}, elevations.size(), [&](std::size_t k) {
        const Direction wo = directionFromAngles(radians(elevations[k]), pi / 4);
        gpu::ProposalRow row = efficiencyRow(
            clamped, *sampler, wo,
            {.albedo = {.tolerance = albedoTolerance, .maxEvaluations = std::size_t{1} << 15}});
        if (row.albedo && !agree(*row.albedo, row.efficiency)) row.albedo.reset();
        record.rows[k] = std::move(row);
    });
    return record;
}

std::optional<gpu::ProposalRecord> storedProposal(const std::string& path) {
    if (!gpu::looksLikePayload(path)) return std::nullopt;
    return gpu::readProposal(path);
}

}  // namespace hshfit::jobs
