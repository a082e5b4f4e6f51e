#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/transport/random_numbers.h>

#include <cstddef>
#include <vector>

namespace hshfit::inline precomputed_transfer {

/// A direction above a surface, in its frame.
struct DirectionAbove {
    Direction local;
    double cosine = 0;      ///< its share of the integral of cos(theta) / pi, times the number
    double solidAngle = 0;  ///< its share of the hemisphere, times the number
};

/// Strata of the hemisphere, one direction in each, with the density (mu + 1/2) / (2 pi) over
/// solid angle, mu = cos(theta): halfway between even and in proportion to mu, so that neither
/// weight grows beyond 2. Rings of equal probability have equally many strata, up to one.
class DirectionStrata {
public:
    explicit DirectionStrata(std::size_t count);

    std::size_t count() const { return count_; }
    /// The directions of one vertex, turned about its normal by an angle of their own.
    void fill(RandomNumbers& random, std::vector<DirectionAbove>& out) const;

private:
    std::size_t count_;
    std::vector<std::size_t> rings_;  ///< the first stratum of each, and the end
};

}  // namespace hshfit::inline precomputed_transfer
