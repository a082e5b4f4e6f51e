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
    /// The 95th percentile of chiSquare / degreesOfFreedom that is expected of the library's own
    /// materials at the same pairs, with the noise of the samples.
    double usual = 0;
    bool known = true;  ///< at most twice as much, or 2
};

/// f and the bounds of one standard deviation of ln(f + logOffset), 1/sr, [channel].
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

/// Coordinates of a material in a basis, normal a priori as those of the materials of the library
/// are, and conditioned on observations of ln(f + logOffset) to first order in their uncertainties.
/// The sum of the channels and their differences count as independent; covariances are shrunk
/// towards their diagonal by K / (K + M), K coordinates and M materials. The part of a material
/// beyond the basis is noise at every pair.
class Posterior {
public:
    /// `library` has to outlive this. Throws InputError for fewer than three coded materials.
    explicit Posterior(const Library& library);
    ~Posterior();

    /// The maximum a posteriori given all of these, which is also the mean; from the prior anew.
    /// Channels are those of the first observation. Throws UsageError for none.
    Agreement observe(std::span<const Observation> observations);

    LogMaterial material() const;
    Band at(const DirectionPair& pair) const;
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
