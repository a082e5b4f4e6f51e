// Minnaert's model, EON and its alias against the published formulas, and against what they have to
// integrate to.

#include "models_angles.h"

#include <fmt/format.h>

#include <gtest/gtest.h>

namespace hshfit::brdfs {
namespace {

using std::cos, std::sin, std::tan, std::pow, std::sqrt;

TEST(Formulas, Minnaert) {
    for (const double k : {0., .5, 1., 2.5}) {
        expectFormula(fmt::format("minnaert:kd=.6,k={}", k), [&](const Angles& a) {
            return .6 * (k + 1) / (2 * pi) * pow(cos(a.thetaI) * cos(a.thetaO), k - 1);
        });
    }
    expectFormula("minnaert:k=1,kd=.3", [](const Angles&) { return .3 / pi; });
}

/// Fujii's Oren-Nayar, f for albedo 1, as the paper has it.
double fujii(double ci, double co, double dot, double r) {
    const double s = dot - ci * co, t = s > 0 ? std::max(ci, co) : 1;
    const double a = 1 / (1 + (.5 - 2 / (3 * pi)) * r);
    return (a + a * r * s / t) / pi;
}

/// Its directional albedo by the midpoint rule, and its mean over the hemisphere.
double fujiiAlbedo(double thetaO, double r) {
    const int heights = 2000, azimuths = 720;
    double sum = 0;
    for (int i = 0; i < heights; ++i)
        for (int j = 0; j < azimuths; ++j) {
            const double c = (i + .5) / heights, phi = pi * (j + .5) / azimuths;
            const double dot = c * cos(thetaO) + sqrt(1 - c * c) * sin(thetaO) * cos(phi);
            sum += fujii(c, cos(thetaO), dot, r) * c * 2 * pi / azimuths / heights;
        }
    return sum;
}

/// The albedo of one bounce as the paper prints it, with its removable pole.
double printedAlbedo(double theta, double r) {
    const double a = 1 / (1 + (.5 - 2 / (3 * pi)) * r), s = sin(theta), c = cos(theta);
    const double g = s * (theta - s * c) + 2. / 3 * (s / c * (1 - s * s * s) - s);
    return a + r * a / pi * g;
}

TEST(Formulas, EonAlbedoOfOneBounceIsThatOfFujii) {
    for (const double r : {.2, 1.})
        for (const double theta : {.01, .5, 1., 1.4, 1.55})
            EXPECT_NEAR(printedAlbedo(theta, r), fujiiAlbedo(theta, r), 2e-5) << theta;
}

TEST(Formulas, Eon) {
    for (const double kd : {.3, 1.})
        for (const double r : {.2, 1.}) {
            double mean = 0;  // of the albedo over the hemisphere, weighted by the cosine
            for (int i = 0; i < 20000; ++i) {
                const double c = (i + .5) / 20000;
                mean += 2 * c * printedAlbedo(std::acos(c), r) / 20000;
            }
            const double a = 1 / (1 + (.5 - 2 / (3 * pi)) * r);
            const double printedMean = a * (1 + (2. / 3 - 28 / (15 * pi)) * r);
            EXPECT_NEAR(printedMean, mean, 1e-6);
            const double multiple = kd * kd * printedMean / (1 - kd * (1 - printedMean));
            expectFormula(fmt::format("eon:kd={},roughness={}", kd, r), [&](const Angles& p) {
                const double ci = cos(p.thetaI), co = cos(p.thetaO);
                const double dot = ci * co + sin(p.thetaI) * sin(p.thetaO) * cos(p.phiI - p.phiO);
                return kd * fujii(ci, co, dot, r) +
                       multiple / pi * (1 - printedAlbedo(p.thetaI, r)) *
                           (1 - printedAlbedo(p.thetaO, r)) / (1 - printedMean);
            });
        }
}

/// The directional albedo of an isotropic diffuse BRDF, by the midpoint rule.
double diffuseAlbedo(const Brdf& brdf, const Direction& wo) {
    const std::size_t heights = 600, azimuths = 360;
    std::vector<double> x, y, z, f(heights * azimuths);
    for (std::size_t i = 0; i < heights; ++i)
        for (std::size_t j = 0; j < azimuths; ++j) {
            const double c = (static_cast<double>(i) + .5) / heights;
            const double phi = 2 * pi * (static_cast<double>(j) + .5) / azimuths;
            const double s = sqrt(1 - c * c);
            x.push_back(s * cos(phi)), y.push_back(s * sin(phi)), z.push_back(c);
        }
    brdf.eval(wo, {x.data(), y.data(), z.data(), z.size()}, f.data());
    double sum = 0;
    for (std::size_t k = 0; k < z.size(); ++k) sum += f[k] * z[k];
    return sum * 2 * pi / static_cast<double>(z.size());
}

// A white furnace: with kd = 1 nothing is lost and nothing won, in every direction.
TEST(Formulas, EonOfWhiteFacetsHasAlbedoOne) {
    for (const double r : {0., .1, .5, 1.})
        for (const double theta : {0., 20., 45., 60., 75., 85., 89.}) {
            const Direction wo = directionFromAngles(radians(theta), .3);
            const auto exact = open(fmt::format("eon:roughness={}", r));
            EXPECT_NEAR(diffuseAlbedo(*exact, wo), 1, 1e-4) << r << " " << theta;
            const auto fast = open(fmt::format("eon:roughness={},albedo=approximate", r));
            EXPECT_NEAR(diffuseAlbedo(*fast, wo), 1, 1.1e-3) << r << " " << theta;
        }
}

// For this reason albedo=approximate does not claim to keep the energy.
TEST(Formulas, EonApproximateAlbedoExceedsTheExactOneSlightly) {
    const Direction wo = directionFromAngles(radians(82), .3);
    const auto exact = open("eon:roughness=1"), fast = open("eon:roughness=1,albedo=approximate");
    EXPECT_TRUE(exact->laws().energyConserving);
    EXPECT_FALSE(fast->laws().energyConserving);
    const double excess = diffuseAlbedo(*fast, wo) - diffuseAlbedo(*exact, wo);
    EXPECT_GT(excess, 1e-4);
    EXPECT_LT(excess, 1.5e-4);
}

TEST(Formulas, OpenPbrDiffuseIsEon) {
    const auto alias =
        open("openpbr-diffuse:base_weight=.5,base_color=.8/.4/.2,base_diffuse_roughness=.3");
    const auto eon = open("eon:kd=.4/.2/.1,roughness=.3");
    for (const Pair& p : ordinaryPairs(41)) {
        const std::vector<double> a = evaluate(*alias, p.wi, p.wo), b = evaluate(*eon, p.wi, p.wo);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-14 * b[c]);
    }
    expectFormula("openpbr-diffuse", [](const Angles&) { return .8 / pi; });
}

}  // namespace
}  // namespace hshfit::brdfs
