#pragma once

#include <hshfit/representation/representation.h>

namespace hshfit {

struct FactorOptions {
    int rank = 0;      ///< 0: the least that keeps to `error`
    double error = 0;  ///< relative change allowed
    bool nonNegative = false;
};

/// Replaces "coefficients" or "matrix" by factors; adds a step with its cost.
Representation factored(Representation representation, const FactorOptions& options);

}  // namespace hshfit
