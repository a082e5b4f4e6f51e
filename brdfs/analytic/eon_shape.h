#pragma once

#include <brdfs/analytic/term_brdf.h>
#include <hshfit/brdf/directions.h>

namespace hshfit::brdfs {

struct EonShape {
    double roughness;
    bool exact;
    double single, scale;
};

/// The roughness of eon.h, with A (`single`) and M (`mean`).
struct EonSettings {
    double roughness;
    bool exact;

    double single() const { return 1 / (1 + (0.5 - 2 / (3 * pi)) * roughness); }
    double mean() const { return single() * (1 + (2. / 3 - 28 / (15 * pi)) * roughness); }
    EonShape shape() const {
        return {roughness, exact, single(), roughness > 0 ? 1 / (1 - mean()) : 0};
    }
    /// The weight of multiple scattering between facets: kd' / pi.
    Colour multiple(const Colour& kd) const {
        return mapped(kd, [m = mean()](double value) {
            return value * value * m / (1 - value * (1 - m)) / pi;
        });
    }
};

}  // namespace hshfit::brdfs
