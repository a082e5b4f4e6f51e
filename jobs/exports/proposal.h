#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/proposals/proposal_record.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/sampling/sampler.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace hshfit::jobs {

struct EfficiencyTask {
    std::size_t trials = 4096;  ///< samples
    std::uint64_t seed = 1;
    AlbedoOptions albedo = {.tolerance = 1e-4, .maxEvaluations = std::size_t{1} << 22};
};
/// The efficiency of a sampler at wo, and the albedo by quadrature if that converges.
gpu::ProposalRow efficiencyRow(const Brdf& brdf, const Sampler& sampler, const Direction& wo,
                               const EfficiencyTask& task);

/// A proposal for max(f, 0), which is what shaders return, with its efficiency at 0, 30, 60, 75 and
/// 85 degrees (azimuth 45), by 4096 samples each, and the albedo there where
/// 32,768 evaluations give it to 1e-3 and the samples agree.
gpu::ProposalRecord proposalFor(const Brdf& brdf, const ProposalOptions& options = {});

/// The proposal that an export keeps; none if the file is not of an export, or keeps none.
std::optional<gpu::ProposalRecord> storedProposal(const std::string& path);

}  // namespace hshfit::jobs
