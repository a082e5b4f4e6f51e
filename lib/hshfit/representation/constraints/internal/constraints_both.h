#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/representation/representation.h>

namespace hshfit::inline representation::inline constraints {

/// The constraints on a matrix over both directions.
struct BothConstraints {
    bool nonNegative = false;
    const Brdf* added = nullptr;         ///< q + added >= 0
    const Brdf* albedoSource = nullptr;  ///< albedo nowhere above this BRDF's
    int mostRounds = 60;                 ///< of adding pairs where the sum is negative
};

/// The nearest matrix, channel by channel, over all terms at once. See constraints.h.
/// Throws NumericError where the last round leaves more than the tolerance (constraints_cone.h).
void constrainBoth(Representation& matrix, const BothConstraints& constraints);

}  // namespace hshfit::inline representation::inline constraints
