// Fits of spectra: a shape that all wavelengths share, or one for each; and chi-square of measured
// spectra by way of the BRDF that the fit opens.

#include <brdfs/catalog.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/composed/spectrum.h>
#include <brdfs/fit/fit.h>
#include <hshfit/error.h>

#include <places.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

const std::vector<double> wavelengths = {450, 550, 650};

/// Values of a model whose lobe narrows with the wavelength, with noise, as three wavelengths.
FitSamples spectralSamples() {
    FitSamples samples =
        gatherSamples(*open("lambert"), {.weights = SampleWeights::equal}).drawn(600, 4);
    samples.channels = Channels::spectral(wavelengths);
    samples.values.clear();
    std::mt19937_64 random(8);
    for (const char* spec :
         {"lambert:kd=.1 + ggx:F0=.9,ks=.2,alpha=.30", "lambert:kd=.2 + ggx:F0=.9,ks=.25,alpha=.28",
          "lambert:kd=.3 + ggx:F0=.9,ks=.3,alpha=.26"}) {
        FitSamples own = samples;
        own.channels = Channels::grey();
        for (const double f : valuesOf(*open(spec), own)) {
            const double noise = static_cast<double>(random() >> 11) * 0x1p-53 - 0.5;
            samples.sigmas.push_back(0.03 * f);
            samples.values.push_back(f * (1 + 0.1 * noise));
        }
    }
    return samples;
}

const FittedParameter& parameter(const FitResult& result, const std::string& name,
                                 const std::string& channel = "") {
    for (const FittedParameter& own : result.parameters)
        if (own.name == name && own.channel == channel) return own;
    throw std::out_of_range(name);
}

TEST(SpectralFit, PerChannelIsTheFitOfEachWavelengthAlone) {
    const FitSamples samples = spectralSamples();
    FitOptions options{
        .model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2, .perChannel = true, .starts = 4};
    const FitResult all = fit(samples, options);
    ASSERT_EQ(all.spectrum.size(), 3u);
    EXPECT_TRUE(all.spec.empty());
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_EQ(all.spectrum[c].nanometres, wavelengths[c]);
        EXPECT_EQ(all.spectrum[c].spec, fit(samples.channel(c), options).spec);
    }
}

TEST(SpectralFit, SharedShapesAreAtTheLeastSumOverWavelengths) {
    const FitSamples samples = spectralSamples();
    const FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2, .starts = 4};
    const FitResult shared = fit(samples, options);
    const double alpha = parameter(shared, "ggx.alpha").value;
    // With the shape held, wavelengths are fits of their own.
    const auto costAt = [&](double held, bool compare) {
        double sum = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            FitOptions own = options;
            own.model = fmt::format("lambert + ggx:F0=.9,alpha={}", held);
            own.uncertainty.report = true;
            const FitResult one = fit(samples.channel(c), own);
            sum += one.uncertainty->chiSquare;
            if (!compare) continue;
            const std::string name = samples.channels.names()[c];
            for (const char* linear : {"lambert.kd", "ggx.ks"})
                EXPECT_NEAR(parameter(one, linear).value, parameter(shared, linear, name).value,
                            1e-7);
        }
        return sum;
    };
    const double least = costAt(alpha, true);
    EXPECT_LT(least, costAt(alpha * 1.01, false));
    EXPECT_LT(least, costAt(alpha / 1.01, false));
}

TEST(SpectralFit, OpensAsOneBrdfWithThoseWavelengths) {
    const FitSamples samples = spectralSamples();
    const FitResult result =
        fit(samples, {.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2, .starts = 2});
    const auto brdf = openFit(result);
    EXPECT_EQ(brdf->channels().wavelengths, wavelengths);
    const std::vector<double> f = valuesOf(*brdf, samples);
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<double> own =
            valuesOf(*open(result.spectrum[c].spec), samples.channel(c));
        for (std::size_t k = 0; k < own.size(); ++k) EXPECT_EQ(f[c * samples.size() + k], own[k]);
    }
}

std::string presetText(const std::string& lines) {
    return R"({"format": "hshfit-preset", "version": 1, "spectrum": )" + lines + "}";
}

TEST(SpectrumPreset, IsSpectralAndItsLinesAreItsChannels) {
    const auto brdf = openPreset(presetText(R"([{"wavelength": 400, "spec": "lambert:kd=0.2"},
                        {"wavelength": 700.5, "spec": "lambert:kd=0.6 + 0.5 * lambert:kd=0.2"}])"),
                                 "test.json");
    EXPECT_EQ(brdf->name(), "test.json");
    EXPECT_EQ(brdf->channels().wavelengths, (std::vector<double>{400, 700.5}));
    EXPECT_TRUE(brdf->laws().isotropic && brdf->laws().reciprocal);
    const std::vector<double> f =
        evaluate(*brdf, directionFromAngles(0.3, 0), directionFromAngles(0.6, 2));
    EXPECT_NEAR(f[0], 0.2 / pi, 1e-15);
    EXPECT_NEAR(f[1], 0.7 / pi, 1e-15);
}

TEST(SpectrumPreset, ThatIsInvalidIsRefused) {
    for (const char* lines : {
             "[]",
             "{}",
             R"([{"wavelength": 400}])",
             R"([{"spec": "lambert"}])",
             R"([{"wavelength": -4, "spec": "lambert"}])",
             R"([{"wavelength": "x", "spec": "lambert"}])",
             R"([{"wavelength": 400, "spec": "lambert"}, {"wavelength": 400, "spec": "lambert"}])",
             R"([{"wavelength": 400, "spec": "lambert:kd=.1/.2/.3"}])",
             R"([{"wavelength": 400, "spec": "nothing"}])",
             R"([{"wavelength": 400, "spec": "preset:hsh-ward"}])",
         })
        EXPECT_THROW(openPreset(presetText(lines), "test.json"), InputError) << lines;
}

// Chi-square by another way: the BRDF that the fit opens, at the directions of the file.
TEST(SpectralFit, ChiSquareOfMeasuredSpectraIsThatOfTheOpenedFit) {
    bool any = false;
    for (const char* file : {"nist_ptfe/PTFE.data.csv", "cornell/garnet_red.brdf"}) {
        const std::string path = test::sharedFolder() + "/data/" + file;
        if (!std::filesystem::exists(path)) continue;
        any = true;
        const FitSamples samples =
            gatherSamples(*open(path), {.grazingCut = 75, .sigma = parseSigma("5%+0.002")});
        for (const char* model : {"lambert", "lambert+ggx", "lambert+beckmann"}) {
            FitOptions options{.model = model, .loss = Loss::Kind::l2, .starts = 4};
            options.uncertainty.report = true;
            const FitResult result = fit(samples, options);
            const std::vector<double> f = valuesOf(*openFit(result), samples);
            double chiSquare = 0;
            for (std::size_t v = 0; v < f.size(); ++v)
                chiSquare += std::pow((f[v] - samples.values[v]) / samples.sigmas[v], 2);
            EXPECT_NEAR(result.uncertainty->chiSquare, chiSquare, 1e-6 * chiSquare);
            std::printf("%s %s: chi-square %.4g over %zu, %.3g each\n", file, model, chiSquare,
                        result.uncertainty->degreesOfFreedom,
                        result.uncertainty->reducedChiSquare());
            std::size_t free = 0;
            for (const FittedParameter& own : result.parameters) free += own.bound.empty();
            EXPECT_GE(result.uncertainty->degreesOfFreedom + free, result.values);
        }
    }
    if (!any) GTEST_SKIP() << "no shared data";
}

}  // namespace
}  // namespace hshfit::brdfs
