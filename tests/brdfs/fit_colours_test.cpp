// Fits of coloured data by models in which f is not linear in their albedo: it has a value in each
// channel, beside shapes that all channels share.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit_laws.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

/// A material, and the model that is fitted to it.
struct Coloured {
    std::string truth, model;
};

std::ostream& operator<<(std::ostream& out, const Coloured& c) {
    return out << c.truth << " by " << c.model;
}

const Coloured materials[] = {
    {"eon:kd=.5/.3/.1,roughness=.6", "eon"},
    {"eon:kd=.9/.3/.02,roughness=.3,albedo=approximate", "eon:albedo=approximate"},
    {"openpbr-diffuse:base_weight=1,base_color=.5/.3/.1,base_diffuse_roughness=.6",
     "openpbr-diffuse"},
    {"oren-nayar:kd=.5/.3/.1,sigma=30,variant=full", "oren-nayar:variant=full"},
    {"rpv:rho0=.4/.2/.05,k=.8,Theta=-.2", "rpv"},
    {"openpbr:base_color=.5/.3/.1,specular_roughness=.35,base_diffuse_roughness=.5",
     "openpbr:base_diffuse_roughness=.5,base_metalness=0,specular_weight=1,specular_ior=1.5,"
     "coat_weight=0,coat_roughness=0,coat_ior=1.6,fuzz_weight=0,fuzz_color=1,fuzz_roughness=.5"},
    {"openpbr:base_color=.5/.3/.1,specular_roughness=.35,coat_weight=.6,coat_roughness=.1",
     "openpbr:coat_darkening=1,base_metalness=0,specular_weight=1,specular_ior=1.5,coat_ior=1.6,"
     "fuzz_weight=0,fuzz_color=1,fuzz_roughness=.5"},
    {"ashikhmin-shirley:nu=50,nv=50,Rs=.3,Rd=.2/.4/.6", "ashikhmin-shirley"},
    {"ashikhmin-shirley:nu=50,nv=200,Rs=.3/.2/.1,Rd=.2/.4/.6", "ashikhmin-shirley:ks=1,kd=0"},
    {"eon:kd=.5/.3/.1,roughness=.6 + ggx:alpha=.1,F0=.04", "eon+ggx:F0=.04"},
};

FitSamples samplesOf(const std::string& spec, double noise = 0) {
    FitSamples samples = gatherSamples(*open(spec), {}).drawn(600, 1);
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (double& value : samples.values) value *= 1 + noise * normal(random);
    return samples;
}

class ColouredFit : public testing::TestWithParam<Coloured> {};

// Without noise f comes back in every channel, by the linear loss and by another one, and with it
// each number of a material that the data determine.
TEST_P(ColouredFit, RecoversEveryChannel) {
    const FitSamples samples = samplesOf(GetParam().truth);
    for (const Loss::Kind loss : {Loss::Kind::cosine, Loss::Kind::log}) {
        const FitResult result =
            fit(samples, {.model = GetParam().model, .loss = loss, .starts = 8});
        ASSERT_TRUE(result.converged) << result.message;
        EXPECT_LT(result.loss, 1e-5) << result.spec;
        const std::vector<double> f = valuesOf(*openFit(result), samples);
        for (std::size_t v = 0; v < f.size(); ++v)
            ASSERT_NEAR(f[v], samples.values[v], 2e-3 * (0.01 + samples.values[v]))
                << result.spec << " value " << v;
    }
}

TEST_P(ColouredFit, ValuesAndGradientsAreThoseOfTheCatalogModel) {
    const FitSamples samples = samplesOf(GetParam().truth);
    const ParametricSum sum(GetParam().model, samples.isotropic, 0, true);
    const FitProblem problem(samples, sum, Loss::Kind::log);
    std::vector<double> x;
    for (const ShapeParameter& shape : sum.shapes())
        x.push_back(std::lerp(shape.toScale(shape.free.startLow),
                              shape.toScale(shape.free.startHigh),
                              0.3 + 0.05 * static_cast<double>(x.size())));
    for (std::size_t k = 0; k < 3 * sum.linears().size(); ++k)
        x.push_back(0.2 + 0.1 * static_cast<double>(k % 3));
    expectValuesAndGradients(samples, sum, problem, x);
}

INSTANTIATE_TEST_SUITE_P(Materials, ColouredFit, testing::ValuesIn(materials));

const FittedParameter& parameterOf(const FitResult& result, std::string_view label) {
    return *std::ranges::find(result.parameters, label, &FittedParameter::label);
}

TEST(ColouredFits, StateTheAlbedoOfEachChannelWithItsError) {
    const FitResult result = fit(samplesOf(materials[0].truth, 0.05), {.model = "eon"});
    ASSERT_EQ(result.parameters.size(), 4u);
    for (const auto& [label, truth] :
         {std::pair{"roughness", .6}, {"kd R", .5}, {"kd G", .3}, {"kd B", .1}}) {
        const FittedParameter& found = parameterOf(result, label);
        ASSERT_TRUE(found.standardError) << label;
        EXPECT_NEAR(found.value, truth, 5 * *found.standardError) << label;
        EXPECT_LT(*found.standardError, 0.1 * truth) << label;
        EXPECT_FALSE(found.linear) << label;
    }
}

// A channel alone has the fit that its data have as grey ones.
TEST(ColouredFits, OfChannelsApartAreThoseOfGreyData) {
    const FitSamples samples = samplesOf(materials[0].truth, 0.05);
    const FitResult apart = fit(samples, {.model = "eon", .perChannel = true});
    for (std::size_t c = 0; c < 3; ++c) {
        FitSamples grey = samples.channel(c);
        const FitResult own = fit(grey, {.model = "eon"});
        for (const FittedParameter& parameter : own.parameters)
            EXPECT_NEAR(parameter.value,
                        parameterOf(apart, fmt::format("{} {}", parameter.name, "RGB"[c])).value,
                        1e-4)
                << parameter.name << " " << c;
    }
    EXPECT_EQ(openFit(apart)->channels().count(), 3u);
}

TEST(ColouredFits, PredictionsAreThoseOfEachChannel) {
    const FitSamples samples = samplesOf(materials[0].truth, 0.05);
    FitOptions options{.model = "eon"};
    options.uncertainty = {.report = true, .bootstrap = 20};
    const FitResult result = fit(samples, options);
    const Prediction prediction = predict(result, samples);
    const std::vector<double> expected = predictedValues(result, samples);
    ASSERT_EQ(prediction.values.size(), expected.size());
    for (std::size_t v = 0; v < expected.size(); ++v)
        ASSERT_NEAR(prediction.values[v], expected[v], 1e-9 * (1 + expected[v])) << v;
}

// Every albedo that f is not linear in has a value for each channel, or is said to be shared: by a
// model that mixes channels.
TEST(ColouredFits, OfEveryModelNameTheAlbedosThatAllChannelsShare) {
    std::size_t albedos = 0;
    for (const Model& model : models()) {
        const std::string name(model.name);
        for (const bool isotropic : {true, false}) {
            const ParametricSum grey(name, isotropic), coloured(name, isotropic, 0, true);
            for (const std::string& albedo : grey.sharedAlbedos())
                EXPECT_EQ(std::ranges::count(coloured.linears(), albedo, &LinearParameter::name), 1)
                    << name << " " << albedo;
            EXPECT_TRUE(coloured.sharedAlbedos().empty()) << name;
            albedos += grey.sharedAlbedos().size();
        }
    }
    EXPECT_GE(albedos, 3u);
    // The tint is baseColor over its luminance, which all channels have in common.
    EXPECT_EQ(ParametricSum("disney:specularTint=.5", true, 0, true).sharedAlbedos(),
              std::vector<std::string>{"baseColor"});
    EXPECT_TRUE(ParametricSum("disney", true, 0, true).sharedAlbedos().empty());
    EXPECT_TRUE(ParametricSum("lambert+ggx", true, 0, true).sharedAlbedos().empty());
}

}  // namespace
}  // namespace hshfit::brdfs
