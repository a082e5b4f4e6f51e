#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/representation/pair_evaluator.h>

namespace hshfit::inline representation {

/// f(wi, wo) in 1/sr of a representation (`pairEvaluator` makes the evaluator), one value per
/// channel: out[channel]. The value of the pair in a batch but for rounding; 0 where a direction is
/// not above the horizon. Throws nothing for unit vectors. For callers that get one pair at a time,
/// such as the inner loop of a path tracer; batches are faster.
///
/// Allocates nothing but in a thread's first call for a larger form than before. Exceptions: a
/// BRDF that is `added` to the form allocates what its own evaluation does, and coefficients in the
/// basis slepian allocate in every call.
inline void evaluate(const PairEvaluator& evaluator, const Direction& wi, const Direction& wo,
                     float* out) {
    evaluator.evaluate({&wi.x, &wi.y, &wi.z, 1}, {&wo.x, &wo.y, &wo.z, 1}, out);
}

}  // namespace hshfit::inline representation
