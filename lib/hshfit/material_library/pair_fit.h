#pragma once

#include <hshfit/accuracy/pair_sample.h>
#include <hshfit/material_library/basis.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace hshfit::material_library {

/// The pairs of PairFit: 1,054 of spreadPairs, whose weights add up to 1, and 32 where wi mirrors
/// wo, of weight 0, for the bound alone.
const PairSample& fitPairs();

/// Numbers of a channel: q_k of all components in steps of the basis, then its bound as the code of
/// `pack`, from 0 to 255.
///
/// The coordinates of a channel of which f is known at fitPairs(): weighted least squares of
/// ln(f + logOffset), half of the weight by solid angle and half by pair, and beside them four
/// times (f c / (f c + s))^2, s a tenth of the median of f c, as pictures see errors, and
/// (f c)^2 with a sum of 1, c = cos(theta_i): the sums of Encoder, over pairs that are fewer.
/// Immutable; safe to use from many threads.
class PairFit {
public:
    explicit PairFit(const Basis& basis);
    ~PairFit();

    std::size_t components() const;
    /// Values of f at fitPairs(), 1/sr; those below 0 count as 0. q_k are not rounded.
    void fit(const float* f, double* numbers) const;

    /// Sums over fitPairs() with weights.
    struct Squares {
        double difference = 0;  ///< of ((g - f) c)^2, g of the numbers
        double value = 0;       ///< of (f c)^2
    };
    Squares squares(const float* f, const double* numbers) const;

private:
    struct Functions;
    std::unique_ptr<const Functions> functions_;
};

/// Numbers of at most `most` of `count` materials, of which f is known at fitPairs(): each has the
/// largest distance from the materials before it, in the mean square of ln(f + logOffset) by solid
/// angle, the first from the mean of all. None is like another. values[material][channel][pair]
std::vector<std::size_t> farthest(std::span<const float> values, std::size_t count,
                                  std::size_t most);

/// ln(f + logOffset) of channels whose numbers follow one another.
LogMaterial fromNumbers(const Basis& basis, const double* numbers, std::size_t channels);

}  // namespace hshfit::material_library
