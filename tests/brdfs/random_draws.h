#pragma once

// Draws of random numbers that are the same with every compiler: no two of them are operands or
// arguments of one expression, whose order a compiler chooses.

#include <hshfit/brdf/directions.h>

#include <cmath>
#include <random>

namespace hshfit::test {

/// Evenly spread in [0, 1), 53 bits.
inline double uniform(std::mt19937_64& random) {
    return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Normally distributed, mean 0 and variance 1 (Box and Muller 1958).
inline double normal(std::mt19937_64& random) {
    const double radius = std::sqrt(-2 * std::log(1 - uniform(random)));
    return radius * std::cos(2 * pi * uniform(random));
}

/// Evenly spread in both angles, radians; theta below `largestTheta`.
inline Direction directionBelow(double largestTheta, std::mt19937_64& random) {
    const double phi = 2 * pi * uniform(random);
    return directionFromAngles(largestTheta * uniform(random), phi);
}

}  // namespace hshfit::test
