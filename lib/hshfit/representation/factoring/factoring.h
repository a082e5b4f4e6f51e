#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/coefficients/outgoing.h>
#include <hshfit/representation/representation.h>

#include <vector>

namespace hshfit::inline representation::inline factoring {

struct FactorOptions {
    int rank = 0;      ///< 0: the least that keeps to `error`
    double error = 0;  ///< relative change allowed
    bool nonNegative = false;
    int mostSweeps = 60;  ///< of nonNegative; the step says whether they were too few
};

/// Replaces CoefficientArray or MatrixArray by factors; adds a step with its cost.
///
/// outgoing  The truncated singular value decomposition of the rows [outgoing, channel] of
///           coefficients, with the solid angles and the Gram matrix of the basis as weights: no
///           product of this rank is nearer in L2 (Eckart & Young 1936). `left` has columns of
///           norm 1 with the solid angles as weights, `right` the singular values. Directions
///           without a solid angle get the left part that is nearest to them.
/// basis     The same for each block of terms (factoring_blocks.h): ProductBlock, with functions of
///           wo as rows and of wi as columns; reciprocal: SymmetricBlock, `right` from the
///           decomposition of all channels, which is nearest for one channel and within sqrt 2 of
///           it for more. Blocks that would not get smaller, and antisymmetric ones, stay whole.
///           In the norm of the coefficients (for sh: over the sphere).
/// nonNegative, outgoing only: left >= 0 everywhere and right >= -1e-5 of its root mean square at
///           all wi: alternating projections (hierarchical least squares, Cichocki et al. 2007,
///           with the cone of functions that are non-negative on the hemisphere in place of
///           non-negative vectors), a local optimum. Deterministic.
///
/// Throws UsageError for halfway, what is factored already, nonNegative with another kind than
/// outgoing or without a rank, or neither rank nor error.
Representation factored(Representation representation, const FactorOptions& options);

/// Singular values, falling, of q(wi, wo) itself over wi and the rows [outgoing, channel], solid
/// angles (and cos theta_i in `inner` projectedSolidAngle) as weights: sqrt(sum_{i >= r} s_i^2 /
/// sum s_i^2) is the least relative error that any r functions of wi can leave, bases aside
/// (principal components of the material's own slices, not centred). On tensor grids over wi that
/// are doubled until the values agree to 1e-3 of the largest, at most 192 x 384 nodes; beyond,
/// sharp peaks are under-resolved and `converged` is false.
struct SliceSpectrum {
    std::vector<double> values;
    bool converged = false;
    double relativeError(std::size_t rank) const;
};
SliceSpectrum sliceSpectrum(const Brdf& brdf, const OutgoingSet& outgoing,
                            Quantity quantity = Quantity::brdf,
                            Basis::Inner inner = Basis::Inner::solidAngle);

}  // namespace hshfit::inline representation::inline factoring
