#pragma once

#include <hshfit/brdf/directions.h>

namespace hshfit::inline representation {

/// A representation laid out for speed: many pairs at once, in single precision, by vector code
/// chosen at run time. The same values as `reconstruct` within single-precision rounding of the
/// sum. Immutable; safe to use from many threads.
class PairEvaluator {
public:
    virtual ~PairEvaluator() = default;

    /// f for pair k = (wi[k], wo[k]): out[channel * wi.count + k]; 0 where either is not above the
    /// horizon. wi.count == wo.count.
    virtual void evaluate(DirectionBatch wi, DirectionBatch wo, float* out) const = 0;
};

}  // namespace hshfit::inline representation
