#pragma once

#include <jobs/exports/formula_candidates.h>

#include <hshfit/choice/choice.h>
#include <hshfit/tradeoff/projection_folder.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

/// A file of the RGL format: the source itself where it is one, else a conversion of it.
choice::Candidate bsdfCandidate(const CandidateSource& source);

/// Coefficient files: the halfway form from few terms to many, both directions in one basis,
/// coefficients per outgoing direction. `target` of an export follows in the commands, unless it
/// is empty. `folder` outlives them.
std::vector<choice::Candidate> formCandidates(const CandidateSource& source,
                                              const std::string& target,
                                              const tradeoff::ProjectionFolder& folder);

}  // namespace hshfit::jobs
