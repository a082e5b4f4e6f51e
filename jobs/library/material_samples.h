#pragma once

#include <jobs/common/listener.h>

#include <hshfit/material_library/few_samples.h>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct ReconstructOptions {
    std::string library;
    std::string sigma = "2%";   ///< brdfs::parseSigma
    std::size_t samples = 400;  ///< at most; more are drawn from
    std::string bands = {};     ///< pairs (bandPairs); empty: none
    std::string bandsTo = {};   ///< CSV file of the bands
};

struct ReconstructedMaterial {
    std::string name;
    std::size_t samples = 0;
    material_library::Agreement agreement = {};
    double expectedError = 0;  ///< root mean square of ln(f + 0.001)
    material_library::LogMaterial material = {};
    std::vector<DirectionPair> pairs = {};           ///< of the bands
    std::vector<material_library::Band> bands = {};  ///< one standard deviation
};

/// A material from samples and a library, written as a library of its own. Throws UsageError for
/// bands without a file or pairs without the other, and as openSource and gatherSamples do.
ReconstructedMaterial reconstructMaterial(const std::string& samples, const std::string& output,
                                          const ReconstructOptions& options,
                                          const Listener& listener = {});

struct NextPairsOptions {
    std::string library, sigma = "2%";
    std::size_t count = 10;
    std::string instrument = "free";  ///< or "in-plane", a goniometer in the plane of incidence
};

/// The pairs to measure next, after the pairs in `samples` if any, as a CSV with the columns
/// theta_i, phi_i, theta_o, phi_o (degrees) and expected_error; `output` may be empty.
std::vector<material_library::NextPair> nextPairs(const std::string& samples,
                                                  const std::string& output,
                                                  const NextPairsOptions& options);

}  // namespace hshfit::jobs
