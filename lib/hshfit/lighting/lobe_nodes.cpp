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

constexpr std::size_t mostNodes = std::size_t{1} << 20;
constexpr double settled = 2e-4;  // of the albedo; tables are interpolated with larger errors

LobeNodes nodesAt(const Brdf& brdf, const Direction& wo, const HemisphereGrid& grid) {
    LobeNodes nodes;
    nodes.wo = wo;
    RingPoints points;
    for (const HemisphereGrid::Panel& panel : grid.panels) {
        points.start(panel);
        for (std::size_t r = panel.firstRing; r < panel.firstRing + panel.rings; ++r) {
            points.move(grid, r);
            for (std::size_t j = 0; j < points.count(); ++j) {
                const Direction d = points.direction(j);
                nodes.x.push_back(d.x);
                nodes.y.push_back(d.y);
                nodes.z.push_back(d.z);
                nodes.weights.push_back(points.weight(j));
            }
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
    LobeNodes nodes;
    Rgb before{};
    for (int level = 0;; ++level) {
        const HemisphereGrid grid =
            gridFor(lobes, wo, {.order = order, .level = level, .squeezed = true}, kinks);
        if (level > 0 && grid.points() > mostNodes) break;
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
    // The lobe of an isotropic BRDF has its mean in the plane of incidence.
    mean.y = 0;
    const double length = std::sqrt(dot(mean, mean));
    if (!(length > 0)) return result;
    result.axis = {mean.x / length, 0, mean.z / length};
    result.meanCosine = std::min(length, 1.0);
    return result;
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
