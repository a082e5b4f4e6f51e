#include "places.h"

#include <brdfs/catalog.h>
#include <brdfs/fit/gaussian_mixture_fit.h>
#include <brdfs/fit/gaussian_mixture_json.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>
#include <lib/formula_brdf.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>

namespace hshfit::brdfs {
namespace {

GaussianMixture synthetic(GaussianKind kind, const Channels& channels) {
    GaussianMixture::Content content{
        .name = "synthetic", .source = "synthetic", .kind = kind, .channels = channels};
    const std::size_t count = channels.count();
    for (const double theta : {20.0, 50.0}) {
        std::vector<double> strong(count), weak(count);
        for (std::size_t c = 0; c < count; ++c) {
            strong[c] = 3.0 + static_cast<double>(c);
            weak[c] = 0.5 / (1.0 + static_cast<double>(c));
        }
        content.elevations.push_back(
            {.theta = radians(theta),
             .lobes = {{.tilt = radians(2), .sharpness = 120, .across = 300, .amplitude = strong},
                       {.tilt = radians(-6), .sharpness = 9, .across = 4, .amplitude = weak}}});
    }
    return GaussianMixture(content);
}

double relative(double a, double b) {
    return std::abs(a - b) / std::abs(b);
}

class GaussianKinds : public testing::TestWithParam<GaussianKind> {};

TEST_P(GaussianKinds, SyntheticMixturesAreRecovered) {
    const bool asg = GetParam() == GaussianKind::anisotropic;
    for (const Channels& channels : {Channels::grey(), Channels::rgb()}) {
        const GaussianMixture truth = synthetic(GetParam(), channels);
        for (std::size_t k = 0; k < 2; ++k) {
            const GaussianElevation& expected = truth.content().elevations[k];
            const GaussianMixture fit = fitGaussians(
                truth, OutgoingSet::direction(expected.theta, 0), {.kind = GetParam(), .lobes = 2});
            const GaussianElevation& found = fit.content().elevations.at(0);
            EXPECT_TRUE(found.converged);
            EXPECT_LT(found.error, 1e-3);
            EXPECT_LT(relative(found.fittedAlbedo, found.albedo), 1e-3);
            for (std::size_t j = 0; j < 2; ++j) {
                const GaussianLobe &a = found.lobes[j], &b = expected.lobes[j];
                EXPECT_NEAR(a.tilt, b.tilt, radians(0.2)) << j;
                EXPECT_LT(relative(a.sharpness, b.sharpness), 0.02) << j;
                if (asg) {
                    EXPECT_LT(relative(a.across, b.across), 0.02) << j;
                }
                for (std::size_t c = 0; c < channels.count(); ++c)
                    EXPECT_LT(relative(a.amplitude[c], b.amplitude[c]), 0.02) << j;
            }
        }
    }
}

/// The formulas of the papers, from the vectors of the frame.
TEST_P(GaussianKinds, LobesAreAsPublished) {
    const double theta = 0.6, tilt = 0.1, lambda = 7, mu = 3;
    const double angle = theta + tilt;
    const Direction p{std::sin(angle), 0, std::cos(angle)}, x{std::cos(angle), 0, -std::sin(angle)};
    for (int k = 0; k < 40; ++k) {
        const Direction w = directionFromAngles(0.04 * k, 0.3 * k);
        const double expected =
            GetParam() == GaussianKind::spherical
                ? std::exp(lambda * (dot(w, p) - 1))
                : std::max(dot(w, p), 0.0) *
                      std::exp(-lambda * dot(w, x) * dot(w, x) - mu * w.y * w.y);
        EXPECT_NEAR(
            evaluateLobe(GetParam(), {.tilt = tilt, .sharpness = lambda, .across = mu}, theta, w)
                .value,
            expected, 1e-13);
    }
}

TEST_P(GaussianKinds, DerivativesAreThoseOfTheValue) {
    const Direction w = directionFromAngles(0.9, 0.4);
    const double step = 1e-6;
    const auto value = [&](double tilt, double logSharpness, double logAcross) {
        return evaluateLobe(
            GetParam(),
            {.tilt = tilt, .sharpness = std::exp(logSharpness), .across = std::exp(logAcross)}, 0.7,
            w);
    };
    const auto at = value(0.1, 1.2, 0.4);
    const auto slope = [&](const GaussianValue& a, const GaussianValue& b) {
        return (a.value - b.value) / (2 * step);
    };
    EXPECT_NEAR(at.byTilt, slope(value(0.1 + step, 1.2, 0.4), value(0.1 - step, 1.2, 0.4)), 1e-8);
    EXPECT_NEAR(at.byLogSharpness, slope(value(0.1, 1.2 + step, 0.4), value(0.1, 1.2 - step, 0.4)),
                1e-8);
    EXPECT_NEAR(at.byLogAcross, slope(value(0.1, 1.2, 0.4 + step), value(0.1, 1.2, 0.4 - step)),
                1e-8);
}

INSTANTIATE_TEST_SUITE_P(All, GaussianKinds,
                         testing::Values(GaussianKind::spherical, GaussianKind::anisotropic));

/// The models' own Gaussian about the mirror direction has one lobe.
TEST(GaussianMixture, FindsTheCatalogsGaussian) {
    const auto brdf = open("sg:sharpness=40,ks=0.8");
    const GaussianMixture fit = fitGaussians(*brdf, OutgoingSet::elevations(5), {.lobes = 1});
    for (const GaussianElevation& elevation : fit.content().elevations) {
        EXPECT_NEAR(elevation.lobes[0].tilt, 0, 1e-3);
        EXPECT_LT(relative(elevation.lobes[0].sharpness, 40), 1e-2);
        EXPECT_LT(relative(elevation.lobes[0].amplitude[0], 0.8), 1e-2);
    }
}

TEST(GaussianMixture, MoreLobesFitBetter) {
    const auto brdf = open("ggx:alpha=.3");
    for (const GaussianKind kind : {GaussianKind::spherical, GaussianKind::anisotropic}) {
        double before = 1;
        for (const int lobes : {1, 2, 4}) {
            const GaussianMixture fit =
                fitGaussians(*brdf, OutgoingSet::direction(radians(40), 0),
                             {.kind = kind, .lobes = lobes, .loss = Loss::Kind::cosine});
            EXPECT_LT(fit.content().elevations[0].error, 0.7 * before) << lobes;
            before = fit.content().elevations[0].error;
        }
    }
}

/// f of an isotropic BRDF is the same for every azimuth of wi there; a mixture that is not has a
/// pole where a surface is seen along its normal.
TEST(GaussianMixture, IsRoundAtNormalIncidence) {
    const auto brdf = open("ggx:alpha=.6");
    for (const GaussianKind kind : {GaussianKind::spherical, GaussianKind::anisotropic}) {
        const GaussianMixture fit = fitGaussians(*brdf, OutgoingSet::elevations(4), {.kind = kind});
        for (const double theta : {0.2, 0.7, 1.2}) {
            const double along = evaluate(fit, directionFromAngles(theta, 0), {0, 0, 1})[0];
            EXPECT_GT(along, 0);
            for (const double phi : {0.5, 1.5, 3.1})
                EXPECT_NEAR(evaluate(fit, directionFromAngles(theta, phi), {0, 0, 1})[0], along,
                            1e-12);
        }
    }
}

/// By the quadrature of the library, which knows nothing of the fit's.
TEST(GaussianMixture, KeepsTheEnergyThatItReports) {
    const auto brdf = open("ggx:alpha=.3");
    const OutgoingSet outgoing = OutgoingSet::elevations(4);
    for (const bool keep : {false, true}) {
        const GaussianMixture fit = fitGaussians(*brdf, outgoing, {.lobes = 2, .keepEnergy = keep});
        for (std::size_t k = 0; k < outgoing.size(); ++k) {
            const Direction& wo = outgoing.directions[k];
            const GaussianElevation& elevation = fit.content().elevations[k];
            EXPECT_NEAR(directionalAlbedo(*brdf, wo)[0], elevation.albedo, 5e-3);
            EXPECT_NEAR(directionalAlbedo(fit, wo)[0], elevation.fittedAlbedo, 5e-3);
            if (keep) {
                EXPECT_NEAR(elevation.fittedAlbedo, elevation.albedo, 1e-9);
            }
        }
    }
}

TEST(GaussianMixture, TurnsWithOutgoingAndMixesBetweenElevations) {
    const GaussianMixture mixture = synthetic(GaussianKind::anisotropic, Channels::rgb());
    const Direction wi = directionFromAngles(0.7, 2.9);
    const Direction wo = directionFromAngles(radians(35), 0.3);
    const auto straight = evaluate(mixture, wi, wo);
    const auto after = evaluate(mixture, rotateAboutZ(wi, 1.1), rotateAboutZ(wo, 1.1));
    // 35 degrees is half-way between the two elevations.
    const auto& elevations = mixture.content().elevations;
    const Direction seen = rotateAboutZ(wi, pi - 0.3);
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(straight[c], after[c], 1e-12);
        double expected = 0;
        for (const GaussianElevation& elevation : elevations)
            for (const GaussianLobe& lobe : elevation.lobes)
                expected += 0.5 * lobe.amplitude[c] *
                            evaluateLobe(GaussianKind::anisotropic, lobe, radians(35), seen).value;
        EXPECT_NEAR(straight[c], expected, 1e-12);
    }
    EXPECT_EQ(evaluate(mixture, {0.6, 0, -0.8}, wo)[0], 0);
}

TEST(GaussianMixture, IsTheSameWithAnyNumberOfThreads) {
    const auto brdf = open("beckmann:alpha=.3");
    const auto fit = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return gaussianMixtureJson(fitGaussians(*brdf, OutgoingSet::elevations(3), {.lobes = 2}));
    };
    EXPECT_EQ(fit(1), fit(4));
}

TEST(GaussianMixture, RefusesWhatItCannotFit) {
    const OutgoingSet one = OutgoingSet::direction(0.5, 0);
    EXPECT_THROW(fitGaussians(*open("ward:ax=.1,ay=.3"), one), UsageError);
    EXPECT_THROW(fitGaussians(*open("lambert"), OutgoingSet::parabolic(4, 4)), UsageError);
    EXPECT_THROW(fitGaussians(*open("lambert"), one, {.lobes = 0}), UsageError);
    EXPECT_THROW(fitGaussians(*open("lambert:kd=0"), one), NumericError);
    // As measured files: isotropic, and the mirror images are measured separately.
    const test::FormulaBrdf lopsided(
        [](const Direction& wi, const Direction& wo) { return 1 + wi.x * wo.y; });
    try {
        fitGaussians(lopsided, one);
        FAIL();
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("mirror symmetric"), std::string::npos);
    }
}

TEST(GaussianMixtureFile, IsReadBack) {
    for (const GaussianKind kind : {GaussianKind::spherical, GaussianKind::anisotropic})
        for (const Channels& channels :
             {Channels::grey(), Channels::rgb(), Channels::spectral({450, 550.5, 650})}) {
            const GaussianMixture mixture = synthetic(kind, channels);
            const test::TemporaryFile file(gaussianMixtureJson(mixture), ".json");
            const auto again = open(file.path());
            EXPECT_EQ(again->name(), file.path());
            EXPECT_EQ(again->channels().names(), mixture.channels().names());
            for (int k = 0; k < 20; ++k) {
                const Direction wi = directionFromAngles(0.07 * k, 3 + 0.1 * k);
                const Direction wo = directionFromAngles(0.05 * k, 0);
                const auto a = evaluate(mixture, wi, wo), b = evaluate(*again, wi, wo);
                for (std::size_t c = 0; c < a.size(); ++c)
                    EXPECT_NEAR(a[c], b[c], 1e-12 * (1 + a[c]));
            }
        }
}

TEST(GaussianMixtureFile, FollowsItsSchema) {
    if (std::system("/usr/bin/python3 -c 'import jsonschema' 2>/dev/null") != 0)
        GTEST_SKIP() << "python3-jsonschema is not installed";
    const test::TemporaryFile file(
        gaussianMixtureJson(synthetic(GaussianKind::anisotropic, Channels::rgb())), ".json");
    const std::string source = test::sourceFolder();
    EXPECT_EQ(std::system(("/usr/bin/python3 " + source + "/tests/validate_schema.py " + source +
                           "/docs/schemas/gaussians.schema.json " + file.path())
                              .c_str()),
              0);
}

using Json = nlohmann::json;

TEST(GaussianMixtureFile, DamageIsNamed) {
    const Json good =
        Json::parse(gaussianMixtureJson(synthetic(GaussianKind::anisotropic, Channels::rgb())));
    ASSERT_NO_THROW(openGaussianMixture(good.dump(), "f"));
    const std::pair<const char*, std::function<void(Json&)>> damages[] = {
        {"version", [](Json& j) { j["version"] = 2; }},
        {"kind", [](Json& j) { j["kind"] = "gs"; }},
        {"channels", [](Json& j) { j["channels"] = "rgba"; }},
        {"channels",
         [](Json& j) {
             j["channels"] = {500, 400};
         }},
        {"brdf", [](Json& j) { j.erase("brdf"); }},
        {"elevations", [](Json& j) { j["elevations"] = Json::array(); }},
        {"elevations", [](Json& j) { j["elevations"][0] = 3; }},
        {"theta", [](Json& j) { j["elevations"][0]["theta"] = 91; }},
        {"theta", [](Json& j) { j["elevations"][1]["theta"] = 20; }},
        {"lobes", [](Json& j) { j["elevations"][0]["lobes"].erase(0); }},
        {"lobes", [](Json& j) { j["elevations"][1]["lobes"] = Json::array(); }},
        {"tilt", [](Json& j) { j["elevations"][1]["lobes"][0]["tilt"] = "1"; }},
        {"sharpness", [](Json& j) { j["elevations"][1]["lobes"][0]["sharpness"] = -1; }},
        {"across", [](Json& j) { j["elevations"][1]["lobes"][1].erase("across"); }},
        {"amplitude",
         [](Json& j) {
             j["elevations"][0]["lobes"][0]["amplitude"] = {1, 2};
         }},
        {"amplitude", [](Json& j) { j["elevations"][0]["lobes"][0]["amplitude"][2] = -1; }},
        {"amplitude", [](Json& j) { j["elevations"][0]["lobes"][0]["amplitude"][2] = nullptr; }},
        {"error", [](Json& j) { j["elevations"][0]["error"] = nullptr; }},
    };
    for (const auto& [field, damage] : damages) {
        Json bad = good;
        damage(bad);
        try {
            openGaussianMixture(bad.dump(), "f");
            ADD_FAILURE() << field << " was taken";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(field), std::string::npos) << error.what();
            EXPECT_EQ(std::string(error.what()).find("f:"), 0u) << error.what();
        }
    }
    const std::string text = good.dump();
    for (std::size_t length = 0; length < text.size(); length += 7)
        EXPECT_THROW(openGaussianMixture(text.substr(0, length), "f"), InputError) << length;
}

}  // namespace
}  // namespace hshfit::brdfs
