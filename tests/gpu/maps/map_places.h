#pragma once

#include <hshfit/material_maps/texel_source.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

namespace hshfit::test {

/// u, v and level of places in a map and up to `beyond` of a side outside of it, exact in single
/// precision; a third of them at centres of texels of whole levels.
inline std::vector<double> mapPlaces(const std::vector<LevelSize>& levels, std::size_t count,
                                     double beyond) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto single = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    std::vector<double> places;
    for (std::size_t k = 0; k < count; ++k) {
        const double u = uniform(random), v = uniform(random);
        const std::size_t level = k / 3 % levels.size();
        const auto at = [&](double x, std::size_t side) {
            const auto length = static_cast<double>(side);
            if (k % 3 == 0) return single((std::floor(x * length) + 0.5) / length);
            return single(x * (1 + 2 * beyond) - beyond);
        };
        places.push_back(at(u, levels[level].width));
        places.push_back(at(v, levels[level].height));
        const auto last = static_cast<double>(levels.size());
        places.push_back(k % 3 == 0 ? static_cast<double>(level)
                                    : single(uniform(random) * (last + 0.5) - 0.75));
    }
    return places;
}

}  // namespace hshfit::test
