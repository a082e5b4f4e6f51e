#include <hshfit/transport/radiance_cache/hemisphere_strata.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/wording.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit::inline transport::inline radiance_cache {
namespace {

struct Directions {
    std::vector<double> x, y, z;

    void add(double theta, double phi) {
        const Direction d = directionFromAngles(theta, phi);
        x.push_back(d.x), y.push_back(d.y), z.push_back(std::max(d.z, 0.0));
    }
    DirectionBatch batch() const { return {x.data(), y.data(), z.data(), x.size()}; }
};

/// A straight edge with the normal N (its length) at q from the record adds W(q / |q|) N / |q| to
/// the derivative of coefficient i. When the record moves, q does: the symmetric part of the
/// derivative is (3 W w - grad W) N^T / |q|^2 about w = q / |q|, on which the slope of the edge
/// along its line of sight has no part.
std::vector<float> bendsOf(const IncomingFunctions& functions, const Directions& at,
                           const std::vector<std::array<double, 2>>& normals) {
    constexpr double h = 1e-3;
    const std::size_t size = functions.size(), count = at.x.size();
    std::vector<float> values(count * size), beside[4];
    functions.tabulate(at.batch(), values.data());
    for (std::size_t side = 0; side < 4; ++side) {
        Directions moved;
        for (std::size_t k = 0; k < count; ++k) {
            const double step = side % 2 == 0 ? h : -h;
            Direction d{at.x[k], at.y[k], at.z[k]};
            (side < 2 ? d.x : d.y) += step;
            d = normalised(d);
            moved.x.push_back(d.x), moved.y.push_back(d.y), moved.z.push_back(d.z);
        }
        beside[side].resize(count * size);
        functions.tabulate(moved.batch(), beside[side].data());
    }
    std::vector<float> bends(3 * count * size);
    for (std::size_t k = 0; k < count; ++k) {
        float* xx = bends.data() + 3 * k * size;
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t n = k * size + i;
            const double w = 3 * static_cast<double>(values[n]);
            const double x =
                w * at.x[k] - static_cast<double>(beside[0][n] - beside[1][n]) / (2 * h);
            const double y =
                w * at.y[k] - static_cast<double>(beside[2][n] - beside[3][n]) / (2 * h);
            xx[i] = static_cast<float>(x * normals[k][0]);
            xx[size + i] = static_cast<float>((x * normals[k][1] + y * normals[k][0]) / 2);
            xx[2 * size + i] = static_cast<float>(y * normals[k][1]);
        }
    }
    return bends;
}

}  // namespace

HemisphereStrata::HemisphereStrata(const IncomingFunctions& functions, int rays, bool bends)
    : rings_(0), azimuths_(0), size_(functions.size()), cosine_(functions.cosine()) {
    if (rays < 4) {
        throw UsageError(fmt::format("{} is {}; a record needs 4 rays or more",
                                     Setting{"CacheOptions::rays"}, rays));
    }
    rings_ = static_cast<std::size_t>(std::max(1.0, std::sqrt(rays / pi)));
    azimuths_ = static_cast<std::size_t>(rays) / rings_;
    const double step = 2 * pi / static_cast<double>(azimuths_);
    Directions ring, azimuth;
    std::vector<double> ringFactor, azimuthFactor;
    for (std::size_t j = 0; j < rings_; ++j) {
        const double inner = polarAngleAt(static_cast<double>(j));
        const double outer = polarAngleAt(static_cast<double>(j) + 1);
        for (std::size_t k = 0; k < azimuths_; ++k) {
            ring.add(inner, azimuthAt(k, 0.5));
            azimuth.add((inner + outer) / 2, azimuthAt(k, 0));
        }
        // A point of the edge at distance r moves by cos(theta) / r across an edge of the length
        // sin(theta) step, or by 1 / (r sin(theta)) in azimuth, over which sin(theta) d theta lies.
        ringFactor.push_back(std::sin(inner) * std::cos(inner) * step);
        azimuthFactor.push_back(outer - inner);
    }
    if (bends) {
        std::vector<std::array<double, 2>> ringNormals, azimuthNormals;
        for (std::size_t cell = 0; cell < cells(); ++cell) {
            const double along = azimuthAt(cell % azimuths_, 0.5),
                         across = azimuthAt(cell % azimuths_, 0);
            const double ringLength = ringFactor[cell / azimuths_];
            const double azimuthLength = azimuthFactor[cell / azimuths_];
            ringNormals.push_back({ringLength * std::cos(along), ringLength * std::sin(along)});
            azimuthNormals.push_back(
                {-azimuthLength * std::sin(across), azimuthLength * std::cos(across)});
        }
        ringBends_ = bendsOf(functions, ring, ringNormals);
        azimuthBends_ = bendsOf(functions, azimuth, azimuthNormals);
    }
    ringEdges_.resize(cells() * size_);
    azimuthEdges_.resize(cells() * size_);
    functions.tabulate(ring.batch(), ringEdges_.data());
    functions.tabulate(azimuth.batch(), azimuthEdges_.data());
    for (std::size_t cell = 0; cell < cells(); ++cell) {
        for (std::size_t i = 0; i < size_; ++i) {
            ringEdges_[cell * size_ + i] *= static_cast<float>(ringFactor[cell / azimuths_]);
            azimuthEdges_[cell * size_ + i] *= static_cast<float>(azimuthFactor[cell / azimuths_]);
        }
    }
    // Only functions without azimuth have an integral; theta parts are smooth in sqrt(cos(theta)).
    const GaussRule rule = gaussLegendre(64);
    std::vector<float> values(size_);
    std::vector<double> sums(size_);
    for (std::size_t p = 0; p < rule.nodes.size(); ++p) {
        const double u = (rule.nodes[p] + 1) / 2;
        Directions one;
        one.add(std::acos(u * u), 0);
        functions.tabulate(one.batch(), values.data());
        for (std::size_t i = 0; i < size_; ++i) {
            if (functions.zonal(i))
                sums[i] += 2 * pi * rule.weights[p] * u * static_cast<double>(values[i]);
        }
    }
    for (const double sum : sums) ofOne_.push_back(static_cast<float>(sum));
}

double HemisphereStrata::polarAngleAt(double ring) const {
    const double share = std::min(1.0, ring / static_cast<double>(rings_));
    return cosine_ ? std::asin(std::sqrt(share)) : std::acos(1 - share);
}

double HemisphereStrata::azimuthAt(std::size_t k, double y) const {
    return 2 * pi * (static_cast<double>(k) + y) / static_cast<double>(azimuths_);
}

double HemisphereStrata::measure() const {
    return (cosine_ ? pi : 2 * pi) / static_cast<double>(cells());
}

Direction HemisphereStrata::direction(std::size_t cell, double x, double y) const {
    const double share = (static_cast<double>(cell / azimuths_) + x) / static_cast<double>(rings_);
    const double phi = azimuthAt(cell % azimuths_, y);
    const double mu = cosine_ ? std::sqrt(1 - share) : 1 - share;
    const double sine = std::sqrt(std::max(0.0, 1 - mu * mu));
    return {sine * std::cos(phi), sine * std::sin(phi), mu};
}

}  // namespace hshfit::inline transport::inline radiance_cache
