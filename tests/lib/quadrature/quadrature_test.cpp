#include <hshfit/coefficients/outgoing.h>
#include <hshfit/error.h>
#include <hshfit/quadrature/quadrature.h>

#include <gtest/gtest.h>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include <cmath>
#include <limits>
#include <numeric>

namespace hshfit {
namespace {

using Wide = boost::multiprecision::cpp_bin_float_50;

/// One Newton step from x in 50 digits: the root next to it, and the weight 2 / ((1-x^2) P'^2).
std::pair<Wide, Wide> rootAndWeight(int n, double start) {
    Wide x = start, weight;
    for (int step = 0; step < 3; ++step) {
        Wide p = 1, previous = 0;
        for (int k = 0; k < n; ++k) {
            const Wide next = ((2 * k + 1) * x * p - k * previous) / (k + 1);
            previous = p;
            p = next;
        }
        const Wide slope = n * (x * p - previous) / (x * x - 1);
        weight = 2 / ((1 - x * x) * slope * slope);
        x -= p / slope;
    }
    return {x, weight};
}

TEST(GaussLegendre, NodesAndWeightsHoldToRounding) {
    const double eps = std::numeric_limits<double>::epsilon();
    for (int n : {1, 2, 3, 10, 63, 64, 501, 5000}) {
        const GaussRule& rule = gaussLegendre(n);
        ASSERT_EQ(rule.nodes.size(), static_cast<std::size_t>(n));
        for (int i : {0, 1, n / 3, n / 2, n - 1}) {
            if (i >= n) continue;
            const auto [x, w] = rootAndWeight(n, rule.nodes[i]);
            EXPECT_LE(std::abs(static_cast<double>(x - rule.nodes[i])), eps) << n << " " << i;
            EXPECT_LE(std::abs(static_cast<double>(rule.weights[i] / w - 1)), 4 * eps)
                << n << " " << i;
        }
        EXPECT_NEAR(std::accumulate(rule.weights.begin(), rule.weights.end(), 0.0), 2, 1e-13);
    }
    EXPECT_THROW(gaussLegendre(0), UsageError);
    EXPECT_THROW(gaussLegendre(1000000), UsageError);
}

TEST(HemisphereGrid, IntegratesTheHemisphere) {
    const Direction wo = directionFromAngles(radians(60), 0.4);
    const std::vector<Lobe> lobes = {{Lobe::About::halfway, 0.01}};
    for (int level : {0, 3}) {
        const HemisphereGrid grid = gridFor(lobes, wo, {.order = 7, .level = level});
        double area = 0, flux = 0;
        for (std::size_t r = 0; r < grid.weights.size(); ++r) {
            area += grid.weights[r];
            flux += grid.weights[r] * grid.elevations[r].mu;
        }
        EXPECT_NEAR(area, 1, 1e-13);
        EXPECT_NEAR(flux, 0.5, 1e-13);
    }
}

TEST(HemisphereGrid, CostGrowsWithTheLogarithmOfTheWidthInElevation) {
    const Direction wo = directionFromAngles(radians(45), 0);
    const auto rings = [&](double width) {
        const std::vector<Lobe> lobes = {{Lobe::About::halfway, width}};
        return gridFor(lobes, wo, {.order = 7}).weights.size();
    };
    EXPECT_LE(rings(1e-6), rings(1e-3) * 3);
    EXPECT_GT(rings(1e-3), rings(0.5));
}

/// Equal azimuths at two levels would show no change, whatever the error.
TEST(HemisphereGrid, NoTwoLevelsHaveTheSameRingsOrAzimuths) {
    const Direction wo = directionFromAngles(radians(40), 0.4);
    const std::vector<std::vector<Lobe>> all = {
        {}, {{Lobe::About::halfway, 0.3}}, {{Lobe::About::halfway, 0.01}}};
    for (const auto& lobes : all)
        for (int order = 4; order <= 40; ++order)
            for (const auto& [a, b] : {std::pair{0.0, 1.0}, {0.5, 0.75}, {0.875, 0.9375}}) {
                const AzimuthPeaks peaks(lobes, wo, a, b);
                std::size_t rings = 0, spread = 0;
                for (int level = 0; level < 5; ++level) {
                    HemisphereGrid grid;
                    appendPanel(grid, a, b, peaks,
                                {.order = order, .level = level, .squeezed = true});
                    const AzimuthSpacing& spacing = grid.panels[0].azimuths.spacing;
                    const std::size_t within = spacing.azimuths << spacing.squeeze;
                    EXPECT_GT(grid.panels[0].rings, rings) << order << " " << level;
                    EXPECT_GT(within, spread) << order << " " << level;
                    rings = grid.panels[0].rings, spread = within;
                }
            }
}

TEST(OutgoingSets, SolidAnglesCoverTheHemisphere) {
    for (const char* text : {"4x4", "32x32", "7x50", "2", "16", "301"}) {
        const OutgoingSet set = OutgoingSet::parse(text);
        double total = 0, flux = 0;
        for (std::size_t k = 0; k < set.size(); ++k) {
            const Direction& d = set.directions[k];
            EXPECT_NEAR(d.x * d.x + d.y * d.y + d.z * d.z, 1, 1e-14);
            EXPECT_GE(d.z, std::cos(radians(89)) - 1e-15);
            total += set.solidAngles[k];
            flux += set.solidAngles[k] * d.z;
        }
        EXPECT_NEAR(total, 2 * pi, 1e-12) << text;
        if (set.size() > 100) {
            EXPECT_NEAR(flux / pi, 1, 0.01) << text;
        }
    }
}

TEST(OutgoingSets, LookUpIsExactAtTheirDirectionsAndAnAverageBetween) {
    for (const char* text : {"8x8", "9x6", "12"}) {
        const OutgoingSet set = OutgoingSet::parse(text);
        for (std::size_t k = 0; k < set.size(); ++k) {
            if (set.solidAngles[k] == 0) continue;
            const OutgoingLookup found = lookUp(set, set.directions[k]);
            double own = 0;
            for (int i = 0; i < found.count; ++i) own += found.index[i] == k ? found.weight[i] : 0;
            EXPECT_NEAR(own, 1, 1e-12) << text << " " << k;
        }
        for (double theta = 0; theta < 90; theta += 7.3) {
            const OutgoingLookup found = lookUp(set, directionFromAngles(radians(theta), 2.1));
            double sum = 0;
            for (int i = 0; i < found.count; ++i) {
                EXPECT_GE(found.weight[i], 0);
                sum += found.weight[i];
            }
            EXPECT_NEAR(sum, 1, 1e-12);
        }
    }
}

TEST(OutgoingSets, RefuseWhatTheyCannotBe) {
    for (const char* text : {"", "x", "3x3", "32x", "0", "1", "-4", "90,0", "nan,0", "45,",
                             "45,0,0", "99999x99999", "32x32x3", "1e3"}) {
        EXPECT_THROW(OutgoingSet::parse(text), UsageError) << text;
    }
}

}  // namespace
}  // namespace hshfit
