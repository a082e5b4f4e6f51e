#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/material_library/library.h>

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::material_library {

/// f at one pair of directions above the horizon, with its standard uncertainty, 1/sr.
struct Observation {
    DirectionPair pair;
    std::vector<double> values, sigmas;  ///< [channel], one or three
};

/// The agreement of observations with a library: r^T S^-1 r of the residuals r from the mean of the
/// library, S their covariance by the library and the uncertainties.
struct Agreement {
    double chiSquare = 0;
    std::size_t degreesOfFreedom = 0;
    /// The 97.5th percentile of chiSquare / degreesOfFreedom of the library's own materials at the
    /// same pairs, with the noise of the samples, each by a prior that it takes no part in; of up
    /// to 40 the largest.
    double usual = 0;
    bool known = true;  ///< at most as much
};

/// f and bounds about it, 1/sr, [channel].
struct Band {
    std::vector<double> value, low, high;
};

/// A direction to measure next, and the root mean square error of ln(f + logOffset) that is
/// expected after it.
struct NextPair {
    DirectionPair pair;
    double expectedError = 0;
};

struct NextOptions {
    std::size_t count = 10;
    bool inPlane = false;    ///< wi and wo in one plane with the normal
    double relative = 0.02;  ///< sigma^2 = (relative f)^2 + absolute^2
    double absolute = 0;
    double mostTheta = 80;  ///< degrees
};

/// A material as a sum of logTerms(), normal a priori as the materials of the library are
/// (material_prior.h), and conditioned on observations of ln(f + logOffset) to first order in their
/// uncertainties. The rest beyond the terms is noise at every pair, by zones of pairs.
/// Bands are standard deviations times a factor that makes them hold 68.3 % of the library's own
/// materials, each from a prior that it takes no part in, after observations at the same pairs.
class Posterior {
public:
    /// `space` has to outlive this. Throws InputError for fewer than three materials in terms.
    Posterior(const LogSpace& space, const Library& library);
    ~Posterior();

    /// Starts anew from the prior and takes the maximum a posteriori given all of these, which is
    /// also the mean. The material gets the channels of the first observation. Throws UsageError
    /// for none.
    Agreement observe(std::span<const Observation> observations);

    LogMaterial material() const;
    std::vector<Band> bands(std::span<const DirectionPair> pairs) const;
    /// Root mean square error of ln(f + logOffset), over pairs and channels.
    double expectedError() const;

    /// Pairs by the greedy rule: each time the one of a grid of 5 degrees (15 in azimuth) that
    /// lowers expectedError() most. Pairs within 5 degrees of retroreflection are left out, which
    /// the lamp hides. This itself is not changed.
    std::vector<NextPair> next(const NextOptions& options) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace hshfit::material_library
