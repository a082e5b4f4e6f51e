#pragma once

#include <brdfs/fit/fit_samples.h>

#include <cstddef>
#include <vector>

namespace hshfit::brdfs {

/// The mean radiance of the hemisphere for each incident direction, as sums over nodes:
///     V(wi) = 1/pi * integral of f(wi, wo) cos(theta_o) d(wo)
struct Veil {
    FitSamples sums;              ///< one sample for each incident direction that differs
    std::vector<std::size_t> of;  ///< the sum that each sample takes
};

/// At the nodes of a grid (gridFor) for the lobes of a BRDF that is reciprocal, refined until the
/// next level changes V by less than the tolerance. Throws NumericError where it does not get
/// there.
Veil veilOf(const Brdf& brdf, const FitSamples& samples, double tolerance);

/// The largest relative change of V of another BRDF that the next level makes, by its own lobes.
double veilChange(const Veil& veil, const Brdf& brdf, double tolerance);

}  // namespace hshfit::brdfs
