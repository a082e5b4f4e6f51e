#pragma once

#include <hshfit/brdf/uniform.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/normal_filtering/lobe_table.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace hshfit::test {

/// D of GGX (Walter et al. 2007, Eq. 33; Heitz 2014 for two widths), 1/sr.
inline double ggxDensity(const Direction& h, double ax, double ay) {
    const double x = h.x / ax, y = h.y / ay, sum = x * x + y * y + h.z * h.z;
    return 1 / (pi * ax * ay * sum * sum);
}
inline NormalDistribution ggxDistribution(double ax, double ay) {
    return {[=](const Direction& h) { return ggxDensity(h, ax, ay); }, ax, ay};
}

/// A table of one entry.
inline std::shared_ptr<const LobeTable> ggxTable(int order, double ax, double ay) {
    return std::make_shared<LobeTable>(
        1, 1, [=](std::size_t, std::size_t) { return test::ggxDistribution(ax, ay); },
        LobeTableOptions{order});
}

/// A map of slopes: a sum of waves with random directions and phases.
struct SlopeMap {
    struct Wave {
        double kx, ky, phase, amplitudeX, amplitudeY;
    };
    std::vector<Wave> waves;

    /// Slopes of a Gaussian height field, band-limited to wavelengths from 8 to 32 texels; sigma is
    /// the standard deviation of the slope along each axis.
    static SlopeMap bumpy(double sigma, unsigned seed = 1) {
        std::mt19937_64 random(seed);
        SlopeMap map;
        constexpr int count = 64;
        for (int j = 0; j < count; ++j) {
            const double k = 2 * pi / (8 * std::pow(4.0, uniform(random)));
            const double phi = 2 * pi * (j + uniform(random)) / count;
            const double amplitude = 2 * sigma / std::sqrt(double(count));
            map.waves.push_back({k * std::cos(phi), k * std::sin(phi), 2 * pi * uniform(random),
                                 amplitude * std::cos(phi), amplitude * std::sin(phi)});
        }
        return map;
    }
    /// Streaks along x: slopes of deviation `across` along y and `along` along x, which vary over 3
    /// to 12 texels along y and over some hundred along x.
    static SlopeMap brushed(double across, double along, unsigned seed = 2) {
        std::mt19937_64 random(seed);
        SlopeMap map;
        constexpr int count = 64;
        const double amplitude = std::sqrt(2.0 / count);
        for (int j = 0; j < count; ++j) {
            const double kx = 2 * pi / 256 * (2 * uniform(random) - 1);
            const double ky = 2 * pi / (3 * std::pow(4.0, uniform(random)));
            map.waves.push_back({kx, ky, 2 * pi * uniform(random),
                                 amplitude * along * (uniform(random) < 0.5 ? -1 : 1),
                                 amplitude * across});
        }
        return map;
    }
    Direction normal(double x, double y) const {
        double sx = 0, sy = 0;
        for (const Wave& w : waves) {
            const double c = std::cos(w.kx * x + w.ky * y + w.phase);
            sx += w.amplitudeX * c;
            sy += w.amplitudeY * c;
        }
        return normalised({-sx, -sy, 1});
    }
};

}  // namespace hshfit::test
