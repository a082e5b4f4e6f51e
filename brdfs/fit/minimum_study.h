#pragma once

#include <brdfs/fit/covariance.h>
#include <brdfs/fit/fit_search.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/fit/uncertainty.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::brdfs {

/// A minimum of a problem as its description found it. x as in FitProblem::joint.
struct StudiedMinimum {
    const FitProblem& problem;
    const std::vector<double>& x;
    const Equations& equations;        ///< without spread
    const std::vector<bool>& fixed;    ///< held by a bound
    const std::vector<double>& slope;  ///< of the parameters' values by x
    const Covariance& stated;          ///< negative variance: no errors
    const Covariance& sandwich;        ///< samples independent
    const VarianceFreedom* freedom;    ///< by scan where the samples have scans
};

/// The degrees of freedom of variances at x, by scan or by value; null: FittedPoint::freedom.
/// `inverse` as inverseOf gives it.
std::shared_ptr<const VarianceFreedom> freedomAt(const FitProblem& problem,
                                                 std::span<const double> x,
                                                 std::span<const double> inverse,
                                                 const std::vector<double>& slope);

/// Equations::spread with scans in place of samples: sum over scans of g g^T, g the gradient of a
/// scan as it would be if the scan had not been fitted (CR3: Bell & McCaffrey 2002, Survey
/// Methodology 28(2)), times (S - 1) / S for S scans. Where no more scans than parameters act on
/// one channel it is the spread of stated uncertainties, the hessian, and without these it throws
/// NumericError.
std::vector<double> spreadOfScans(const FitProblem& problem, const VarianceFreedom& byScan,
                                  const Equations& equations);
/// Whether it is a study of scans.
bool scansSuffice(const FitProblem& problem, const VarianceFreedom& byScan);

/// Leverages of values, by (J^T W J)^-1. `shapes`: WeightedRows::place.
std::vector<double> leveragesOf(const WeightedRows& rows, const Eigen::MatrixXd& inverse,
                                std::size_t shapes);
/// The sums of scans, in n parameters. Rows of several channels one after another have the scans of
/// one channel again and again.
std::vector<ScanSums> sumsOfScans(const WeightedRows& rows, const std::vector<std::size_t>& scans,
                                  std::size_t n, std::size_t shapes);

/// The values of a fit at its minimum.
struct StudiedValues {
    std::vector<double> residuals = {};  ///< root(w) (measured - model)
    std::vector<double> models = {};     ///< 1/sr
    std::vector<double> leverages = {};
    bool stated = false;      ///< weights are 1 / sigma^2
    bool correlated = false;  ///< Uncertainty::correlated
    bool whitened = false;    ///< Uncertainty::whitened
    std::size_t scans = 0;
    std::size_t scanParameters = 0;  ///< Uncertainty::scanParameters
    /// Terms beside the values, such as priors: squares, number, and sum of leverages.
    double otherSquares = 0, otherCount = 0, otherRank = 0;
};

/// Chi-square and the influence of each value; no errors of parameters.
Uncertainty influences(const StudiedValues& values);

/// Adds the errors of parameters: by `inverse`, (J^T W J)^-1 [n * n], by `sandwich`, and, where the
/// samples have scans, by `stated`, with the degrees of freedom of the first parameters.
void addErrors(std::span<const double> inverse, const std::vector<double>& slope,
               const Covariance& stated, const Covariance& sandwich,
               const std::vector<double>& scanDegrees, Uncertainty& result);

/// Everything but bootstrap and profile.
Uncertainty studied(const StudiedMinimum& minimum);

/// The parameters' values of a fit to the data of draw b of a bootstrap (redrawn); empty where it
/// did not converge. Called from several threads at once.
using Refit = std::function<std::vector<double>(std::size_t b)>;
/// Adds the draws, and the spread of each parameter over them. Throws NumericError where fewer than
/// two of them converged.
void addBootstrap(const Refit& refit, const UncertaintyOptions& options, Uncertainty& result);
/// Adds fits to samples, or scans, drawn with replacement, each from the minimum on. Draw b depends
/// on the seed and b alone.
void addBootstrap(const StudiedMinimum& minimum, const UncertaintyOptions& options,
                  std::uint64_t seed, Uncertainty& result);

/// A sum of squares whose profiles are looked for.
struct ProfiledProblem {
    std::function<Equations(std::span<const double>, bool)> joint;
    Bounds bounds;
    double normalisation = 1;
    std::function<double(std::size_t, double)> valueOf;  ///< of a parameter, from its x
    const std::vector<double>& x;                        ///< at the minimum
    const Equations& equations;
    const std::vector<bool>& fixed;
    const std::vector<double>& slope;
    bool constrained = false;  ///< an infinite cost says that x is not feasible
};

/// The values of parameter i at which the least chi-square over all others exceeds the minimum by
/// the square of a normal quantile: 68.27 % and 95 % (Venzon & Moolgavkar 1988, 10.2307/2347496).
/// Without stated uncertainties, by the square of Student's quantile times the variance of
/// residuals. `normal`: the parameter's error by that route.
ParameterUncertainty::Profile profileOf(const ProfiledProblem& problem, std::size_t i,
                                        double normal, const Uncertainty& study);

/// Adds profiles of each parameter of the problem with an error.
void addProfiles(const ProfiledProblem& problem, const UncertaintyOptions& options,
                 Uncertainty& result);
void addProfiles(const StudiedMinimum& minimum, const UncertaintyOptions& options,
                 Uncertainty& result);

}  // namespace hshfit::brdfs
