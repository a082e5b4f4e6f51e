#include <hshfit/lighting/lobe_nodes.h>

#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hshfit::lighting {
namespace {

constexpr std::size_t mostNodes = std::size_t{1} << 20, mostByAzimuth = mostNodes / 8;
constexpr double settled = 2e-4;  // of the albedo; tables are interpolated with larger errors

LobeNodes nodesAt(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid) {
    LobeNodes nodes;
    nodes.wo = wo;
    RingPoints points(grid);
    while (points.next()) {
        for (std::size_t j = 0; j < points.count(); ++j) {
            const Direction d = points.direction(j);
            nodes.x.push_back(d.x);
            nodes.y.push_back(d.y);
            nodes.z.push_back(d.z);
            nodes.weights.push_back(points.weight(j));
        }
    }
    const std::size_t count = nodes.count(), channels = brdf.channels().count();
    std::vector<double> values(channels * count);
    brdf.eval(wo, {nodes.x.data(), nodes.y.data(), nodes.z.data(), count}, values.data());
    for (std::size_t c = 0; c < 3; ++c) {
        const double* from = values.data() + (channels == 3 ? c : 0) * count;
        nodes.f[c].assign(from, from + count);
    }
    return nodes;
}

Rgb albedoOf(const LobeNodes& nodes) {
    Rgb albedo{};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < nodes.count(); ++k)
            albedo[c] += nodes.weights[k] * nodes.z[k] * nodes.f[c][k];
    return albedo;
}

/// The value that a share of the projected solid angle is below; 0 for no share.
double quantile(const LobeNodes& nodes, const std::vector<double>& f, double share) {
    if (!(share > 0)) return 0;
    std::vector<std::size_t> order(f.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t k) { return f[k]; });
    double below = 0;
    for (const std::size_t k : order) {
        below += nodes.weights[k] * nodes.z[k];
        if (below >= share * pi) return f[k];
    }
    return f.empty() ? 0 : f[order.back()];
}

}  // namespace

LobeNodes lobeNodes(const Brdf& brdf, const Direction& wo, int order) {
    const std::size_t channels = brdf.channels().count();
    if (channels != 1 && channels != 3)
        throw UsageError(
            fmt::format("{}: lighting takes grey and RGB, not {} channels", brdf.name(), channels));
    const std::vector<Lobe> lobes = brdf.lobes(wo);
    const std::vector<double> kinks = brdf.kinks(wo);
    const std::size_t most = lobesInPlane(brdf.laws()) ? mostNodes : mostByAzimuth;
    LobeNodes nodes;
    Rgb before{};
    for (int level = 0;; ++level) {
        const HemisphereGrid grid =
            gridFor(lobes, wo, {.order = order, .level = level, .squeezed = true}, kinks);
        if (level > 0 && grid.points() > most) break;
        nodes = nodesAt(brdf, wo, grid);
        const Rgb albedo = albedoOf(nodes);
        double change = 0, size = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            if (!std::isfinite(albedo[c]))
                throw NumericError(fmt::format("{}: f is not finite for wo at {:.4f} degrees",
                                               brdf.name(), degrees(polarAngle(wo))));
            change = std::max(change, std::abs(albedo[c] - before[c]));
            size = std::max(size, std::abs(albedo[c]));
        }
        before = albedo;
        if (level > 1 && change <= settled * size) break;
    }
    return nodes;
}

LobeNodes viewNodes(const Brdf& brdf, double cosine, double azimuth, int order) {
    const double theta = std::acos(cosine);
    LobeNodes nodes = lobeNodes(brdf, directionFromAngles(theta, azimuth), order);
    nodes.inPlane = lobesInPlane(brdf.laws());
    if (azimuth == 0) return nodes;
    nodes.wo = directionFromAngles(theta, 0);
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        const Direction d = rotateAboutZ({nodes.x[k], nodes.y[k], nodes.z[k]}, -azimuth);
        nodes.x[k] = d.x;
        nodes.y[k] = d.y;
    }
    return nodes;
}

LobeNodes thinned(const LobeNodes& nodes, std::size_t most) {
    if (nodes.count() <= most) return nodes;
    LobeNodes result;
    result.wo = nodes.wo;
    result.inPlane = nodes.inPlane;
    const Rgb albedo = albedoOf(nodes);
    const double energy = std::max(albedo[0] + albedo[1] + albedo[2], 1e-300);
    double passed = 0, next = 0.5;
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        const double f = nodes.f[0][k] + nodes.f[1][k] + nodes.f[2][k];
        const double share =
            nodes.weights[k] / 2 * (std::abs(f) * nodes.z[k] / energy + 1 / (2 * pi));
        const double expected = share * static_cast<double>(most);
        passed += expected;
        double picks = 0;
        for (; next < passed; ++next) ++picks;
        if (picks == 0) continue;
        result.x.push_back(nodes.x[k]);
        result.y.push_back(nodes.y[k]);
        result.z.push_back(nodes.z[k]);
        result.weights.push_back(nodes.weights[k] * picks / expected);
        for (std::size_t c = 0; c < 3; ++c) result.f[c].push_back(nodes.f[c][k]);
    }
    return result;
}

LobeSummary summarise(const LobeNodes& nodes, double evenShare) {
    LobeSummary result;
    result.albedo = albedoOf(nodes);
    std::array<double, 3> level{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double mean = result.albedo[c] / pi;
        level[c] = std::clamp(quantile(nodes, nodes.f[c], evenShare), 0.0, std::max(0.0, mean));
        result.even[c] = pi * level[c];
        result.rest[c] = result.albedo[c] - result.even[c];
    }
    const double rest = result.rest[0] + result.rest[1] + result.rest[2];
    const double albedo = result.albedo[0] + result.albedo[1] + result.albedo[2];
    result.axis = mirrored(nodes.wo);
    if (!(rest > 1e-6 * albedo)) return result;
    Direction mean{0, 0, 0};
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        double value = 0;
        for (std::size_t c = 0; c < 3; ++c) value += nodes.f[c][k] - level[c];
        value *= nodes.weights[k] * nodes.z[k] / rest;
        mean.x += value * nodes.x[k];
        mean.y += value * nodes.y[k];
        mean.z += value * nodes.z[k];
    }
    if (nodes.inPlane) mean.y = 0;
    const double length = std::sqrt(dot(mean, mean));
    if (!(length > 0)) return result;
    result.axis = {mean.x / length, mean.y / length, mean.z / length};
    result.meanCosine = std::min(length, 1.0);
    return result;
}

AcrossAxis::AcrossAxis(const Direction& a)
    : first{1 - a.x * a.x / (1 + a.z), -a.x * a.y / (1 + a.z), -a.x},
      second{-a.x * a.y / (1 + a.z), 1 - a.y * a.y / (1 + a.z), -a.y} {}

Direction AcrossAxis::at(double angle) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * first.x + s * second.x, c * first.y + s * second.y, c * first.z + s * second.z};
}

double LobeSpread::angle() const {
    return std::atan2(product, difference) / 2;
}
double LobeSpread::widest() const {
    return (sum + std::hypot(difference, product)) / 2;
}
double LobeSpread::narrowest() const {
    return std::max(0.0, sum - std::hypot(difference, product)) / 2;
}

LobeSpread spreadOf(const LobeNodes& nodes, const LobeSummary& lobe) {
    const AcrossAxis across(lobe.axis);
    const double rest = lobe.rest[0] + lobe.rest[1] + lobe.rest[2];
    const double even = lobe.even[0] + lobe.even[1] + lobe.even[2];
    LobeSpread spread;
    if (!(rest > 0)) return spread;
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        const double f = nodes.f[0][k] + nodes.f[1][k] + nodes.f[2][k] - even / pi;
        const double share = f * nodes.weights[k] * nodes.z[k] / rest;
        const Direction d{nodes.x[k], nodes.y[k], nodes.z[k]};
        const double u = dot(d, across.first), v = dot(d, across.second);
        spread.sum += share * (u * u + v * v);
        spread.difference += share * (u * u - v * v);
        spread.product += share * 2 * u * v;
    }
    return spread;
}

double misplaced(const LobeNodes& nodes, const LobeSummary& lobe,
                 const std::function<double(const Direction&)>& density) {
    double sum = 0, albedo = 0;
    for (std::size_t k = 0; k < nodes.count(); ++k) {
        const double shape = density({nodes.x[k], nodes.y[k], nodes.z[k]});
        for (std::size_t c = 0; c < 3; ++c)
            sum += nodes.weights[k] * std::abs(nodes.z[k] * (nodes.f[c][k] - lobe.even[c] / pi) -
                                               lobe.rest[c] * shape);
    }
    for (const double value : lobe.albedo) albedo += value;
    return albedo > 0 ? sum / (2 * albedo) : 0;
}

}  // namespace hshfit::lighting
