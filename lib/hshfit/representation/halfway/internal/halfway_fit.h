#pragma once

#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/representation/halfway/internal/halfway_samples.h>

#include <Eigen/Core>

#include <vector>

namespace hshfit::inline representation::inline halfway {

/// The weighted normal equations of one channel: gram c = right, |y|^2 = squares.
struct HalfwaySystem {
    Eigen::MatrixXd gram;
    Eigen::VectorXd right;
    double squares = 0;
};

/// Coefficients [term][channel] of ln(1 + f).
using HalfwayValues = Eigen::MatrixXd;

/// One pass over the samples: the systems of the next step, one per channel, and the loss of
/// `values`, the coefficients now; none (0 x 0) before the first step.
struct HalfwayPass {
    std::vector<HalfwaySystem> systems;
    double loss = 0;
};
HalfwayPass halfwayPass(const HalfwayTerms& terms, const HalfwaySamples& samples,
                        const HalfwayValues& values);

/// The coefficients that solve the systems, with `regularisation` times the mean of the diagonal
/// added to it.
HalfwayValues solveHalfway(const std::vector<HalfwaySystem>& systems, double regularisation);

struct HalfwayFit {
    HalfwayValues values;
    double loss = 0;            ///< over the samples, by their weights
    double regularisation = 0;  ///< that it was found with
};

/// Steps until the loss changes by less than a part in 300, from `values` if there are any, with
/// as much regularisation as costs little (worthIt in halfway_fit.cpp).
HalfwayFit fitHalfway(const HalfwayTerms& terms, const HalfwaySamples& samples,
                      HalfwayValues values);

/// The sum of the expansion, ln(1 + f), at every sample: [sample][channel].
std::vector<double> halfwaySums(const HalfwayTerms& terms, const HalfwaySamples& samples,
                                const HalfwayValues& values);

/// Mean of |ln(1 + f c) - ln(1 + g c)| over samples and channels, of sums as above. `caps`: ln of
/// what g is cut off at, likewise, or empty.
double halfwayLoss(const HalfwaySamples& samples, const std::vector<double>& sums,
                   const std::vector<double>& caps = {});

}  // namespace hshfit::inline representation::inline halfway
