// Fits of thin films, whose reflectances in R, G and B are functions of their own.

#include <brdfs/catalog.h>
#include <brdfs/fit/choose_parts.h>
#include <brdfs/fit/normal_equations.h>
#include <brdfs/fit/picture_samples.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit_laws.h>
#include <brdfs/random_draws.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

const std::string gltfFilm =
    "gltf-pbr:baseColorFactor=.6/.4/.3,metallicFactor=.7,roughnessFactor=.5,iridescenceFactor=1,"
    "iridescenceIor=1.6,iridescenceThickness=420";
const std::string openpbrFilm =
    "openpbr:base_color=.6/.4/.3,base_metalness=1,specular_roughness=.5,thin_film_weight=1,"
    "thin_film_ior=1.7,thin_film_thickness=.38";

FitSamples samplesOf(const std::string& spec, std::size_t count, double noise = 0) {
    FitSamples samples = gatherSamples(*open(spec), {}).drawn(count, 1);
    std::mt19937_64 random(5);
    for (double& value : samples.values) value *= std::exp(noise * test::normal(random));
    return samples;
}

std::vector<double> startOf(const ParametricSum& sum, std::size_t channels) {
    std::vector<double> x;
    for (const ShapeParameter& shape : sum.shapes())
        x.push_back(std::lerp(shape.toScale(shape.free.startLow),
                              shape.toScale(shape.free.startHigh),
                              0.3 + 0.05 * static_cast<double>(x.size())));
    for (std::size_t k = 0; k < sum.linears().size(); ++k)
        for (std::size_t c = 0; c < channels; ++c) x.push_back(0.3 + 0.1 * static_cast<double>(c));
    return x;
}

TEST(FilmFit, ValuesAndGradientsAreThoseOfTheCatalogModel) {
    for (const std::string model :
         {"gltf-pbr:iridescenceFactor=.8", "openpbr:thin_film_weight=.8"}) {
        const FitSamples samples = samplesOf(gltfFilm, 300);
        const ParametricSum sum(model, true);
        const FitProblem problem(samples, sum, Loss::Kind::log);
        SCOPED_TRACE(model);
        expectValuesAndGradients(samples, sum, problem, startOf(sum, 3));
    }
}

TEST(FilmFit, RecoversAFilm) {
    const FitResult gltf =
        fit(samplesOf(gltfFilm, 800),
            {.model = "gltf-pbr:iridescenceFactor=1,ior=1.5,specularFactor=1,sheenColorFactor=0,"
                      "clearcoatFactor=0,clearcoatRoughnessFactor=0,sheenRoughnessFactor=0",
             .loss = Loss::Kind::log});
    EXPECT_LT(gltf.loss, 1e-6);
    const auto valueOf = [&](std::string_view name) {
        return std::ranges::find(gltf.parameters, name, &FittedParameter::name)->value;
    };
    EXPECT_NEAR(valueOf("iridescenceThickness"), 420, 0.01);
    EXPECT_NEAR(valueOf("iridescenceIor"), 1.6, 1e-4);
    EXPECT_NEAR(valueOf("baseColorFactor"), 0.6, 1e-4);
    const FitResult openpbr =
        fit(samplesOf(openpbrFilm, 800),
            {.model = withParts("openpbr", {"thin_film"}), .loss = Loss::Kind::log});
    EXPECT_LT(openpbr.loss, 1e-6);
    EXPECT_NE(openpbr.spec.find("thin_film_weight=1"), std::string::npos) << openpbr.spec;
}

// A prediction of a channel is f there, and its error follows from the errors of the parameters.
TEST(FilmFit, PredictionsAreThoseOfEachChannel) {
    const FitSamples samples = samplesOf(gltfFilm, 600, 0.01);
    const FitResult result =
        fit(samples, {.model = withParts("gltf-pbr", {"iridescence"}), .loss = Loss::Kind::log});
    const Prediction prediction = predict(result, samples);
    const std::vector<double> expected = predictedValues(result, samples);
    ASSERT_EQ(prediction.values.size(), expected.size());
    for (std::size_t v = 0; v < expected.size(); ++v)
        ASSERT_NEAR(prediction.values[v], expected[v], 1e-9 * (1 + expected[v])) << v;
}

PartSearch chosenFor(const std::string& spec) {
    return chooseParts(pictureSamples(*open(spec), {.rings = 4, .around = 6, .points = 48}),
                       {.model = "gltf-pbr", .loss = Loss::Kind::picture});
}

// The film is the last part that is tried, with the share of the facets that fits best; a fit
// starts where its search ended.
TEST(FilmFit, APartIsTriedWhereColoursChangeWithTheDirectionsAndTakenIfItIsThere) {
    for (const char* share : {"1", "0.5"}) {
        const PartSearch film = chosenFor(
            fmt::format("gltf-pbr:baseColorFactor=.6/.4/.3,roughnessFactor=.5,iridescenceFactor={},"
                        "iridescenceIor=1.6,iridescenceThickness=420",
                        share));
        EXPECT_EQ(film.parts, std::vector<std::string>{"iridescence"}) << textOf(film);
        EXPECT_EQ(film.stated, fmt::format("iridescenceFactor={}", share));
        EXPECT_EQ(film.from.size(),
                  ParametricSum(withParts("gltf-pbr", film), true).shapes().size());
    }
    const PartSearch none =
        chosenFor("lambert:kd=.2/.2/.19 + phong:exponent=30,ks=.5,normalized=true");
    ASSERT_GT(none.trials.back().loss, PartOptions{}.unseen);
    EXPECT_EQ(textOf(none).find("iridescence"), std::string::npos) << textOf(none);
    EXPECT_TRUE(none.from.empty() && none.stated.empty());
}

TEST(FilmFit, NeedsRgb) {
    const FitSamples grey = samplesOf("ggx:alpha=.3", 100);
    const FitOptions how{.model = withParts("gltf-pbr", {"iridescence"}), .loss = Loss::Kind::log};
    try {
        fit(grey, how);
        ADD_FAILURE() << "fitted";
    } catch (const UsageError& error) {
        EXPECT_NE(std::string(error.what()).find("R, G and B"), std::string::npos) << error.what();
    }
    const Model& model = *modelWithParts("gltf-pbr");
    EXPECT_EQ(std::ranges::count(partsFor(model, grey.channels), "iridescence"), 0);
    EXPECT_EQ(std::ranges::count(partsFor(model, samplesOf(gltfFilm, 10).channels), "iridescence"),
              1);
}

}  // namespace
}  // namespace hshfit::brdfs
