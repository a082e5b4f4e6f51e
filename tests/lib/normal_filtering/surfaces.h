#pragma once

#include <brdfs/catalog.h>
#include <hshfit/brdf/uniform.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/normal_filtering/mip_errors.h>

#include <fmt/core.h>

#include <cmath>
#include <cstddef>
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

/// A square surface of GGX facets with a diffuse part, one channel: f from the program's own model,
/// the factor M = (f - kd / pi) cos(theta_i) / D.
struct GgxSurface {
    std::size_t size = 256;
    double ax = 0.1, ay = 0.1, kd = 0.05;
    std::shared_ptr<const Brdf> brdf;
    std::vector<SurfaceTexel> texels;

    GgxSurface(const SlopeMap& map, double ax_, double ay_, std::size_t size_ = 256,
               double kd_ = 0.05)
        : size(size_), ax(ax_), ay(ay_), kd(kd_) {
        brdf = brdfs::open(fmt::format("ggx:kd={},ks=1,F0=0.5,ax={},ay={}", kd, ax, ay));
        for (std::size_t k = 0; k < size * size; ++k) {
            SurfaceTexel t;
            t.normal = map.normal(static_cast<double>(k % size), static_cast<double>(k / size));
            t.albedos[0] = kd;
            texels.push_back(t);
        }
    }
    std::shared_ptr<const LobeTable> table(int order) const {
        return std::make_shared<LobeTable>(
            1, 1, [this](std::size_t, std::size_t) { return ggxDistribution(ax, ay); },
            LobeTableOptions{order});
    }
    FilteredSurface surface() const {
        FilteredSurface s;
        s.width = s.height = size;
        s.channels = 1;
        s.texel = [this](std::size_t x, std::size_t y) { return texels[y * size + x]; };
        s.brdf = [this](const SurfaceTexel&, const Direction& wi, const Direction& wo,
                        std::span<double> out) {
            brdf->eval(wo, {&wi.x, &wi.y, &wi.z, 1}, out.data());
        };
        s.rest = [this](const FilteredTexel&, const Direction& wi, const Direction& wo,
                        std::span<const double> density, std::span<double> out) {
            double f = 0;
            brdf->eval(wo, {&wi.x, &wi.y, &wi.z, 1}, &f);
            const double d = ggxDensity(normalised(wi + wo), ax, ay);
            out[0] = density[0] * (f - kd / pi) * wi.z / d;
        };
        return s;
    }
};

}  // namespace hshfit::test
