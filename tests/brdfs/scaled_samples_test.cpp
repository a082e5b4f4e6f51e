// A factor or a change of channels before a file of samples leaves samples: the values in the file
// times the factor, and no interpolated values in their place.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit_samples.h>
#include <brdfs/measured/scattered/scattered.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace hshfit {
namespace {

// A tile that is as bright as an ideal Lambert surface, by three channels of reflectance factors.
constexpr const char* tile =
    "NUM_POINTS 4\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n"
    "0,0,45,180,0.98,0.5,0.2\n10,0,0,0,1,0.5,0.25\n30,0,0,0,0.97,0.5,0.25\n60,0,0,0,0.9,0.5,0.2\n";

std::vector<double> valuesOf(const Brdf& brdf) {
    const auto pairs = brdfs::measuredPairs(brdf);
    EXPECT_TRUE(pairs) << brdf.name();
    return pairs ? pairs->samples.values : std::vector<double>{};
}

void expectTimes(const std::vector<double>& got, double factor) {
    const double stated[] = {0.98, 0.5, 0.2, 1, 0.5, 0.25, 0.97, 0.5, 0.25, 0.9, 0.5, 0.2};
    ASSERT_EQ(got.size(), std::size(stated));
    for (std::size_t k = 0; k < got.size(); ++k)
        EXPECT_NEAR(got[k], factor * stated[k], 1e-12) << k;
}

TEST(ScaledSamples, FactorsAndQuantitiesMultiplyTheSamples) {
    const test::TemporaryFile file(tile, ".astm");
    const std::string path = file.path() + ":angles=degrees";
    expectTimes(valuesOf(*brdfs::open(path)), 1);
    expectTimes(valuesOf(*brdfs::open("0.25 * " + path)), 0.25);
    expectTimes(valuesOf(*brdfs::open(path + ",scale=3")), 3);
    expectTimes(valuesOf(*brdfs::open(path + ",quantity=radiance-factor")), 1 / pi);
    expectTimes(valuesOf(*brdfs::open("2 * " + path + ",quantity=radiance-factor,scale=0.5")),
                1 / pi);
    const auto scaled = brdfs::open("0.25 * " + path);
    EXPECT_EQ(evaluate(*brdfs::open(scaled->name()), {0, 0, 1}, {0.6, 0, 0.8}),
              evaluate(*scaled, {0, 0, 1}, {0.6, 0, 0.8}))
        << "the name opens the same";
    const Direction wi = directionFromAngles(radians(10), 0);
    EXPECT_NEAR(evaluate(*scaled, wi, {0, 0, 1})[1], 0.125, 1e-9);
    EXPECT_THROW(brdfs::open(path + ",quantity=reflectance"), UsageError);
}

TEST(ScaledSamples, EveryScatteredFormatTakesScaleAndQuantity) {
    for (const brdfs::Format& format : brdfs::formats()) {
        const auto has = [&](std::string_view name) {
            return std::ranges::any_of(format.parameters,
                                       [&](const auto& p) { return p.name == name; });
        };
        if (!has("reach")) continue;  // the scattered ones
        EXPECT_TRUE(has("scale") && has("quantity")) << format.name;
    }
}

TEST(ScaledSamples, ChannelsOfSamplesAreSamples) {
    const test::TemporaryFile file(tile, ".astm");
    const auto red = brdfs::open("grey=1/0/0:2 * " + file.path() + ":angles=degrees");
    const std::vector<double> values = valuesOf(*red), expected{1.96, 2, 1.94, 1.8};
    ASSERT_EQ(values.size(), 4u);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(values[k], expected[k], 1e-12);
    EXPECT_FALSE(brdfs::measuredPairs(*brdfs::open("lambert")));
}

TEST(ScaledSamples, FitsSeeTheSamplesAlone) {
    const test::TemporaryFile file(tile, ".astm");
    const auto scaled = brdfs::open("0.5 * " + file.path() + ":angles=degrees");
    ASSERT_TRUE(brdfs::areMeasured(*scaled));
    const brdfs::FitSamples samples = brdfs::gatherSamples(*scaled, {});
    EXPECT_EQ(samples.origin, brdfs::SampleOrigin::measured);
    EXPECT_EQ(samples.size(), 4u);
}

TEST(ScaledSamples, WritersKeepTheSamplesAlone) {
    const test::TemporaryFile file(tile, ".astm"), to("", ".alta");
    const auto scaled = brdfs::open("0.5 * " + file.path() + ":angles=degrees");
    for (const brdfs::Writer& writer : brdfs::writers()) {
        if (writer.name != "alta") continue;
        writer.write(
            *scaled, to.path(),
            completed("alta", writer.parameters, readParameters("alta", writer.parameters, "")),
            {.force = true});
    }
    const std::vector<double> back = valuesOf(*brdfs::open(to.path()));
    ASSERT_EQ(back.size(), 12u);
    EXPECT_NEAR(back[3], 0.5, 1e-6);
}

}  // namespace
}  // namespace hshfit
