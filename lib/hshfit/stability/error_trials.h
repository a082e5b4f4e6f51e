#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hshfit::stability {

/// A projection for one outgoing direction, whose stated errors are to be tried.
struct ErrorTrial {
    std::string group;  ///< under which it is counted: the name of a model or a format
    std::shared_ptr<const Brdf> brdf;
    double thetaDegrees = 0, phiDegrees = 0;
    std::string basis = "hsh";
    int order = 7;
    Quantity quantity = Quantity::brdf;
    /// For a table, whose file need not exist any more: the name of a file, and the command that
    /// writes it. Empty: the name of `brdf` is its specification.
    std::string file = {}, writtenBy = {};

    /// The specification, or the file of a table.
    std::string spec() const { return file.empty() ? brdf->name() : file; }
};

/// True errors of a projection at its default tolerance or another one, against the same projection
/// at a hundredth of the smaller of the two, or finer until the nodes differ.
struct ErrorTrialResult {
    enum class State {
        measured,
        refused,      ///< the coefficients do not exist, or did not converge
        noReference,  ///< a hundredth and a tenth of the tolerance did not converge
    };
    ErrorTrial trial;
    State state = State::measured;
    double stated = 0;        ///< `error`, relative
    double coefficients = 0;  ///< true error of the coefficients in L2, relative
    bool hasEnergy = false;
    double statedEnergy = 0, energy = 0;  ///< both relative to the energy
    double tolerance = 0;                 ///< asked for
    double referenceTolerance = 0;        ///< at which the reference was computed
    std::size_t evaluations = 0, referenceEvaluations = 0;

    /// Neither error is above the one stated, but for rounding.
    bool coefficientsHold() const;
    bool energyHolds() const;
    bool bothHold() const { return coefficientsHold() && (!hasEnergy || energyHolds()); }
    /// Stated by true error, of coefficients and energy the one that is nearer; infinite where the
    /// true error is rounding.
    double overstatement() const;
};

struct ErrorTrialOptions {
    double tolerance = 0;  ///< of the projections that are tried; 0: each BRDF's default
    /// The most evaluations of a reference. If they do not suffice, a reference at a tenth of the
    /// tolerance is tried.
    std::size_t referenceEvaluations = std::size_t{1} << 20;
    std::function<void(std::size_t, std::size_t)> progress = {};
};

/// The results in the order of the trials. They do not depend on the number of threads.
std::vector<ErrorTrialResult> tryErrors(std::span<const ErrorTrial> trials,
                                        const ErrorTrialOptions& options = {});

/// Counts of a group of trials, or of all.
struct ErrorTrialSummary {
    std::string group;
    std::size_t trials = 0, measured = 0, coefficientsHold = 0, energyMeasured = 0, energyHolds = 0;
    std::size_t bothHold = 0;
    double worst = 0;                ///< true by stated error, the largest
    double medianOverstatement = 0;  ///< of trials whose error is more than rounding
    double medianEvaluations = 0;
    std::size_t evaluations = 0;
    std::vector<ErrorTrialResult> exceptions = {};  ///< trials in which not both hold
};

/// One for each group, in the order of their first trials, and the last one of all.
std::vector<ErrorTrialSummary> summarise(std::span<const ErrorTrialResult> results);

}  // namespace hshfit::stability
