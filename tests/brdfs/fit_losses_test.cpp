#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/picture_samples.h>
#include <hshfit/accuracy/metrics.h>
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>

#include "places.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>

namespace hshfit::brdfs {
namespace {

std::string shared(const std::string& name) {
    return test::sharedFolder() + "/data/" + name;
}

std::string nameOfFile(const char* path) {
    std::string name = std::filesystem::path(path).stem().string();
    std::ranges::replace_if(
        name, [](char c) { return !std::isalnum(c); }, '_');
    return name;
}

class OwnMetric : public testing::TestWithParam<const char*> {};

/// A fit by a loss has the least value of the metric that the loss stands for, among fits by all
/// losses, as BRDFs are compared: within a thousandth.
TEST_P(OwnMetric, IsLeastForItsLoss) {
    const std::string path = shared(GetParam());
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    const auto data = open(path);
    const FitSamples samples = gatherSamples(*data, {});
    std::vector<std::string_view> names;
    for (const Loss& loss : losses())
        if (!loss.metric.empty()) names.push_back(loss.metric);
    ASSERT_EQ(names.size(), 5U);
    const auto metrics = selectMetrics(fmt::format("{}", fmt::join(names, ",")));
    std::map<std::string_view, double> own, least;
    for (const Loss& loss : losses()) {
        if (loss.metric.empty()) continue;
        const auto fitted =
            openFit(fit(samples, {.model = "lambert+ggx", .loss = loss.kind, .starts = 8}));
        for (const MetricValue& value : compare(
                 *data, *fitted, comparedOutgoing(data->laws().isotropic), metrics, {.level = 2})) {
            if (!value.value) continue;
            const std::string_view name = value.metric->name;
            least[name] = least.contains(name) ? std::min(least[name], *value.value) : *value.value;
            if (name == loss.metric) own[name] = *value.value;
        }
    }
    EXPECT_GE(own.size(), 4U);  // relative-l2 may not exist
    for (const auto& [name, value] : own) EXPECT_LE(value, 1.001 * least[name]) << name;
}

INSTANTIATE_TEST_SUITE_P(
    Files, OwnMetric,
    testing::Values("rgl/cc_ibiza_sunset_rgb.bsdf", "rgl/cg_sunflower_rgb.bsdf",
                    "rgl/paper_white_rgb.bsdf", "rgl/satin_rosaline_rgb.bsdf",
                    "merl_slices/alum-bronze.slice", "merl_slices/blue-metallic-paint.slice",
                    "merl_slices/chrome-steel.slice", "merl_slices/delrin.slice",
                    "merl_slices/gold-paint.slice", "merl_slices/pickled-oak-260.slice",
                    "merl_slices/pink-fabric.slice", "merl_slices/red-plastic.slice",
                    "merl_slices/white-paint.slice", "merl_slices/yellow-matte-plastic.slice"),
    [](const auto& file) { return nameOfFile(file.param); });

/// Sums of weights over a hemisphere are 2 pi where f is 1, for each outgoing direction's share.
TEST(FitNodes, IntegrateWhatComparisonsIntegrate) {
    const auto brdf = open("ggx:alpha=.3");
    const FitSamples samples = gatherSamples(*brdf, {});
    EXPECT_EQ(samples.origin, SampleOrigin::nodes);
    // The mean of f cos over both, which compare has as the root mean square from black.
    double squares = 0, weights = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double fc = samples.value(0, k) * samples.wiZ[k];
        squares += samples.weights[k] * fc * fc;
        weights += samples.weights[k];
    }
    const auto black = open("lambert:kd=0");
    const auto ngan = compare(*brdf, *black, comparedOutgoing(true), selectMetrics("ngan")).front();
    EXPECT_NEAR(std::sqrt(squares / weights), *ngan.value, 1e-3 * *ngan.value);
}

TEST(PictureSamples, AreThoseOfEveryLight) {
    EXPECT_EQ(pictureLights().size(), 5U);
    for (const PictureLightRow& row : pictureLights())
        EXPECT_FALSE(parseLights(std::string(row.spec)).lights.empty()) << row.name;
}

/// A white Lambertian sphere under uniform light alone would have one radiance; under the rows'
/// lights its radiance is irradiance / pi, which light samples give in another way.
TEST(PictureSamples, OfLambertAreIrradiance) {
    const auto brdf = open("lambert:kd=1");
    const FitSamples samples = pictureSamples(*brdf, {.rings = 4, .around = 6, .points = 16});
    ASSERT_TRUE(samples.sums);
    const NodeSums& sums = *samples.sums;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const NodeSums::Row& row = sums.rows[samples.sumRows[k]];
        double sum = 0;
        for (std::size_t j = 0; j < row.nodes; ++j) sum += sums.factors[row.firstFactor + j];
        EXPECT_NEAR(samples.value(0, k), sum / pi, 1e-12);
    }
    double weights = 0;
    for (const double weight : samples.weights) weights += weight;
    EXPECT_NEAR(weights, static_cast<double>(samples.size()), 1e-9 * weights);
}

/// Lambert's f with a part of the sign of the turn from wo to wi, which images in the plane of
/// incidence do not share. `isotropic`: what it claims.
class OneSided : public Brdf {
public:
    OneSided(double share, bool isotropic) : share_(share) { laws_.isotropic = isotropic; }
    std::string name() const override { return "one-sided"; }
    const Channels& channels() const override { return channels_; }
    const Laws& laws() const override { return laws_; }
    void eval(const Direction& wo, DirectionBatch wi, double* out) const override {
        for (std::size_t k = 0; k < wi.count; ++k)
            out[k] = (1 + share_ * (wo.x * wi.y[k] - wo.y * wi.x[k])) / pi;
    }

private:
    double share_;
    Channels channels_;
    Laws laws_;
};

/// Pixels of an f that claims to be isotropic take half of the directions. Without the claim,
/// pixels of the same f take all of them.
TEST(PictureSamples, OfIsotropicDataAreThoseOfAllDirections) {
    // Many nodes for the edges of the panel.
    const PictureSampleOptions options{
        .rings = 4, .around = 6, .points = 16, .order = 96, .fewer = false};
    const FitSamples half = pictureSamples(OneSided(0, true), options),
                     whole = pictureSamples(OneSided(0, false), options);
    ASSERT_EQ(half.size(), whole.size());
    EXPECT_LT(half.sums->size(), whole.sums->size());
    double squares = 0;
    for (std::size_t k = 0; k < half.size(); ++k)
        squares += std::pow(half.value(0, k) - whole.value(0, k), 2);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(half.size())), 3e-3);
}

/// A node that stands for its image has the mean of f at both.
TEST(PictureSamples, AverageImagesInThePlaneOfIncidence) {
    const OneSided data(0.5, true);
    const FitSamples samples = pictureSamples(data, {.rings = 3, .around = 4, .points = 16});
    const NodeSums& sums = *samples.sums;
    const std::vector<double> f = valuesAt(data, sums);
    std::size_t mirrored = 0;
    for (std::size_t k = 0; k < sums.size(); ++k) {
        const double odd = sums.wo[k].x * sums.wiY[k] - sums.wo[k].y * sums.wiX[k];
        EXPECT_NEAR(f[k], (1 + (sums.mirrored[k] ? 0 : 0.5 * odd)) / pi, 1e-15);
        mirrored += sums.mirrored[k] ? 1 : 0;
    }
    EXPECT_GT(mirrored, sums.size() / 2);
}

/// 95 % of the pixels of a light are at or below 0.8 of white.
TEST(PictureSamples, AreExposedForTheData) {
    const FitSamples dark = pictureSamples(*open("lambert:kd=.01"));
    const FitSamples bright = pictureSamples(*open("lambert:kd=1"));
    ASSERT_EQ(dark.size(), bright.size());
    for (std::size_t k = 0; k < dark.size(); ++k)
        EXPECT_NEAR(dark.value(0, k), bright.value(0, k), 1e-9);
}

/// Without noise, the parameters that made the data are the minimum; of an anisotropic lobe too.
TEST(PictureLoss, FindsTheParametersOfItsData) {
    struct Case {
        std::string truth, model;
        std::map<std::string, double> values;
    };
    for (const Case& own : {Case{"lambert:kd=.2+ggx:alpha=.15,F0=.2",
                                 "lambert+ggx:ks=1",
                                 {{"lambert.kd", 0.2}, {"ggx.alpha", 0.15}, {"ggx.F0", 0.2}}},
                            Case{"ward:kd=.3,ks=.2,ax=.1,ay=.3",
                                 "ward",
                                 {{"kd", 0.3}, {"ks", 0.2}, {"ax", 0.1}, {"ay", 0.3}}}}) {
        const auto data = open(own.truth);
        const FitSamples samples = pictureSamples(*data, {.rings = 6, .around = 6, .points = 128});
        const FitResult result =
            fit(samples, {.model = own.model, .loss = Loss::Kind::picture, .starts = 4});
        EXPECT_LT(result.loss, 1e-6) << own.truth;
        for (const FittedParameter& parameter : result.parameters)
            EXPECT_NEAR(parameter.value, own.values.at(parameter.name), 1e-4)
                << own.truth << " " << parameter.name;
    }
}

/// A coat narrower than every pixel costs nothing but in the pixel that mirrors the light.
TEST(PictureLoss, SeesMirrorsThatTheDataDoNotHave) {
    const auto data = open("lambert:kd=.2+ggx:alpha=.3,F0=.04");
    const FitSamples samples = pictureSamples(*data);
    const auto lossOfCoat = [&](double alpha) {
        const auto coated = open("lambert:kd=.2+ggx:alpha=.3,F0=.04+ggx:ks=.5,F0=.04,alpha=" +
                                 std::to_string(alpha));
        return lossOf(*coated, samples, Loss::Kind::picture);
    };
    EXPECT_GT(lossOfCoat(1e-4), 0.02);
    EXPECT_GT(lossOfCoat(1e-4), lossOfCoat(1e-2));
}

/// Derivatives of sums over nodes are sums of the derivatives of their terms.
TEST(PictureLoss, DerivativesMatchFiniteDifferences) {
    const auto data = open("lambert:kd=.2+ggx:alpha=.15,F0=.2");
    const FitSamples samples = pictureSamples(*data, {.rings = 3, .around = 4, .points = 40});
    const ParametricSum sum("lambert+ggx", true);
    const FitProblem problem(samples, sum, Loss::Kind::picture);
    std::vector<double> x;
    for (const ShapeParameter& shape : sum.shapes())
        x.push_back(shape.toScale(shape.name == "ggx.alpha" ? 0.3 : 0.1));
    for (std::size_t k = 0; k < sum.linears().size(); ++k) x.push_back(0.4);
    const Equations at = problem.joint(x, true);
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double step = 1e-5;
        std::vector<double> above = x, below = x;
        above[i] += step, below[i] -= step;
        const double slope =
            (problem.joint(above, false).cost - problem.joint(below, false).cost) / (2 * step);
        EXPECT_NEAR(at.gradient[i], slope, 1e-6 * (1 + std::abs(slope))) << i;
    }
}

/// Lightness of the CIE at the published points: 0 at 0, 100 at white, 50 at 0.18419.
TEST(PictureLoss, SeesLightness) {
    EXPECT_NEAR(mapValue(Loss::Kind::picture, 0, 1).value, 0, 1e-12);
    EXPECT_NEAR(mapValue(Loss::Kind::picture, 1, 1).value, 1, 1e-12);
    EXPECT_NEAR(mapValue(Loss::Kind::picture, 0.18418652, 1).value, 0.5, 1e-6);
    EXPECT_NEAR(mapValue(Loss::Kind::picture, 0.008856, 1).value, 0.08, 1e-4);
    EXPECT_LT(mapValue(Loss::Kind::picture, 4, 1).value, 1.3);
    for (const double x : {0.001, 0.0088, 0.0089, 0.3, 0.999, 1.001, 3.0}) {
        const double step = 1e-7;
        const double slope = (mapValue(Loss::Kind::picture, x + step, 1).value -
                              mapValue(Loss::Kind::picture, x - step, 1).value) /
                             (2 * step);
        EXPECT_NEAR(mapValue(Loss::Kind::picture, x, 1).slope, slope, 1e-5 * slope) << x;
    }
}

/// Folds and single channels keep the sums of their samples.
TEST(PictureSamples, PartsKeepTheirSums) {
    const auto data = open("lambert:kd=.1/.2/.3");
    const FitSamples all = pictureSamples(*data, {.rings = 3, .around = 4, .points = 40});
    const FitSamples part = all.subset({0, 7, 12, all.size() - 1}), blue = part.channel(2);
    const std::vector<double> f = valuesOf(*open("lambert:kd=.3"), blue);
    for (std::size_t k = 0; k < blue.size(); ++k) EXPECT_NEAR(blue.value(0, k), f[k], 1e-12);
}

}  // namespace
}  // namespace hshfit::brdfs
