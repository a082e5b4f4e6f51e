#include <brdfs/catalog.h>
#include <brdfs/fit/askew_ltc.h>
#include <brdfs/fit/ltc_table.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/quadrature/quadrature.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

namespace hshfit::brdfs {
namespace {

/// The integral over the sphere of what `value` gives at a direction.
template <class Value>
double overSphere(const Value& value) {
    const GaussRule& rule = gaussLegendre(400);
    constexpr int azimuths = 400;
    double sum = 0;
    for (std::size_t k = 0; k < rule.nodes.size(); ++k)
        for (int j = 0; j < azimuths; ++j) {
            const Direction w =
                directionFromAngles(std::acos(rule.nodes[k]), (j + 0.5) * 2 * pi / azimuths);
            sum += rule.weights[k] * 2 * pi / azimuths * value(w);
        }
    return sum;
}

Ltc randomLtc(std::mt19937& random) {
    std::uniform_real_distribution<double> size(0.2, 1.5), skew(-0.4, 0.4), turn(-1.3, 0);
    const Ltc upright{
        .a = size(random), .c = skew(random) * 0.5, .b = skew(random) * 0.5, .d = size(random)};
    return turned(upright, turn(random));
}

/// f such that f cos(theta_i) is a transformed cosine above the horizon.
class CosineBrdf : public Brdf {
public:
    CosineBrdf(const Ltc& ltc, double magnitude) : ltc_(ltc), magnitude_(magnitude) {}
    std::string name() const override { return "cosine"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction&, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k) {
            const Direction w{wi.x[k], wi.y[k], wi.z[k]};
            out[k] = w.z > 0 ? magnitude_ * ltc_.density(w) / w.z : 0;
        }
    }

private:
    Ltc ltc_;
    double magnitude_;
    Channels channels_;
    Laws laws_{.isotropic = true, .mirrorSymmetric = true};
};

TEST(Ltc, DensityIntegratesToOne) {
    std::mt19937 random(1);
    for (int k = 0; k < 5; ++k) {
        const Ltc ltc = randomLtc(random);
        EXPECT_NEAR(overSphere([&](const Direction& w) { return ltc.density(w); }), 1, 2e-4);
    }
}

TEST(Ltc, SamplesFollowTheDensity) {
    std::mt19937 random(2);
    for (int k = 0; k < 100; ++k) {
        const Ltc ltc = randomLtc(random);
        std::uniform_real_distribution<double> angle(0, pi);
        const Direction cosine = directionFromAngles(angle(random) / 2, 2 * angle(random));
        const LtcDirection to = fromCosine(ltc, cosine);
        EXPECT_NEAR(dot(to.w, to.w), 1, 1e-12);
        EXPECT_NEAR(ltc.density(to.w) * to.stretch, cosine.z / pi, 1e-12);
        // W takes it back.
        const double x = ltc.a * to.w.x + ltc.b * to.w.z, z = ltc.c * to.w.x + ltc.d * to.w.z;
        EXPECT_NEAR(x * cosine.z, z * cosine.x, 1e-12);
        EXPECT_NEAR(to.w.y * cosine.z, z * cosine.y, 1e-12);
    }
}

TEST(Ltc, TurnedMatrixHasTheTurnedLobe) {
    std::mt19937 random(3);
    const Ltc ltc = randomLtc(random);
    for (const double angle : {-1.0, -0.2, 0.7}) {
        const Ltc after = turned(ltc, angle);
        for (int k = 0; k < 20; ++k) {
            const Direction w = directionFromAngles(0.07 * k, 0.4 * k);
            const Direction to{w.x * std::cos(angle) + w.z * std::sin(angle), w.y,
                               w.z * std::cos(angle) - w.x * std::sin(angle)};
            EXPECT_NEAR(after.density(to), ltc.density(w), 1e-12 * (1 + ltc.density(w)));
        }
    }
}

/// A sphere's part above the horizon, summed over equal areas of its cap.
TEST(Ltc, SpheresAreCutAtTheHorizon) {
    constexpr int rings = 400, azimuths = 400;
    for (const double form : {0.05, 0.4, 0.9, 1.0})
        for (const double height : {-0.9, -0.4, -0.1, 0.0, 0.3, 0.8, 1.0}) {
            const double edge = std::sqrt(1 - form), tilt = std::acos(height);
            double sum = 0;
            for (int k = 0; k < rings; ++k)
                for (int j = 0; j < azimuths; ++j) {
                    const double along = edge + (1 - edge) * (k + 0.5) / rings;
                    const double across =
                        std::sqrt(1 - along * along) * std::cos((j + 0.5) * 2 * pi / azimuths);
                    sum += std::max(0.0, std::cos(tilt) * along + std::sin(tilt) * across);
                }
            const double mean = sum / (rings * azimuths);
            EXPECT_NEAR(sphereAboveHorizon(height, form), 2 * (1 - edge) * mean / form, 2e-5)
                << form << " " << height;
        }
    EXPECT_DOUBLE_EQ(sphereAboveHorizon(0.25, 0), 0.25);
    EXPECT_DOUBLE_EQ(sphereAboveHorizon(-0.25, 0), 0);
    EXPECT_NEAR(sphereAboveHorizon(1, 1), 1, 1e-12);
}

TEST(Ltc, LambertIsTheCosineItself) {
    const auto brdf = open("lambert:kd=0.7");
    for (const double theta : {0.0, 40.0, 75.0, 89.0}) {
        const Direction wo = directionFromAngles(radians(theta), 0);
        const Ltc start{.a = 0.8, .c = 0.2, .b = -0.1, .d = 1.4};
        const LtcLobe lobe = fitLtc(*brdf, wo, start);
        EXPECT_TRUE(lobe.converged);
        EXPECT_NEAR(lobe.ltc.a, 1, 2e-3);
        EXPECT_NEAR(lobe.ltc.b, 0, 2e-3);
        EXPECT_NEAR(lobe.ltc.c, 0, 2e-3);
        EXPECT_NEAR(lobe.ltc.d, 1, 2e-3);
        EXPECT_NEAR(lobe.magnitude, 0.7, 1e-6);
        EXPECT_LT(lobe.error, 2e-3);
        EXPECT_LT(lobe.misplaced, 2e-3);
    }
}

/// A transformed cosine is recovered if no part of it lies below the horizon.
TEST(Ltc, TransformedCosinesAreRecovered) {
    const Direction wo = directionFromAngles(0.5, 0);
    for (const double width : {1e-3, 0.01, 0.05}) {
        const Ltc upright{.a = 0.7, .c = 0.1 * width, .b = 0.2, .d = width};
        const Ltc truth = turned(upright, -0.4);
        const CosineBrdf brdf(truth, 0.6);
        const Ltc start = turned({.a = 1, .c = 0, .b = 0, .d = 1.5 * width}, -0.4);
        const LtcLobe lobe = fitLtc(brdf, wo, start);
        EXPECT_TRUE(lobe.converged);
        EXPECT_LT(lobe.error, 2e-3) << width;
        const Direction peak = fromCosine(truth, {0, 0, 1}).w;
        EXPECT_NEAR(lobe.ltc.density(peak) / truth.density(peak), 1, 5e-3) << width;
        EXPECT_NEAR(lobe.ltc.a, truth.a, 0.01);
        EXPECT_NEAR(lobe.ltc.b, truth.b, 0.01);
    }
}

/// Magnitude and Fresnel part against the quadrature of the library: albedos for F0 = 1 and 0.
TEST(Ltc, EnergiesAreAlbedos) {
    for (const double alpha : {0.02, 0.2, 1.0})
        for (const double theta : {0.0, 50.0, 80.0}) {
            const auto model = [&](const char* f0) {
                return open("ggx:alpha=" + std::to_string(alpha) + ",F0=" + f0);
            };
            const Direction wo = directionFromAngles(radians(theta), 0);
            const auto brdf = model("1");
            const LtcLobe lobe = fitLtc(*brdf, wo, firstLtc(*brdf, wo));
            EXPECT_NEAR(lobe.magnitude, directionalAlbedo(*brdf, wo, 1e-5)[0], 5e-4);
            EXPECT_NEAR(lobe.fresnel, directionalAlbedo(*model("0"), wo, 1e-5)[0], 5e-4);
        }
}

TEST(LtcTable, IsTheSameWithAnyNumberOfThreads) {
    const auto fit = [](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return fitLtcTable("beckmann", {.size = 4});
    };
    const LtcTable one = fit(1), many = fit(4);
    for (std::size_t k = 0; k < one.cells.size(); ++k) {
        EXPECT_EQ(one.cells[k].ltc.a, many.cells[k].ltc.a);
        EXPECT_EQ(one.cells[k].ltc.b, many.cells[k].ltc.b);
        EXPECT_EQ(one.cells[k].ltc.c, many.cells[k].ltc.c);
        EXPECT_EQ(one.cells[k].ltc.d, many.cells[k].ltc.d);
        EXPECT_EQ(one.cells[k].magnitude, many.cells[k].magnitude);
    }
}

/// A finer table of nested roughness and elevation reaches the same lobes by other paths.
TEST(LtcTable, DoesNotDependOnThePath) {
    const LtcTable coarse = fitLtcTable("ggx", {.size = 4}),
                   fine = fitLtcTable("ggx", {.size = 10});
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            const LtcLobe &a = coarse.cell(row, column), &b = fine.cell(3 * row, 3 * column);
            EXPECT_NEAR(a.error, b.error, 0.01 * b.error + 1e-5) << row << " " << column;
            EXPECT_NEAR(a.magnitude, b.magnitude, 1e-3) << row << " " << column;
        }
}

TEST(LtcTable, RefusesWhatItCannotHold) {
    EXPECT_THROW(fitLtcTable("ggx:alpha=0.2", {.size = 2}), UsageError);
    EXPECT_THROW(fitLtcTable("phong", {.size = 2}), UsageError);
    EXPECT_THROW(fitLtcTable("no-model", {.size = 2}), UsageError);
    EXPECT_THROW(fitLtcTable("ggx:F0=.1/.2/.3", {.size = 2}), UsageError);
    EXPECT_THROW(fitLtcTable("ward:ay=.1", {.size = 2, .parameter = "ax"}), UsageError);
    EXPECT_THROW(fitLtcTable("ggx", {.size = 1}), UsageError);
    EXPECT_THROW(fitLtcTable("lambert:kd=0 + ggx", {.size = 2}), UsageError);
    EXPECT_THROW(fitLtcTable("lambert", {.size = 2, .parameter = "kd"}), NumericError);
}

/// Points of the hemisphere, even in the cosine and the azimuth.
LobeSamples hemisphereSamples(const AskewLtc& w, double magnitude) {
    constexpr int rings = 120, points = 240;
    LobeSamples samples;
    for (int i = 0; i < rings; ++i) {
        for (int j = 0; j < points; ++j) {
            samples.wi.push_back(
                directionFromAngles(std::acos((i + 0.5) / rings), 2 * pi * (j + 0.5) / points));
            samples.weights.push_back(2 * pi / rings / points);
            samples.values.push_back(magnitude * density(w, samples.wi.back()));
        }
    }
    return samples;
}

TEST(AskewLtc, StandardFormKeepsTheLobeAndIsThatOfThePlane) {
    const AskewLtc w{{{1.2, 0.5, -0.3}, {-0.4, 0.9, 0.2}, {0.3, -0.2, 0.6}}};
    const AskewLtc form = inStandardForm(w);
    EXPECT_EQ(form[0][1], 0);
    EXPECT_NEAR(form[1][1], 1, 1e-15);
    const Ltc plane{.a = 1.3, .c = -0.4, .b = 0.2, .d = 0.7};
    const AskewLtc same{{{plane.a, 0, plane.b}, {0, 1, 0}, {plane.c, 0, plane.d}}};
    for (const double phi : {0.0, 0.9, 2.3, 4.4}) {
        for (const double theta : {0.1, 0.7, 1.5}) {
            const Direction d = directionFromAngles(theta, phi);
            EXPECT_NEAR(density(form, d), density(w, d), 1e-12);
            EXPECT_NEAR(density(same, d), plane.density(d), 1e-12);
            EXPECT_NEAR(density(turnedAboutY(same, 0.4), d), turned(plane, 0.4).density(d), 1e-12);
        }
    }
}

TEST(AskewLtc, FitsRecoverALobeOutsideThePlaneOfIncidence) {
    // Narrow enough to lie above the horizon, wider along a slanted direction than across it.
    const AskewLtc truth =
        inStandardForm({{{0.9, 0.5, -0.35}, {-0.9, 1.6, 0.15}, {0.12, 0.03, 0.35}}});
    const LobeSamples samples = hemisphereSamples(truth, 0.7);
    const AskewLtc start{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}};
    const AskewFit fit = fitAskewLtc(samples, start);
    EXPECT_LT(fit.error, 2e-3);
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            EXPECT_NEAR(fit.w[row][column], truth[row][column], 5e-3) << row << column;
}

}  // namespace
}  // namespace hshfit::brdfs
