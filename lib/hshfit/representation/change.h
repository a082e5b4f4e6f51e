#pragma once

#include <hshfit/representation/representation.h>

namespace hshfit::inline representation {

/// Relative change of the projected quantity in L2 over both hemispheres, |after - before| over
/// |before|, from coefficients: with the solid angles of the outgoing set, or over all terms.
/// Exact for every basis (hemisphere_gram.h), in its inner product; for halfway it is the change of
/// the coefficients of A and B (halfway.h). `before` and `after` have the same kind and sizes.
double relativeChange(const Representation& before, const Representation& after);

/// The cost of a change of each number by itself, in the norm of the coefficients. One weight for
/// each value of decoded(…).values, matrixValues(…) or the array "halfway".
std::vector<double> changeWeights(const Representation& representation);

/// Appends the step with its cost.
void addStep(Representation& after, const Representation& before, std::string what);

}  // namespace hshfit::inline representation
