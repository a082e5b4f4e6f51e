#pragma once

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/brdf/brdf.h>

#include <string>

namespace hshfit::material_library {

/// The distance of g from f over pairs, with c = cos(theta_i); means with the pairs' weights and
/// over channels. Values below 0 count as 0.
struct FormError {
    double meanLog = 0;     ///< of |ln(1 + f c) - ln(1 + g c)|
    double logError = 0;    ///< of |ln((g + logOffset) / (f + logOffset))|
    double relativeL2 = 0;  ///< sqrt(sum of ((g - f) c)^2 / sum of (f c)^2); 0 for f = 0
    double maximum = 0;     ///< of |g - f| c, 1/sr
    double largest = 0;     ///< f c, 1/sr
    double flip = 0;        ///< mean FLIP of the picture error, where it was measured

    /// The maximum as a share of the largest f c; 0 for f = 0.
    double maximumShare() const { return largest > 0 ? maximum / largest : 0; }
};

/// The errors beyond which a form does not stand for its material.
struct Limits {
    double log = 0.15;     ///< FormError::logError
    double maximum = 0.5;  ///< FormError::maximumShare()
    double flip = 0.1;     ///< FormError::flip; from 1 on no picture is drawn

    bool operator==(const Limits&) const = default;
    bool pictures() const { return flip < 1; }
};

/// The first of the limits that an error exceeds, as "has a mean error of ln(f + 0.001) of 0.2,
/// limit 0.15"; empty: it is within all.
std::string beyond(const FormError& error, const Limits& limits);

/// The error without FLIP. f and g have to have as many channels. Throws NumericError where f is
/// not finite.
FormError formError(const Brdf& f, const Brdf& g, const PairSample& pairs);

/// The pairs of every error of a library, which no fit uses: spreadPairs().
const PairSample& errorPairs();

}  // namespace hshfit::material_library
