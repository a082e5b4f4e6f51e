#include <brdfs/fit/instrument/veil.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace hshfit::brdfs {
namespace {

constexpr int finest = 8;

/// Nodes over wo, with the factors of V.
struct Nodes {
    std::vector<Direction> wo;
    std::vector<double> factors;
};

Nodes nodesAt(const Brdf& brdf, const Direction& wi, int level) {
    Nodes nodes;
    const HemisphereGrid grid = gridFor(brdf.lobes(wi), wi, {.level = level, .squeezed = true});
    RingPoints points(grid);
    while (points.next()) {
        for (std::size_t j = 0; j < points.count(); ++j) {
            nodes.wo.push_back(points.direction(j));
            nodes.factors.push_back(points.weight(j) * nodes.wo.back().z / pi);
        }
    }
    // A constant f keeps its value.
    double sum = 0;
    for (const double factor : nodes.factors) sum += factor;
    for (double& factor : nodes.factors) factor /= sum;
    return nodes;
}

std::vector<double> meanOver(const Brdf& brdf, const Direction& wi, const Nodes& nodes) {
    const std::size_t channels = brdf.channels().count();
    std::vector<double> f(channels), mean(channels, 0);
    for (std::size_t j = 0; j < nodes.wo.size(); ++j) {
        brdf.eval(nodes.wo[j], {&wi.x, &wi.y, &wi.z, 1}, f.data());
        for (std::size_t c = 0; c < channels; ++c) mean[c] += nodes.factors[j] * f[c];
    }
    return mean;
}

double changeOf(const std::vector<double>& a, const std::vector<double>& b) {
    double change = 0;
    for (std::size_t c = 0; c < a.size(); ++c)
        if (b[c] != 0) change = std::max(change, std::abs(a[c] - b[c]) / std::abs(b[c]));
    return change;
}

Nodes adequateNodes(const Brdf& brdf, const Direction& wi, double tolerance) {
    Nodes own = nodesAt(brdf, wi, 0);
    std::vector<double> mean = meanOver(brdf, wi, own);
    for (int level = 1; level <= finest; ++level) {
        Nodes next = nodesAt(brdf, wi, level);
        std::vector<double> finer = meanOver(brdf, wi, next);
        if (changeOf(mean, finer) <= tolerance) return own;
        own = std::move(next);
        mean = std::move(finer);
    }
    throw NumericError(fmt::format(
        "the mean radiance of the hemisphere, for stray light, was not found to {} at {:.3f} "
        "degrees of incidence",
        tolerance, degrees(polarAngle(wi))));
}

}  // namespace

Veil veilOf(const Brdf& brdf, const FitSamples& samples, double tolerance) {
    Veil veil;
    FitSamples& own = veil.sums;
    own.channels = samples.channels;
    own.isotropic = samples.isotropic;
    std::map<std::tuple<double, double, double>, std::size_t> known;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const auto [place, fresh] =
            known.try_emplace({samples.wiX[k], samples.wiY[k], samples.wiZ[k]}, known.size());
        veil.of.push_back(place->second);
        if (!fresh) continue;
        own.wiX.push_back(samples.wiX[k]);
        own.wiY.push_back(samples.wiY[k]);
        own.wiZ.push_back(samples.wiZ[k]);
        own.wo.push_back({});
    }
    std::vector<Nodes> all(own.size());
    eachInParallel(all.size(), [&](std::size_t i) {
        all[i] = adequateNodes(brdf, {own.wiX[i], own.wiY[i], own.wiZ[i]}, tolerance);
    });
    NodeSums sums;
    for (std::size_t i = 0; i < all.size(); ++i) {
        own.sumRows.push_back(i);
        sums.rows.push_back({.firstNode = sums.size(),
                             .nodes = all[i].wo.size(),
                             .firstFactor = sums.factors.size()});
        for (std::size_t j = 0; j < all[i].wo.size(); ++j) {
            sums.wiX.push_back(own.wiX[i]);
            sums.wiY.push_back(own.wiY[i]);
            sums.wiZ.push_back(own.wiZ[i]);
            sums.wo.push_back(all[i].wo[j]);
            sums.factors.push_back(all[i].factors[j]);
        }
        all[i] = {};
    }
    own.values.assign(own.size() * own.channels.count(), 0);
    own.weights.assign(own.size(), 1);
    own.sums = std::make_shared<const NodeSums>(std::move(sums));
    return veil;
}

double veilChange(const Veil& veil, const Brdf& brdf, double tolerance) {
    const FitSamples& own = veil.sums;
    std::vector<double> changes(own.size(), 0);
    eachInParallel(own.size(), [&](std::size_t i) {
        const Direction wi{own.wiX[i], own.wiY[i], own.wiZ[i]};
        const NodeSums::Row& row = own.sums->rows[i];
        Nodes before;
        for (std::size_t j = 0; j < row.nodes; ++j) {
            before.wo.push_back(own.sums->wo[row.firstNode + j]);
            before.factors.push_back(own.sums->factors[row.firstFactor + j]);
        }
        changes[i] = changeOf(meanOver(brdf, wi, before),
                              meanOver(brdf, wi, adequateNodes(brdf, wi, tolerance)));
    });
    return changes.empty() ? 0 : *std::ranges::max_element(changes);
}

}  // namespace hshfit::brdfs
