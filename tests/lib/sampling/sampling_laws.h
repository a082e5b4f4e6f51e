#pragma once

#include <hshfit/sampling/efficiency.h>
#include <hshfit/sampling/sampler.h>

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <queue>
#include <vector>

namespace hshfit::test {

/// The hemisphere by polar coordinates about the mirror direction in the projected disc, which
/// reach lobes of every width: x in (0, 1), the share of the distance to the edge is 2^(-40 x^2);
/// y in (0, 1) the angle,
/// squeezed towards the tangent of the disc's edge for wo near the horizon. `solidAngle` is d omega
/// / (dx dy).
struct MirrorChart {
    Direction wo;

    struct Point {
        Direction wi;
        double solidAngle;
    };
    double reach(double cosine) const {
        const double along = std::hypot(wo.x, wo.y) * cosine;
        const double root = std::sqrt(along * along + wo.z * wo.z);
        return along > 0 ? along + root : wo.z * wo.z / (root - along);
    }
    Point at(double x, double y) const {
        const double turn = 2 * pi * y - pi, squeeze = std::pow(wo.z, 0.25);
        const double u = squeeze * std::cos(turn), v = std::sin(turn), length = std::hypot(u, v);
        const double c = u / length, s = v / length, most = reach(c);
        const double share = std::exp2(-40 * x * x), r = share * most;
        const double rest = -std::expm1(-40 * x * x * std::numbers::ln2);
        const double z = std::sqrt(rest * (share * most * most + wo.z * wo.z));
        const double phi = azimuth(wo), cp = std::cos(phi), sp = std::sin(phi);
        const Direction wi{cp * r * c - sp * r * s - wo.x, sp * r * c + cp * r * s - wo.y, z};
        return {wi, r * r * 80 * x * std::numbers::ln2 * 2 * pi * squeeze / (length * length) / z};
    }
    std::array<double, 2> of(const Direction& wi) const {
        const double phi = azimuth(wo), cp = std::cos(phi), sp = std::sin(phi);
        const double dx = wi.x + wo.x, dy = wi.y + wo.y, u = cp * dx + sp * dy,
                     v = cp * dy - sp * dx;
        const double r = std::hypot(u, v), share = r / reach(r > 0 ? u / r : 1);
        const double x = share > 0 ? std::sqrt(std::max(0.0, -std::log2(share)) / 40) : 1;
        return {std::min(x, 1.0), (std::atan2(v, u / std::pow(wo.z, 0.25)) + pi) / (2 * pi)};
    }
};

/// Cells of the chart, halved where samples lie or where the density varies, with the integral of
/// the density over each by 3 x 3 Gauss points.
class Partition {
public:
    Partition(const Sampler& sampler, const Direction& wo, const std::vector<Direction>& samples,
              std::size_t mostCells = 60000)
        : sampler_(sampler), chart_{wo} {
        constexpr int start = 24;
        for (int i = 0; i < start; ++i)
            for (int j = 0; j < start; ++j) {
                const double step = 1. / start;
                roots_.push_back(add(i * step, j * step, step));
            }
        // Cells that hold many samples, whatever the density says of them.
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const std::size_t leaf = leafOf(samples[k]);
            const std::size_t crowd = samples.size() / 1000;
            if (++cells_[leaf].crowd > crowd && cells_[leaf].side > 1e-5) split(leaf);
        }
        std::priority_queue<std::pair<double, std::size_t>> open;
        for (std::size_t k = 0; k < cells_.size(); ++k)
            if (!cells_[k].child) open.push({cells_[k].error, k});
        while (!open.empty() && cells_.size() < mostCells && open.top().first > 1e-7) {
            const std::size_t cell = open.top().second;
            open.pop();
            split(cell);
            for (std::size_t k = 0; k < 4; ++k)
                open.push({cells_[cells_[cell].child + k].error, cells_[cell].child + k});
        }
    }

    double integral() const {
        double sum = 0;
        for (const Cell& cell : cells_) sum += cell.child ? 0 : cell.mass;
        return sum;
    }

    struct Fit {
        double probability = 1;  ///< that chance alone deviates as much
        std::size_t groups = 0;
    };
    /// Pearson's test of counts in groups of neighbouring cells, each with `least` expected
    /// samples.
    Fit chiSquare(const std::vector<Direction>& samples, double least = 20) const {
        std::vector<double> counts(cells_.size(), 0.0);
        for (const Direction& wi : samples) ++counts[leafOf(wi)];
        const double n = static_cast<double>(samples.size());
        std::vector<std::array<double, 2>> groups{{0, 0}};
        for (const std::size_t root : roots_) gather(root, n, least, counts, groups);
        if (groups.back()[0] < least && groups.size() > 1) {
            const std::array<double, 2> rest = groups.back();
            groups.pop_back();
            groups.back()[0] += rest[0], groups.back()[1] += rest[1];
        }
        double statistic = 0;
        for (const auto& [expected, found] : groups)
            statistic += (found - expected) * (found - expected) / expected;
        if (groups.size() < 2) return {1, groups.size()};
        if (!std::isfinite(statistic)) return {0, groups.size()};
        const boost::math::chi_squared law(static_cast<double>(groups.size() - 1));
        return {boost::math::cdf(boost::math::complement(law, statistic)), groups.size()};
    }

private:
    struct Cell {
        double x, y, side, mass, error;
        std::size_t child = 0, crowd = 0;  ///< child: the first of four; 0: none
    };

    std::size_t add(double x, double y, double side) {
        constexpr double far = 0.77459666924148338;  // sqrt(3/5)
        constexpr double nodes[] = {-far, 0, far}, weights[] = {5. / 18, 8. / 18, 5. / 18};
        double mass = 0, low = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) {
                const auto at =
                    chart_.at(x + side * (0.5 + 0.5 * nodes[i]), y + side * (0.5 + 0.5 * nodes[j]));
                const double value = sampler_.pdf(chart_.wo, at.wi) * at.solidAngle * side * side;
                mass += weights[i] * weights[j] * value;
                if (i == 1 && j == 1) low = value;
            }
        cells_.push_back({x, y, side, mass, std::abs(mass - low)});
        return cells_.size() - 1;
    }

    void split(std::size_t cell) {
        const Cell parent = cells_[cell];
        const double half = parent.side / 2;
        const std::size_t first = cells_.size();
        double sum = 0;
        for (int k = 0; k < 4; ++k) {
            const std::size_t made =
                add(parent.x + (k & 1) * half, parent.y + (k >> 1) * half, half);
            sum += cells_[made].mass;
        }
        // The change by halving tells more of the error than the middle node does.
        for (std::size_t k = first; k < first + 4; ++k)
            cells_[k].error = std::abs(sum - parent.mass) + 0.05 * cells_[k].error;
        cells_[cell].child = first;
    }

    std::size_t leafOf(const Direction& wi) const {
        constexpr int start = 24;
        const auto [x, y] = chart_.of(wi);
        const auto at = [](double v) {
            return std::clamp(static_cast<int>(v * start), 0, start - 1);
        };
        std::size_t cell = roots_[static_cast<std::size_t>(at(x) * start + at(y))];
        while (cells_[cell].child) {
            const Cell& c = cells_[cell];
            const double half = c.side / 2;
            cell = c.child + (x >= c.x + half ? 1 : 0) + (y >= c.y + half ? 2 : 0);
        }
        return cell;
    }

    void gather(std::size_t cell, double n, double least, const std::vector<double>& counts,
                std::vector<std::array<double, 2>>& groups) const {
        if (const std::size_t child = cells_[cell].child) {
            for (std::size_t k = 0; k < 4; ++k) gather(child + k, n, least, counts, groups);
            return;
        }
        if (groups.back()[0] >= least) groups.push_back({0, 0});
        groups.back()[0] += n * cells_[cell].mass;
        groups.back()[1] += counts[cell];
    }

    const Sampler& sampler_;
    MirrorChart chart_;
    std::vector<Cell> cells_;
    std::vector<std::size_t> roots_;
};

struct SamplerLaws {
    double integral = 0;
    Partition::Fit fit;
    std::size_t unequal = 0;  ///< samples whose pdf is not pdf(), or is not above 0
    std::size_t below = 0;    ///< samples that are not unit vectors above the horizon
};

/// The laws of a sampler at one outgoing direction: half as many samples as are counted place the
/// cells.
inline SamplerLaws lawsAt(const Sampler& sampler, const Direction& wo, std::size_t count,
                          std::uint64_t seed) {
    SamplerLaws laws;
    UniformNumbers numbers(seed);
    std::vector<Direction> placing, counted;
    for (std::size_t k = 0; k < count + count / 2; ++k) {
        const Sample s = sampler.sample(wo, numbers.next());
        laws.unequal += !(s.pdf > 0 && s.pdf == sampler.pdf(wo, s.wi));
        laws.below += !(s.wi.z > 0 && std::abs(dot(s.wi, s.wi) - 1) < 1e-12);
        (k < count / 2 ? placing : counted).push_back(s.wi);
    }
    const Partition partition(sampler, wo, placing);
    laws.integral = partition.integral();
    laws.fit = partition.chiSquare(counted);
    return laws;
}

/// The least p-value that `cases` independent tests may have, for a false alarm once in a
/// thousand runs (Sidak).
inline double sidak(std::size_t cases) {
    return -std::expm1(std::log1p(-1e-3) / static_cast<double>(cases));
}

}  // namespace hshfit::test
