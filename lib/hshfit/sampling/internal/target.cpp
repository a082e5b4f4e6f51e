#include <hshfit/sampling/internal/target.h>

#include <hshfit/quadrature/quadrature.h>
#include <hshfit/quadrature/ring_points.h>
#include <hshfit/sampling/internal/elevation_bins.h>
#include <hshfit/sampling/internal/mirror_cells.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace hshfit::inline sampling {

double meanMagnitude(std::span<const double> f, std::size_t k, std::size_t count,
                     std::size_t channels) {
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c) sum += std::abs(f[c * count + k]);
    // Values beyond this would overflow in squares.
    return std::isfinite(sum) ? std::min(sum / static_cast<double>(channels), 1e100) : 0;
}

namespace {

/// Adds f cos(theta_i) at the nodes of one of the two quadratures. Solid angles are halved, since
/// the target is their mean.
void addNodes(const Brdf& brdf, DirectionBatch wi, const std::vector<double>& solidAngles,
              Target& target) {
    const std::size_t channels = brdf.channels().count();
    std::vector<double> f(wi.count * channels, 0.0);
    brdf.eval(target.wo, wi, f.data());
    for (std::size_t j = 0; j < wi.count; ++j) {
        target.wi.push_back({wi.x[j], wi.y[j], wi.z[j]});
        target.solidAngle.push_back(solidAngles[j] / 2);
        target.value.push_back(meanMagnitude(f, j, wi.count, channels) * wi.z[j]);
        target.total += target.value.back() * target.solidAngle.back();
    }
}

/// The quadrature that follows from the lobes which f names.
void addRings(const Brdf& brdf, Target& target) {
    const Direction& wo = target.wo;
    const HemisphereGrid grid =
        gridFor(brdf.lobes(wo), wo, {.order = 1, .level = 0, .squeezed = true}, brdf.kinks(wo));
    RingPoints points(grid);
    std::vector<double> solidAngles;
    while (points.next()) {
        solidAngles.clear();
        for (std::size_t j = 0; j < points.count(); ++j) solidAngles.push_back(points.weight(j));
        addNodes(brdf, points.directions(), solidAngles, target);
    }
}

/// Cells about the mirror direction at every scale, for lobes that f does not name.
void addMirrorCells(const Brdf& brdf, Target& target) {
    const MirrorPolar polar(target.wo);
    const MirrorCells cells(48);
    const std::size_t n = cells.columns();
    std::vector<double> x(n), y(n), z(n), solidAngles(n);
    for (std::size_t r = 0; r < cells.rows(); ++r) {
        for (std::size_t c = 0; c < n; ++c) {
            const double psi = 0.5 * (cells.angles[c] + cells.angles[c + 1]);
            const double share = 0.5 * (cells.radii[r] + cells.radii[r + 1]);
            const double reach = polar.reach(std::cos(psi));
            const Direction wi = polar.direction(share, std::cos(psi), std::sin(psi));
            x[c] = wi.x, y[c] = wi.y, z[c] = wi.z;
            solidAngles[c] = cells.area(r, c) * reach * reach / wi.z;
        }
        addNodes(brdf, {x.data(), y.data(), z.data(), n}, solidAngles, target);
    }
}

}  // namespace

Target targetAt(const Brdf& brdf, const Direction& wo) {
    Target target{.wo = wo, .wi = {}, .solidAngle = {}, .value = {}};
    addRings(brdf, target);
    addMirrorCells(brdf, target);
    return target;
}

std::vector<Target> targetsAtHeight(const Brdf& brdf, double cosine, double sine) {
    std::vector<Target> targets;
    for (const double phi : {0.3, 1.2, 2.5}) {
        targets.push_back(targetAt(brdf, {sine * std::cos(phi), sine * std::sin(phi), cosine}));
        if (brdf.laws().isotropic) break;
    }
    return targets;
}

std::vector<Target> targetsOfBin(const Brdf& brdf, std::size_t bin, std::size_t bins) {
    const double s = (static_cast<double>(bin) + 0.5) / static_cast<double>(bins);
    const Direction middle = directionOfBin(s, 0);
    return targetsAtHeight(brdf, middle.z, middle.x);
}

NodeDensities densitiesAt(const Sampler& sampler, std::span<const Target> targets) {
    NodeDensities densities;
    for (const Target& target : targets)
        for (const Direction& wi : target.wi)
            densities.push_back(std::min(sampler.pdf(target.wo, wi), 1e100));
    return densities;
}

namespace {

/// Squares of the target over solid angle and total, node by node.
std::vector<double> squares(std::span<const Target> targets) {
    std::vector<double> all;
    for (const Target& target : targets)
        for (std::size_t j = 0; j < target.wi.size(); ++j) {
            const double part = target.total > 0 ? target.value[j] / target.total : 0;
            all.push_back(part * part * target.solidAngle[j]);
        }
    return all;
}

}  // namespace

LeastMoment leastSecondMoment(std::span<const Target> targets,
                              std::span<const NodeDensities* const> parts, double leastFirst,
                              int steps) {
    const std::vector<double> square = squares(targets);
    const double count = static_cast<double>(std::max<std::ptrdiff_t>(
        1, std::ranges::count_if(targets, [](const Target& target) { return target.total > 0; })));
    LeastMoment best{std::vector<double>(parts.size(), 1 / static_cast<double>(parts.size()))};
    std::vector<double>& shares = best.shares;
    std::vector<double> slope(parts.size());
    // A block of nodes at a time, which stays in the cache.
    constexpr std::size_t block = 512;
    using Block = Eigen::Array<double, Eigen::Dynamic, 1, 0, block, 1>;
    const auto nodes = [&](const std::vector<double>& all, std::size_t from) {
        return Eigen::Map<const Eigen::ArrayXd>(
            all.data() + from, static_cast<Eigen::Index>(std::min(block, all.size() - from)));
    };
    Block density, inverse, term;
    for (int step = 0; step <= steps; ++step) {
        best.moment = 0;
        std::ranges::fill(slope, 0.0);
        for (std::size_t from = 0; from < square.size(); from += block) {
            const auto here = nodes(square, from);
            density = shares[0] * nodes(*parts[0], from);
            for (std::size_t k = 1; k < parts.size(); ++k)
                density += shares[k] * nodes(*parts[k], from);
            inverse = (here > 0).select(density.inverse(), 0);
            term = here * inverse;
            best.moment += term.sum() / count;
            term *= inverse;
            for (std::size_t k = 0; k < parts.size(); ++k)
                slope[k] += (term * nodes(*parts[k], from)).sum();
        }
        if (step == steps || best.moment == 0) break;
        double sum = 0;
        for (std::size_t k = 0; k < parts.size(); ++k) sum += shares[k] *= std::sqrt(slope[k]);
        for (double& share : shares) share /= sum;
        if (shares[0] >= leastFirst || parts.size() == 1) continue;
        const double scale = (1 - leastFirst) / (1 - shares[0]);
        for (double& share : shares) share *= scale;
        shares[0] = leastFirst;
    }
    return best;
}

}  // namespace hshfit::inline sampling
