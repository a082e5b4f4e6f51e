// Fits with laws over the wavelength to readings through apertures and a slit.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/spectral_samples.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace hshfit::brdfs {
namespace {

using namespace test;

// The two ways to the same readings share apertures and slit, and nothing of the search.
TEST(DispersedReadings, WithAnInstrumentAndTheLawsOfThePlainFitItIsThePlainFit) {
    const FitSamples samples = spectralSamples(60, 12);
    FitOptions plainly = optionsOf(""), byLaws = optionsOf("ggx.alpha=shared,kd=free");
    plainly.instrument = byLaws.instrument = parseInstrument({.source = "cone:1",
                                                              .detector = "cone:2",
                                                              .bandwidth = "triangle:60",
                                                              .offset = "0.001",
                                                              .dark = "0.0005:both"});
    const FitResult plain = fit(samples, plainly), laws = fit(samples, byLaws);
    ASSERT_EQ(plain.parameters.size(), laws.parameters.size());
    EXPECT_NEAR(plain.loss, laws.loss, 1e-6 * plain.loss);
    EXPECT_NEAR(plain.uncertainty->chiSquare, laws.uncertainty->chiSquare,
                1e-6 * plain.uncertainty->chiSquare);
    for (const FittedParameter& own : plain.parameters) {
        const FittedParameter& other = parameter(laws, own.name, own.channel);
        ASSERT_TRUE(own.standardError && other.standardError) << own.name;
        EXPECT_NEAR(own.value, other.value, 1e-2 * *own.standardError) << own.name;
        EXPECT_NEAR(*own.standardError, *other.standardError, 2e-3 * *own.standardError)
            << own.name << " " << own.channel;
    }
    ASSERT_TRUE(laws.instrument);
    EXPECT_GT(laws.instrument->nodes, samples.size());
    EXPECT_EQ(laws.instrument->offset, std::vector<double>(wavelengths.size(), 0.001));
    const std::vector<double> readings = predictedValues(plain, samples),
                              byOther = predictedValues(laws, samples);
    for (std::size_t v = 0; v < readings.size(); ++v) {
        EXPECT_NEAR(byOther[v], readings[v], 1e-4 * readings[v]);
        EXPECT_NEAR(laws.uncertainty->values[v].model, readings[v], 1e-3 * readings[v]);
    }
}

// Exact readings of a box of 80 nm, by midpoint sums of f, straight between the wavelengths.
TEST(DispersedReadings, TakesABandwidthOutOfLaws) {
    FitSamples samples = spectralSamples(120, 13);
    const std::size_t count = samples.size();
    FitSamples grey = samples;
    grey.channels = Channels::grey();
    std::vector<std::vector<double>> f;
    for (const double nm : wavelengths) f.push_back(valuesOf(*open(truthAt(nm)), grey));
    constexpr int steps = 4000;
    for (std::size_t c = 0; c < wavelengths.size(); ++c)
        for (std::size_t k = 0; k < count; ++k) {
            double sum = 0;
            for (int i = 0; i < steps; ++i) {
                const double nm = wavelengths[c] + 80 * ((i + 0.5) / steps - 0.5);
                const double place = std::clamp((nm - 400) / 50, 0.0, 8.0);
                const auto below = std::min<std::size_t>(static_cast<std::size_t>(place), 7);
                const double part = place - static_cast<double>(below);
                sum += (1 - part) * f[below][k] + part * f[below + 1][k];
            }
            samples.values[c * count + k] = sum / steps;
        }
    FitOptions options = optionsOf("ior=cauchy:2,kd=poly:1");
    options.instrument = parseInstrument({.bandwidth = "box:80"});
    const FitResult result = fit(samples, options);
    EXPECT_NEAR(parameter(result, "ggx.ior.A").value, indexA, 1e-5);
    EXPECT_NEAR(parameter(result, "ggx.ior.B").value, indexB, 1e-5);
    EXPECT_NEAR(parameter(result, "ggx.alpha").value, 0.2, 1e-5);
    options.instrument = {};
    EXPECT_GT(fit(samples, options).uncertainty->chiSquare, 1e3 * result.uncertainty->chiSquare);
    options.instrument = parseInstrument({.offset = "fit"});
    EXPECT_THROW(fit(samples, options), UsageError);
}

}  // namespace
}  // namespace hshfit::brdfs
