#pragma once

#include <cmath>
#include <random>

namespace hshfit::inline brdf {

/// In [0, 1), 53 bits; unlike std::uniform_real_distribution the same on every machine.
inline double uniform(std::mt19937_64& random) {
    return std::ldexp(static_cast<double>(random() >> 11), -53);
}

}  // namespace hshfit::inline brdf
