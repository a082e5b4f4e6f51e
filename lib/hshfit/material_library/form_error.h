#pragma once

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/brdf/brdf.h>

namespace hshfit::material_library {

/// The distance of g from f over pairs, with c = cos(theta_i); means with the pairs' weights and
/// over channels. Values below 0 count as 0.
struct FormError {
    double meanLog = 0;     ///< of |ln(1 + f c) - ln(1 + g c)|
    double logError = 0;    ///< of |ln((g + logOffset) / (f + logOffset))|
    double relativeL2 = 0;  ///< root of the sum of ((g - f) c)^2 over that of (f c)^2; 0 for f = 0
    double maximum = 0;     ///< of |g - f| c, 1/sr
};

/// Throws NumericError where f is not finite. The channels have to be as many.
FormError formError(const Brdf& f, const Brdf& g, const PairSample& pairs);

/// The pairs of every error of a library, which no fit uses: spreadPairs().
const PairSample& errorPairs();

}  // namespace hshfit::material_library
