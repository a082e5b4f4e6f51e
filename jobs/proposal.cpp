#include "proposal.h"

#include <hshfit/gpu/containers/containers.h>
#include <hshfit/projection/albedo.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <span>

namespace hshfit::jobs {
namespace {

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

}  // namespace

gpu::ProposalRow efficiencyRow(const Brdf& brdf, const Sampler& sampler, const Direction& wo,
                               const EfficiencyTask& task) {
    gpu::ProposalRow row{efficiencyAt(brdf, sampler, wo, task.trials, task.seed)};
    const AlbedoEstimate found = estimateAlbedo(
        brdf, wo, {.tolerance = task.albedoTolerance, .maxEvaluations = std::size_t{1} << 22});
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
        record.rows[k] = efficiencyRow(clamped, *sampler, wo, {.albedoTolerance = 1e-3});
    });
    return record;
}

std::optional<gpu::ProposalRecord> storedProposal(const std::string& path) {
    if (!gpu::looksLikePayload(path)) return std::nullopt;
    return gpu::readProposal(path);
}

}  // namespace hshfit::jobs
