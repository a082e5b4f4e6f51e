#pragma once

#include <hshfit/brdf/directions.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

struct EvalOptions {
    bool cosine = false;  ///< f cos(theta_i) instead of f
    bool rgb = false;     ///< wavelengths as linear Rec. 709
};

struct Evaluated {
    std::string brdf;
    std::vector<std::string> channels;
    std::vector<double> values;  ///< one per channel, in 1/sr
};

/// f at a pair of directions, of a source as in openSource; 0 below the horizon. Throws
/// InputError.
Evaluated evaluatePair(const std::string& source, const Direction& wi, const Direction& wo,
                       const EvalOptions& options);

/// f at every pair of a CSV (readPairs), as a CSV: the pairs as they stand, then one column per
/// wavelength, or r, g and b, which are equal for a grey BRDF. The text is also written to
/// `output`, unless that is empty. Throws InputError and OutputError.
std::string evaluatePairs(const std::string& source, const std::string& pairs,
                          const std::string& output, const EvalOptions& options);

}  // namespace hshfit::jobs
