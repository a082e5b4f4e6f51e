#include <hshfit/bases/catalog.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/transfer/shading.h>

#include <random>

#include <gtest/gtest.h>

#include "quadrature_rules.h"

namespace hshfit {
namespace {

std::vector<float> randomFloats(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::vector<float> values(count);
    for (float& value : values) value = normal(random);
    return values;
}

TEST(Shading, BatchesOfAnySizeAreDotProducts) {
    const std::size_t slots = 100;
    for (const std::size_t vertices : {0, 1, 3, 7, 8, 31, 32, 33, 100}) {
        const std::vector<float> one = randomFloats(slots, 1);
        const std::vector<float> each = randomFloats(slots * vertices, 2);
        const std::vector<float> light = randomFloats(slots * vertices, 3);
        std::vector<float> out(vertices), own(vertices);
        shade(one, light.data(), vertices, out.data());
        shade(slots, each.data(), light.data(), vertices, own.data());
        for (std::size_t v = 0; v < vertices; ++v) {
            double expected = 0, expectedOwn = 0;
            for (std::size_t i = 0; i < slots; ++i) {
                expected += static_cast<double>(one[i]) * light[i * vertices + v];
                expectedOwn +=
                    static_cast<double>(each[i * vertices + v]) * light[i * vertices + v];
            }
            EXPECT_NEAR(out[v], expected, 1e-4);
            EXPECT_NEAR(own[v], expectedOwn, 1e-4);
        }
    }
}

Coefficients randomSet(const std::string& basis, int order, bool bilateral) {
    Coefficients set;
    set.basis = basis;
    set.order = order;
    set.quantity = Quantity::brdfCosine;
    set.channels = Channels::rgb();
    set.outgoing = OutgoingSet::elevations(9);
    set.isotropic = true;
    set.bilateral = bilateral;
    set.values.resize(9 * 3 * set.slots());
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const auto functions = bases::make(basis, order);
    for (std::size_t k = 0; k < 9; ++k) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            for (int l = 0; l < order; ++l) {
                for (int m = bilateral ? 0 : -l; m <= l; ++m) {
                    if (functions->has(l, m)) set.at(k, channel)[slotOf(l, m)] = normal(random);
                }
            }
        }
    }
    return set;
}

TEST(Shading, TablesGiveTheIntegralOfReconstructionTimesLight) {
    for (const auto& [name, bilateral] : {std::pair("hsh", true), {"hsh", false}, {"esh", true}}) {
        const int order = 5;
        const Coefficients set = randomSet(name, order, bilateral);
        const Reconstruction brdf(set);
        const std::size_t slots = set.slots(), vertices = 21;
        const std::vector<float> light = randomFloats(3 * slots * vertices, 6);
        std::vector<float> z, cosine, sine, out(3 * vertices);
        std::mt19937_64 random(8);
        std::uniform_real_distribution<double> unit;
        for (std::size_t v = 0; v < vertices; ++v) {
            const double phi = 2 * pi * unit(random);
            z.push_back(static_cast<float>(v == 0   ? 1
                                           : v == 1 ? 0.001
                                           : v == 2 ? -0.5
                                                    : unit(random)));
            cosine.push_back(static_cast<float>(std::cos(phi)));
            sine.push_back(static_cast<float>(std::sin(phi)));
        }
        ShadingTable(set).shade({z.data(), cosine.data(), sine.data(), vertices}, light.data(),
                                out.data());
        std::vector<double> values(slots);
        for (std::size_t v = 0; v < vertices; ++v) {
            const double side = std::sqrt(std::max(0.0, 1 - static_cast<double>(z[v]) * z[v]));
            const Direction wo{side * cosine[v], side * sine[v], z[v]};
            double expected[3] = {0, 0, 0};
            // Turned about the pole itself the lookup has no azimuth.
            if (v == 0) continue;
            rules::eachPoint(16, 16, false, [&](const Direction& wi, double weight) {
                double q[3];
                brdf.evalQuantity(wo, {&wi.x, &wi.y, &wi.z, 1}, q);
                brdf.basis().evaluate(wi, values.data());
                for (std::size_t channel = 0; channel < 3; ++channel) {
                    double sum = 0;
                    for (std::size_t i = 0; i < slots; ++i) {
                        sum += light[(channel * slots + i) * vertices + v] * values[i];
                    }
                    expected[channel] += weight * q[channel] * sum;
                }
            });
            for (std::size_t channel = 0; channel < 3; ++channel) {
                EXPECT_NEAR(out[channel * vertices + v], expected[channel], 5e-5)
                    << name << " " << v;
            }
        }
    }
}

TEST(Shading, OnlyIsotropicElevationSetsOfOrthonormalBases) {
    Coefficients set = randomSet("hsh", 3, true);
    set.isotropic = false;
    EXPECT_THROW(ShadingTable{set}, UsageError);
    set = randomSet("lsosh", 3, true);
    EXPECT_THROW(ShadingTable{set}, UsageError);
    set = randomSet("hsh", 3, true);
    set.outgoing = OutgoingSet::direction(0.3, 0);
    EXPECT_THROW(ShadingTable{set}, UsageError);
}

}  // namespace
}  // namespace hshfit
