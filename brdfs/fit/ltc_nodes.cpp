#include <brdfs/fit/ltc_nodes.h>

#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace hshfit::brdfs {

// Directions far from a narrow lobe are mapped close to the plane where the cosine is 0: a lobe of
// width a has, within a radians of that plane, all directions that are more than about 45 degrees
// away. Hence ever finer panels towards the ends.

const LtcRule& coarseRule() {
    static const LtcRule rule{.longitudes = {0, 0.05, 0.3, 0.7, 0.95, 1},
                              .latitudes = {0, 0.03, 0.2, 0.6, 1},
                              .nodes = 5};
    return rule;
}

const LtcRule& fineRule() {
    static const LtcRule rule{.longitudes = {0, 1e-5, 1e-4, 1e-3, 0.01, 0.06, 0.25, 0.5, 0.75, 0.94,
                                             0.99, 0.999, 0.9999, 0.99999, 1},
                              .latitudes = {0, 1e-3, 4e-3, 0.016, 0.06, 0.2, 0.5, 0.8, 0.95, 1},
                              .nodes = 4};
    return rule;
}

LtcRule settledRule(const Brdf& brdf, const Direction& wo, const Ltc& around, LtcRule rule,
                    double tolerance, int mostNodes) {
    for (double before = LtcNodes(brdf, wo, around, rule).integral(); rule.nodes < mostNodes;) {
        rule.nodes += rule.nodes / 2;
        const double now = LtcNodes(brdf, wo, around, rule).integral();
        if (std::abs(now - before) <= tolerance * now) break;
        before = now;
    }
    return rule;
}

namespace {

/// Longitudes, from z towards x, between which the cosine and cos(theta_i) do not change sign.
/// Longitudes where both are negative are left out.
std::array<double, 4> sectors(const Ltc& around) {
    const double up = std::atan2(-around.c, around.a);  // longitude of the surface's normal
    std::array<double, 4> ends{-pi / 2, pi / 2, up - pi / 2, up + pi / 2};
    std::ranges::sort(ends);
    return ends;
}

/// Calls visit(x, weight) at the nodes of [from, to] with panels between these fractions.
template <class Visit>
void forNodes(double from, double to, const std::vector<double>& fractions, int nodes,
              const Visit& visit) {
    const GaussRule& gauss = gaussLegendre(nodes);
    for (std::size_t panel = 0; panel + 1 < fractions.size(); ++panel) {
        const double a = from + (to - from) * fractions[panel];
        const double half = (from + (to - from) * fractions[panel + 1] - a) / 2;
        for (int k = 0; k < nodes; ++k)
            visit(a + half + half * gauss.nodes[k], half * gauss.weights[k]);
    }
}

}  // namespace

LtcNodes::LtcNodes(const Brdf& brdf, const Direction& wo, const Ltc& around, const LtcRule& rule) {
    std::vector<double> x, y, z;
    const auto add = [&](double longitude, double latitude, double area) {
        const double radius = std::cos(latitude);
        cosines.push_back(
            {radius * std::sin(longitude), std::sin(latitude), radius * std::cos(longitude)});
        const LtcDirection to = fromCosine(around, cosines.back());
        wi.push_back(to.w);
        stretches.push_back(to.stretch);
        weights.push_back(2 * area * radius * to.stretch);
        x.push_back(to.w.x);
        y.push_back(to.w.y);
        z.push_back(to.w.z);
    };
    const std::array<double, 4> ends = sectors(around);
    for (std::size_t sector = 0; sector < 3; ++sector) {
        constexpr double none = 1e-9;  // of which nothing can be seen
        if (ends[sector + 1] - ends[sector] < none) continue;
        forNodes(ends[sector], ends[sector + 1], rule.longitudes, rule.nodes,
                 [&](double longitude, double width) {
                     forNodes(0, pi / 2, rule.latitudes, rule.nodes,
                              [&](double latitude, double height) {
                                  add(longitude, latitude, width * height);
                              });
                 });
    }
    assert(brdf.channels().count() == 1);
    values.resize(wi.size());
    brdf.eval(wo, {x.data(), y.data(), z.data(), x.size()}, values.data());
    for (std::size_t k = 0; k < wi.size(); ++k) {
        values[k] *= std::max(wi[k].z, 0.0);
        if (!std::isfinite(values[k])) {
            throw NumericError(fmt::format(
                "{}: is not finite for wi at {:.4f},{:.4f} degrees and wo at {:.4f},0", brdf.name(),
                degrees(polarAngle(wi[k])), degrees(azimuth(wi[k])), degrees(polarAngle(wo))));
        }
    }
}

double LtcNodes::integral() const {
    double sum = 0;
    for (std::size_t k = 0; k < wi.size(); ++k) sum += weights[k] * values[k];
    return sum;
}

}  // namespace hshfit::brdfs
