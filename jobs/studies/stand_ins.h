#pragma once

#include <jobs/common/listener.h>

#include <hshfit/brdf/brdf.h>
#include <hshfit/choice/choice.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

/// A source, for the candidates that are made of it; it outlives them.
struct CandidateSource {
    const Brdf& brdf;
    std::string spec;  ///< that commands name: with rgb: before it where the BRDF has wavelengths
    std::string name;  ///< of files
};

/// Candidates that are no coefficient files: the model itself where the source is one of models,
/// fits of lobes, standard materials.
std::vector<choice::Candidate> formulaCandidates(const CandidateSource& source);

/// A file of the RGL format: the source itself where it is one, else a conversion of it.
choice::Candidate bsdfCandidate(const CandidateSource& source);

/// Coefficient files: the halfway form from few terms to many, both directions in one basis,
/// coefficients per outgoing direction. `target` of an export follows in the commands, unless it
/// is empty.
std::vector<choice::Candidate> formCandidates(const CandidateSource& source,
                                              const std::string& target);

}  // namespace hshfit::jobs
