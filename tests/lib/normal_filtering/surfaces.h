#pragma once

#include <lib/normal_filtering/maps.h>

#include <brdfs/catalog.h>
#include <hshfit/normal_filtering/mip_errors.h>

#include <fmt/core.h>

#include <cstddef>
#include <memory>
#include <vector>

namespace hshfit::test {

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
