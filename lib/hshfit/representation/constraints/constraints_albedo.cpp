#include <hshfit/representation/constraints/internal/constraints_albedo.h>

#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/quadrature/quadrature.h>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace hshfit::inline representation::inline constraints {
namespace {

constexpr double boundAccuracy = 1e-6;

/// The same for directions that the BRDF treats alike, to 1e-12.
std::array<long long, 3> keyOf(const Direction& d, const Laws& laws) {
    const auto rounded = [](double x) { return std::llround(x * 1e12); };
    if (laws.isotropic) return {rounded(d.z), 0, 0};
    if (laws.mirrorSymmetric) return {rounded(std::abs(d.x)), rounded(std::abs(d.y)), rounded(d.z)};
    return {rounded(d.x), rounded(d.y), rounded(d.z)};
}

}  // namespace

std::vector<double> albedoMoments(const Basis& basis, Quantity quantity) {
    // Exact for bands below twice the order, which Slepian functions hold.
    const GaussRule& rule = gaussLegendre(2 * basis.order() + 6);
    const std::size_t count = rule.nodes.size();
    std::vector<Elevation<double>> points;
    std::vector<double> weights, values(count * static_cast<std::size_t>(basis.order()));
    for (std::size_t i = 0; i < count; ++i) {
        const double u = (1 + rule.nodes[i]) / 2, mu = u * u;
        points.push_back({mu, (1 - u) * (1 + u)});
        weights.push_back(rule.weights[i] * u * (quantity == Quantity::brdf ? mu : 1));
    }
    basis.theta(0, points, values.data());
    std::vector<double> moments(static_cast<std::size_t>(basis.slots()), 0.0);
    for (int l = 0; l < basis.order(); ++l) {
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            sum += weights[i] * values[static_cast<std::size_t>(l) * count + i];
        }
        moments[static_cast<std::size_t>(slotOf(l, 0))] = std::sqrt(2 * pi) * sum;
    }
    return moments;
}

std::vector<double> albedoBounds(const Brdf& source, const std::vector<Direction>& directions) {
    const double tolerance = std::max(boundAccuracy, 0.1 * source.defaultTolerance());
    std::map<std::array<long long, 3>, std::size_t> places;
    std::vector<Direction> distinct;
    std::vector<std::size_t> placeOf;
    for (const Direction& d : directions) {
        const auto [place, isNew] = places.emplace(keyOf(d, source.laws()), distinct.size());
        if (isNew) distinct.push_back(d);
        placeOf.push_back(place->second);
    }
    std::vector<std::vector<double>> albedos(distinct.size());
    tbb::parallel_for(std::size_t{0}, distinct.size(), [&](std::size_t k) {
        albedos[k] = directionalAlbedo(source, distinct[k], tolerance);
    });
    // Conservation of energy bounds the reflectance, which is the albedo of a reciprocal BRDF only.
    const bool atMostOne = source.laws().energyConserving && source.laws().reciprocal;
    std::vector<double> bounds;
    for (const std::size_t place : placeOf) {
        for (const double albedo : albedos[place]) {
            bounds.push_back(atMostOne ? std::min(albedo, 1.0) : albedo);
        }
    }
    return bounds;
}

std::vector<Direction> albedoChecks(const OutgoingSet& set) {
    std::vector<Direction> checks = set.directions;
    const auto add = [&](double px, double py) {
        const double r2 = px * px + py * py;
        const Direction d{2 * px / (1 + r2), 2 * py / (1 + r2), (1 - r2) / (1 + r2)};
        if (d.z >= std::cos(lowestRing)) checks.push_back(d);
    };
    if (set.map == OutgoingSet::Map::elevations) {
        for (int k = 0; k + 1 < set.width; ++k) add((k + 0.5) / (set.width - 0.5), 0);
        checks.push_back(directionFromAngles(lowestRing, 0));
    }
    if (set.map == OutgoingSet::Map::parabolic) {
        const auto centre = [](double i, int n) { return (2 * i + 1 - n) / (n - 2); };
        for (double j = 0; j <= set.height - 1; j += 0.5) {
            for (double i = 0; i <= set.width - 1; i += 0.5) {
                if (i == std::floor(i) && j == std::floor(j)) continue;
                add(centre(i, set.width), centre(j, set.height));
            }
        }
        const int around = 4 * std::max(set.width, set.height);
        for (int j = 0; j < around; ++j) {
            checks.push_back(directionFromAngles(lowestRing, (j + 0.5) * 2 * pi / around));
        }
    }
    return checks;
}

std::vector<double> albedoTargets(const std::vector<double>& albedos,
                                  const std::vector<double>& solidAngles,
                                  const std::vector<InterpolatedBound>& bounds, int mostSweeps) {
    constexpr double enough = 1e-10;
    // Texels without a solid angle cost a little, so that they do not take all of a correction.
    double mean = 0;
    for (const double angle : solidAngles) mean += angle / static_cast<double>(solidAngles.size());
    std::vector<double> cost, targets = albedos, multipliers(bounds.size(), 0.0);
    for (const double angle : solidAngles) cost.push_back(std::max(angle, 0.01 * mean));
    std::vector<double> floors = albedos, floorMultipliers(albedos.size(), 0.0);
    for (double& floor : floors) floor = std::min(floor, 0.0);
    double worst = 0;
    for (int sweep = 0; sweep < mostSweeps; ++sweep) {
        worst = 0;
        for (std::size_t p = 0; p < bounds.size(); ++p) {
            const OutgoingLookup& at = bounds[p].lookup;
            double excess = -bounds[p].most, scale = 0;
            for (int k = 0; k < at.count; ++k) {
                excess += at.weight[k] * targets[at.index[k]];
                scale += at.weight[k] * at.weight[k] / cost[at.index[k]];
            }
            worst = std::max(worst, excess);
            const double step = std::max(-multipliers[p], excess / scale);
            multipliers[p] += step;
            for (int k = 0; k < at.count; ++k) {
                targets[at.index[k]] -= step * at.weight[k] / cost[at.index[k]];
            }
        }
        for (std::size_t o = 0; o < targets.size(); ++o) {
            const double step = std::max(-floorMultipliers[o], (floors[o] - targets[o]) * cost[o]);
            floorMultipliers[o] += step;
            targets[o] += step / cost[o];
        }
        if (worst <= enough) return targets;
    }
    if (worst > boundAccuracy) {
        throw NumericError(
            fmt::format("albedos below those of the BRDF were not found in {} sweeps: one is still "
                        "{:.1e} above its bound",
                        mostSweeps, worst));
    }
    return targets;
}

}  // namespace hshfit::inline representation::inline constraints
