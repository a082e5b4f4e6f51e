#pragma once

#include <brdfs/fit/fit_result.h>
#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// f of a fit at pairs of directions with its standard error, 1/sr: [channel * pairs + pair].
struct Prediction {
    std::size_t pairs = 0, channels = 0;
    std::vector<double> values;
    /// sqrt(g^T C g), g the derivatives of f by the coefficients of the fit and C their covariance
    /// (delta method; Seber & Wild 1989, 10.1002/0471725315, section 5.1).
    std::vector<double> errors;
    /// Degrees of freedom of their variances (scan_spread.h), 1 and more: few where few samples, or
    /// scans, decide. Infinite where they are not known (FittedPoint::freedom).
    std::vector<double> degrees;
    /// Standard deviation and percentiles of fits to resampled data, where the fit has them.
    struct Bootstrap {
        std::vector<double> errors;
        std::vector<Interval> within68, within95;
    };
    std::optional<Bootstrap> bootstrap;

    /// The factor of an error with which a band holds the true f at one pair and channel with this
    /// probability, for a true model and normal errors: Student's, 1 for 0.6827 of infinitely many
    /// degrees of freedom.
    static double pointwise(double probability,
                            double degrees = std::numeric_limits<double>::infinity());
    /// The largest factor among the pairs and channels.
    double widest(double probability) const;
};

/// Predicts f at pairs that need not have been fitted. Both directions above the horizon. The error
/// is the fitted curve's; a further measurement has its own noise in addition. It does not
/// hold the misfit of a wrong model. Coefficients at a bound count as known. `bootstrap`: evaluates
/// the fits to resampled data too, where there are any.
Prediction predict(const FitResult& fit, std::span<const DirectionPair> pairs,
                   bool bootstrap = true);
/// Predicts f at the samples of a fit. Throws UsageError for sums of f (FitSamples::sums).
Prediction predict(const FitResult& fit, const FitSamples& samples, bool bootstrap = true);

/// The factor of the errors with which bands hold the true f at all these pairs and channels at
/// once with this probability: the quantile, over `draws` draws of the coefficients, of the largest
/// |change of f| / error (Scheffe's bands hold for all pairs there are, and are wider). Draws are
/// from the multivariate Student distribution with the fewest degrees of freedom among the
/// pairs. The same for the same seed.
double simultaneousFactor(const FitResult& fit, std::span<const DirectionPair> pairs,
                          double probability, std::uint64_t seed = 1, std::size_t draws = 4000);

}  // namespace hshfit::brdfs
