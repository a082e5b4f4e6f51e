#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The study of a minimum beyond the errors that every fit has.
struct UncertaintyOptions {
    bool report = false;        ///< chi-square, errors by several routes, influence of samples
    std::size_t bootstrap = 0;  ///< fits to samples (or scans) drawn with replacement; 0: none
    bool profile = false;       ///< intervals by profile likelihood
    std::function<void(std::size_t, std::size_t)> progress = {};  ///< of these two
};

/// An end is none where the data let the parameter go to its bound.
struct Interval {
    std::optional<double> low, high;
};

/// The errors of one parameter by each route; none at a bound, and where the data do not determine
/// the parameter.
struct ParameterUncertainty {
    /// (J^T W J)^-1 with the stated uncertainties, or without any times the variance of residuals.
    std::optional<double> normal;
    std::optional<double> sandwich;  ///< HC3, samples independent
    std::optional<double> scans;     ///< likewise by scan: its samples may be correlated (CR3)
    /// With the stated correlations (SigmaCorrelation) in C: (J^T C^-1 J)^-1, or (J^T W J)^-1 J^T W
    /// C W J (J^T W J)^-1 of a fit that weights values as independent ones.
    std::optional<double> correlated = {};
    /// Degrees of freedom of the variance by `scans` (scanDegrees), from the scans that determine
    /// the parameter; none for the scale of a scan.
    std::optional<double> scanDegrees;
    /// Standard deviation and percentiles of fits to resampled data.
    struct Bootstrap {
        double error = 0;
        Interval within68, within95;
    };
    std::optional<Bootstrap> bootstrap;
    struct Profile {
        Interval within68, within95;
        /// Half widths agree with the normal errors to 10 %.
        bool quadratic = true;
    };
    std::optional<Profile> profile;
};

/// The part of one value in a fit (Belsley, Kuh & Welsch 1980, 10.1002/0471725153).
struct ValueInfluence {
    double model = 0;  ///< f, 1/sr
    /// The residual over the standard deviation that the other values give it; above 0 where the
    /// measured value is larger.
    double studentised = 0;
    double leverage = 0;
    double cook = 0;  ///< Cook's distance
};

struct Uncertainty {
    bool stated = false;               ///< uncertainties of the samples were
    bool correlated = false;           ///< and their correlation: `correlated` is what a fit states
    bool whitened = false;             ///< and the fit weights by it; chi-square is r^T C^-1 r
    double chiSquare = 0;              ///< sum of weighted squared residuals
    std::size_t degreesOfFreedom = 0;  ///< values less determined parameters
    /// The probability of a chi-square as large; only if uncertainties were stated, and
    /// correlations are in it.
    std::optional<double> probability;
    std::size_t scans = 0;  ///< 0: every sample on its own
    /// Parameters of one channel. Where there are no more scans than these, there are no errors by
    /// scan, and a fit states errors by the stated uncertainties (`normal`).
    std::size_t scanParameters = 0;
    std::vector<ParameterUncertainty> parameters;  ///< in the order of FitResult::parameters
    std::vector<double> covariance;      ///< by the route `normal`, [n * n]; 0 where there is none
    std::vector<ValueInfluence> values;  ///< [channel * samples + sample]
    /// |studentised| of a value beyond this is expected in 5 of 100 fits (Bonferroni).
    double outlierBound = 0;
    std::size_t bootstrapDraws = 0, bootstrapFailures = 0;
    /// The parameters' values of each draw; empty for a draw that did not converge.
    std::vector<std::vector<double>> draws;

    bool scansSuffice() const { return scans > scanParameters; }
    double reducedChiSquare() const {
        return degreesOfFreedom > 0 ? chiSquare / static_cast<double>(degreesOfFreedom) : 0;
    }
};

}  // namespace hshfit::brdfs
