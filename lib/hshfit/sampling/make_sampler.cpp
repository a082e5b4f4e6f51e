#include <hshfit/sampling/make_sampler.h>

#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/internal/elevation_bins.h>
#include <hshfit/sampling/internal/target.h>
#include <hshfit/stop_request.h>

#include <tbb/parallel_for.h>

#include <algorithm>

namespace hshfit::inline sampling {
namespace {

SamplerList partsOf(const Brdf& brdf, const SamplerOptions& options) {
    SamplerList parts{cosineSampler()};
    const auto* own = options.known ? dynamic_cast<const HasSamplers*>(&brdf) : nullptr;
    if (own) {
        const HasSamplers::Known known = own->samplers();
        parts.insert(parts.end(), known.samplers.begin(), known.samplers.end());
        if (known.all) return parts;
    }
    if (options.proposal)
        parts.push_back(
            proposalSampler(options.fitted ? *options.fitted : fitProposal(brdf, options.fit)));
    if (options.table) parts.push_back(tabulate(brdf, options.tabulation));
    return parts;
}

MixtureRow rowOf(const std::vector<Target>& targets, const SamplerList& parts, double leastCosine) {
    MixtureRow row{std::vector<double>(parts.size(), 0.0), true};
    row.reflects = std::ranges::any_of(targets, [](const Target& t) { return t.total > 0; });
    row.shares[0] = 1;
    if (!row.reflects || parts.size() == 1) return row;

    std::vector<NodeDensities> densities;
    for (const auto& part : parts) densities.push_back(densitiesAt(*part, targets));
    std::vector<const NodeDensities*> pointers;
    for (const NodeDensities& d : densities) pointers.push_back(&d);
    row.shares = leastSecondMoment(targets, pointers, leastCosine, 60).shares;
    // A part with a share this small costs more time than it saves.
    constexpr double negligible = 5e-3;
    double left = 1;
    for (std::size_t k = 1; k < row.shares.size(); ++k)
        if (row.shares[k] < negligible) left -= std::exchange(row.shares[k], 0.0);
    for (double& share : row.shares) share = std::min(share / left, 1.0);
    return row;
}

}  // namespace

std::unique_ptr<MixtureSampler> makeSampler(const Brdf& brdf, const SamplerOptions& options) {
    const SamplerList parts = partsOf(brdf, options);
    std::vector<MixtureRow> rows(options.elevations);
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t bin) {
        stopIfRequested();
        rows[bin] = rowOf(targetsOfBin(brdf, bin, rows.size()), parts, options.leastCosine);
    });
    return std::make_unique<MixtureSampler>(parts, std::move(rows));
}

}  // namespace hshfit::inline sampling
