#pragma once

#include <hshfit/representation/form.h>
#include <hshfit/representation/representation.h>

namespace hshfit {

/// Each returns the changed coefficients and adds a step with its cost. `source` is the BRDF that
/// was projected.

Representation windowed(Representation representation, Window window);
Representation madeNonNegative(Representation representation);
Representation madeEnergyPreserving(Representation representation, const Brdf& source);

}  // namespace hshfit
