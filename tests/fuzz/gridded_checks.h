#pragma once

#include <brdfs/measured/measured_brdf.h>

#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <vector>

namespace hshfit::fuzz {

/// Calls every function of a table; every value has to be finite and not negative.
inline void check(const brdfs::MeasuredBrdf& brdf) {
    constexpr double x[] = {0, 0.6, -0.8, 0.28, 1, 0, 0.96};
    constexpr double y[] = {0, 0, 0, -0.96, 0, 0.6, 0};
    constexpr double z[] = {1, 0.8, 0.6, 1e-9, 0, -0.8, 0.28};
    constexpr std::size_t count = 7;
    const std::size_t channels = brdf.channels().count();
    if (channels > 4096) return;  // only slow
    std::vector<double> out(count * channels);
    std::vector<unsigned char> covered(count);
    for (const Direction& wo : {Direction{0, 0, 1}, {0.6, 0, 0.8}, {0, -1, 1e-12}}) {
        brdf.eval(wo, {x, y, z, count}, out.data());
        for (const double f : out) {
            if (!(f >= 0) || !std::isfinite(f)) std::abort();
        }
        brdf.coverage(wo, {x, y, z, count}, covered.data());
        for (const unsigned char c : covered) {
            if (c > 1) std::abort();
        }
        brdf.lobes(wo);
        brdf.kinks(wo);
    }
    const brdfs::Census census = brdf.census();
    if (census.belowHorizon + census.invalid + census.negative + census.notANumber +
            census.infinite >
        census.values) {
        std::abort();
    }
    brdf.facts();
    brdf.axes();
    brdf.name();
    brdf.checkIntact();
}

}  // namespace hshfit::fuzz
