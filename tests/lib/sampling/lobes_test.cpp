// Every density of the library integrates to 1, and its samples follow it.

#include "sampling_laws.h"

#include <hshfit/sampling/axis_lobes.h>
#include <hshfit/sampling/visible_normals.h>

#include <gtest/gtest.h>

namespace hshfit::test {
namespace {

struct Named {
    std::string name;
    std::shared_ptr<const Sampler> sampler;
};

std::vector<Named> catalog() {
    std::vector<Named> all{{"cosine", cosineSampler()}};
    const auto add = [&](const std::string& name, auto sampler) { all.push_back({name, sampler}); };
    for (const double exponent : {0., 1., 22., 1e3, 1e6}) {
        const std::string text = fmt::format(" {}", exponent);
        add("power cosine, mirror" + text, powerCosineSampler(mirrorAxis, exponent));
        add("power cosine, normal" + text, powerCosineSampler(normalAxis, exponent));
        add("power cosine, skew" + text, powerCosineSampler({-1, .3, .2}, exponent));
        add("power cosine, retro" + text, powerCosineSampler({1, 1, 1}, exponent));
        add("Gaussian, mirror" + text, gaussianLobeSampler(mirrorAxis, exponent));
        add("power normals" + text, grooveSampler(powerNormals(exponent + 1, exponent + 1)));
    }
    add("power normals, anisotropic", grooveSampler(powerNormals(10, 1000)));
    struct Axes {
        double x, y;
    };
    for (const Axes a : {Axes{1e-4, 1e-4}, {.01, .01}, {.3, .3}, {1, 1}, {.05, .8}, {10, 10}}) {
        const std::string text = fmt::format(" {},{}", a.x, a.y);
        add("GGX" + text, ggxSampler(a.x, a.y));
        add("Beckmann" + text, beckmannSampler(a.x, a.y));
        add("Gaussian normals" + text, grooveSampler(gaussianNormals(a.x, a.y)));
    }
    for (const double alpha : {1e-4, .2, 1.})
        for (const double gamma : {.1, 1., 1.5, 10.})
            add(fmt::format("GTR {},{}", alpha, gamma), grooveSampler(gtrNormals(alpha, gamma)));
    return all;
}

const std::vector<Direction>& outgoing() {
    static const std::vector<Direction> all{{0, 0, 1},
                                            directionFromAngles(.5, .7),
                                            directionFromAngles(1.2, -2),
                                            directionFromAngles(radians(89.99), 2.5)};
    return all;
}

TEST(Lobes, SamplesFollowDensitiesThatIntegrateToOne) {
    const std::vector<Named> all = catalog();
    const double least = sidak(all.size() * outgoing().size());
    std::uint64_t seed = 1;
    for (const Named& lobe : all)
        for (const Direction& wo : outgoing()) {
            SCOPED_TRACE(fmt::format("{}, theta_o {}", lobe.name, degrees(polarAngle(wo))));
            const SamplerLaws laws = lawsAt(*lobe.sampler, wo, 20000, ++seed);
            EXPECT_NEAR(laws.integral, 1, 2e-3);
            EXPECT_GT(laws.fit.probability, least) << laws.fit.groups;
            EXPECT_EQ(laws.unequal, 0U);
            EXPECT_EQ(laws.below, 0U);
        }
}

TEST(Lobes, OutgoingDirectionsBelowTheHorizonAndNaNHaveNoDensity) {
    const Direction nothing{std::nan(""), std::nan(""), std::nan("")}, up{}, below{.6, 0, -.8};
    for (const Named& lobe : catalog()) {
        for (const Direction& wo : {nothing, below, Direction{1, 0, 0}}) {
            EXPECT_EQ(lobe.sampler->sample(wo, {.5, .5, .5}).pdf, 0) << lobe.name;
            EXPECT_EQ(lobe.sampler->pdf(wo, up), 0) << lobe.name;
        }
        for (const Direction& wi : {nothing, below, Direction{1, 0, 0}})
            EXPECT_EQ(lobe.sampler->pdf(up, wi), 0) << lobe.name;
    }
}

/// The ends of the unit interval and directions at the horizon, down to the smallest doubles.
TEST(Lobes, ExtremeNumbersGiveUnitDirections) {
    constexpr double last = 1 - 0x1p-53;
    for (const Named& lobe : catalog())
        for (const double z : {1., 1e-4, 1e-15, 1e-300, 5e-324})
            for (const double a : {0., .5, last})
                for (const double b : {0., .25, last})
                    for (const double c : {0., last}) {
                        const Direction wo{std::sqrt(1 - z * z), 0, z};
                        const Sample s = lobe.sampler->sample(wo, {a, b, c});
                        ASSERT_NEAR(dot(s.wi, s.wi), 1, 1e-12) << lobe.name << " " << z;
                        ASSERT_GT(s.wi.z, 0) << lobe.name << " " << z;
                        ASSERT_GE(s.pdf, 0) << lobe.name << " " << z;
                    }
}

/// Walter et al. 2007: D of GGX and Smith's G1 as printed, from angles.
TEST(Lobes, GgxDensityIsThatOfVisibleNormals) {
    const double alpha = .4;
    const Direction wo = directionFromAngles(1.0, 0), wi = directionFromAngles(.6, 2.5);
    const double half = std::sqrt((1 + dot(wi, wo)) / 2), hz = (wi.z + wo.z) / (2 * half);
    const auto density = [&](double cosine) {
        const double tan2 = 1 / (cosine * cosine) - 1, a2 = alpha * alpha;
        return a2 / (pi * std::pow(cosine, 4) * std::pow(a2 + tan2, 2));
    };
    const auto masking = [&](double theta) {
        return 2 / (1 + std::sqrt(1 + std::pow(alpha * std::tan(theta), 2)));
    };
    const double up = density(hz) * masking(1.0) / (4 * wo.z);
    const Direction down{wi.x, wi.y, -wi.z};
    const double halfDown = std::sqrt((1 + dot(down, wo)) / 2);
    const double hzDown = (down.z + wo.z) / (2 * halfDown);
    const double below = hzDown > 0 ? density(hzDown) * masking(1.0) / (4 * wo.z) : 0;
    EXPECT_NEAR(ggxSampler(alpha, alpha)->pdf(wo, wi), up + below, 1e-12);
}

}  // namespace
}  // namespace hshfit::test
