#pragma once

#include "library_export.h"

#include <jobs/common/listener.h>

#include <hshfit/brdf/brdf.h>
#include <hshfit/gpu/forms/library_shader.h>
#include <hshfit/sampling/proposal.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace hshfit::jobs {

/// f of a material as its shader gives it, by number.
using MaterialBrdf = std::function<std::unique_ptr<Brdf>(std::size_t material)>;

/// Proposals of all materials, each with `rows` elevations, in the further texels of `sums`, and
/// their efficiency.
struct LibraryProposals {
    std::vector<Proposal> proposals;
    ExportedSampling sampling;
};
LibraryProposals addProposals(gpu::SharedSums& sums, std::size_t rows, const MaterialBrdf& material,
                              const ProgressCall& progress);

}  // namespace hshfit::jobs
