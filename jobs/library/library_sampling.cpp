#include "library_sampling.h"

#include <hshfit/each_in_parallel.h>
#include <hshfit/gpu/proposals/proposal_shader.h>
#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/efficiency.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <atomic>

namespace hshfit::jobs {
namespace {

/// Materials of which efficiencies are measured, their outgoing directions, and samples of each.
constexpr std::size_t triedMaterials = 64, trials = 4096;
constexpr std::array triedElevations{0., 30., 60., 75.};

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

std::vector<ExportedSampling::Row> efficiencyOf(const std::vector<Proposal>& proposals,
                                                const MaterialBrdf& material) {
    const std::size_t count = std::min(proposals.size(), triedMaterials);
    constexpr std::size_t directions = triedElevations.size();
    std::vector<std::array<Efficiency, directions>> own(count), cosine(count);
    eachInParallel(count, [&](std::size_t n) {
        const std::size_t m = n * proposals.size() / count;
        const auto brdf = material(m);
        const auto sampler = proposalSampler(proposals[m]), flat = cosineSampler();
        for (std::size_t k = 0; k < directions; ++k) {
            const Direction wo = directionFromAngles(radians(triedElevations[k]), pi / 4);
            own[n][k] = efficiencyAt(*brdf, *sampler, wo, trials);
            cosine[n][k] = efficiencyAt(*brdf, *flat, wo, trials);
        }
    });
    std::vector<ExportedSampling::Row> rows;
    for (std::size_t k = 0; k < directions; ++k) {
        std::vector<double> variance, largest, flat;
        for (std::size_t n = 0; n < count; ++n) {
            variance.push_back(own[n][k].variance);
            largest.push_back(own[n][k].largest);
            flat.push_back(cosine[n][k].variance);
        }
        rows.push_back({.theta = triedElevations[k],
                        .variance = median(variance),
                        .largest = median(largest),
                        .cosine = median(flat)});
    }
    return rows;
}

}  // namespace

nlohmann::ordered_json samplingJson(const ExportedSampling& sampling) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const ExportedSampling::Row& row : sampling.efficiency)
        rows.push_back({{"theta_o", row.theta},
                        {"variance", row.variance},
                        {"largest", row.largest},
                        {"variance_of_cosine", row.cosine}});
    return {{"first_texel", sampling.first}, {"rows", sampling.rows}, {"median", rows}};
}

LibraryProposals addProposals(gpu::SharedSums& sums, std::size_t rows, const MaterialBrdf& material,
                              const ProgressCall& progress) {
    LibraryProposals made{std::vector<Proposal>(sums.count()),
                          {.first = sums.stride(), .rows = rows, .efficiency = {}}};
    std::atomic<std::size_t> done = 0;
    eachInParallel(made.proposals.size(), [&](std::size_t m) {
        made.proposals[m] = fitProposal(*material(m), {.elevations = rows});
        if (progress) progress(++done, made.proposals.size());
    });
    made.sampling.efficiency = efficiencyOf(made.proposals, material);
    sums.further = std::max<std::size_t>(rows, 2);  // every place lies between two rows
    for (Proposal proposal : made.proposals) {
        proposal.rows.resize(sums.further, proposal.rows.back());
        const std::vector<double> texels = gpu::proposalTexels(proposal);
        sums.furtherTexels.insert(sums.furtherTexels.end(), texels.begin(), texels.end());
    }
    return made;
}

}  // namespace hshfit::jobs
