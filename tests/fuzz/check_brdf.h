#pragma once

#include <hshfit/brdf/brdf.h>

#include <cmath>
#include <cstdlib>
#include <vector>

namespace hshfit::test {

/// Evaluates at directions of all kinds; aborts where f is no finite number, or is negative and
/// claims not to be.
inline void checkBrdf(const Brdf& brdf) {
    constexpr double x[] = {0, 0.6, -0.8, 0.28, 1, 0};
    constexpr double y[] = {0, 0, 0, -0.96, 0, 0.6};
    constexpr double z[] = {1, 0.8, 0.6, 1e-9, 0, -0.8};
    const std::size_t channels = brdf.channels().count();
    if (channels > 4096) return;  // only slow
    std::vector<double> out(6 * channels);
    unsigned char covered[6];
    for (const Direction& wo : {Direction{0, 0, 1}, {0.6, 0, 0.8}, {0, -1, 1e-12}}) {
        brdf.eval(wo, {x, y, z, 6}, out.data());
        for (const double f : out) {
            if ((f < 0 && brdf.laws().nonNegative) || !std::isfinite(f)) std::abort();
        }
        brdf.coverage(wo, {x, y, z, 6}, covered);
        for (const unsigned char c : covered) {
            if (c > 1) std::abort();
        }
        brdf.lobes(wo);
    }
    brdf.facts();
    brdf.channels().names();
}

}  // namespace hshfit::test
