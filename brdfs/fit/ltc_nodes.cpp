#include <brdfs/fit/ltc_nodes.h>

#include <hshfit/error.h>
#include <hshfit/quadrature.h>

#include <cassert>
#include <cmath>

#include <fmt/format.h>

namespace hshfit::brdfs {

// Heights z of the cosine near 0 are what lies far from a narrow lobe: a lobe of width a has there,
// within z < a, all directions that are more than about 45 degrees away. Hence ever finer panels.

const LtcRule& coarseRule() {
    static const LtcRule rule{.breaks = {0, 0.02, 0.15, 1}, .rings = 10, .azimuths = 16};
    return rule;
}

const LtcRule& fineRule() {
    static const LtcRule rule{
        .breaks = {0, 1e-5, 1e-4, 1e-3, 0.01, 0.08, 0.35, 1}, .rings = 8, .azimuths = 32};
    return rule;
}

const LtcRule& otherRule() {
    static const LtcRule rule{
        .breaks = {0, 3e-5, 3e-4, 3e-3, 0.03, 0.2, 1}, .rings = 7, .azimuths = 23};
    return rule;
}

LtcNodes::LtcNodes(const Brdf& brdf, const Direction& wo, const Ltc& around, const LtcRule& rule) {
    const GaussRule& gauss = gaussLegendre(rule.rings);
    std::vector<double> x, y, z;
    const auto addRing = [&](double height, double width) {
        const double sine = std::sqrt((1 - height) * (1 + height));
        for (int k = 0; k < rule.azimuths; ++k) {
            const double phi = (k + 0.5) * pi / rule.azimuths;
            cosines.push_back({sine * std::cos(phi), sine * std::sin(phi), height});
            const LtcDirection to = fromCosine(around, cosines.back());
            wi.push_back(to.w);
            stretches.push_back(to.stretch);
            weights.push_back(width * 2 * pi / rule.azimuths * to.stretch);
            x.push_back(to.w.x);
            y.push_back(to.w.y);
            z.push_back(to.w.z);
        }
    };
    for (std::size_t panel = 0; panel + 1 < rule.breaks.size(); ++panel) {
        const double middle = (rule.breaks[panel + 1] + rule.breaks[panel]) / 2;
        const double half = (rule.breaks[panel + 1] - rule.breaks[panel]) / 2;
        for (int k = 0; k < rule.rings; ++k) {
            addRing(middle + half * gauss.nodes[k], half * gauss.weights[k]);
            addRing(-middle - half * gauss.nodes[k], half * gauss.weights[k]);
        }
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

}  // namespace hshfit::brdfs
