#pragma once

#include <hshfit/bases/basis.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/projection/horizon.h>
#include <hshfit/projection/internal/theta_products.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace hshfit::inline projection {

/// Values for Basis::Inner::solidAngle and ::projectedSolidAngle.
using PerInner = std::array<double, 2>;

/// Converged moments of q = f or f cos(theta_i) for one outgoing direction.
struct RefinedMoments {
    std::vector<std::vector<double>> moments;  ///< per basis: [channel][slot]
    PerInner energy{};                         ///< integral of q^2, summed over channels
    PerInner energyError{};                    ///< absolute
    double error = 0;                          ///< relative, the larger of moments and energy
    /// Per basis: the relative error of its coefficients by the error of its moments, 1 unless a
    /// Gram system is solved, whose small eigenvalues enlarge it.
    std::vector<double> enlargement;
    std::vector<double> rounding;  ///< per basis: the rounding of f, as the Gram system enlarges it
    std::size_t evaluations = 0;
    HorizonBehaviour horizon;
};

struct RefinementOptions {
    Quantity quantity = Quantity::brdf;
    bool even = false;  ///< f is even in phi_i for this wo
    double tolerance = 1e-6;
    std::size_t maxEvaluations = std::size_t{1} << 26;
};

/// Inputs common to all outgoing directions of a projection. At least one basis.
struct ProjectionTables {
    explicit ProjectionTables(std::span<const Basis* const> bases);
    AzimuthTables azimuths;
    ThetaProducts theta;
};

/// Integrates q against the analysis functions of every basis. Each elevation panel is refined on
/// its own until the errors of all panels add up to no more than the tolerance, relative to the
/// norm of each basis' moments and to each energy that exists: panels that hold next to nothing
/// stay coarse, others show three changes. Errors follow from the changes of the last levels
/// (convergence.h). At tolerances of 1e-4 and more, panels begin a level below, and one change is
/// enough where three times it is within the tolerance; no error but 0 is then stated below a
/// hundredth of the tolerance, and none ever below 1e-12, the accuracy of values.
/// For an interpolated table one change is enough, the last change is held to the tolerance, and
/// the error stated is larger: in trials 3 times the tolerance (docs/results/stability.md).
///
/// Throws NumericError where the moments do not exist, do not converge within the evaluations
/// allowed, or q is not finite.
RefinedMoments refineMoments(const Brdf& brdf, const ProjectionTables& tables, const Direction& wo,
                             const RefinementOptions& options);

}  // namespace hshfit::inline projection
