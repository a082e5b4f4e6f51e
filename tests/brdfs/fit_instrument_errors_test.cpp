// Errors of fits with an instrument: against GSL's linear and nonlinear least squares, fits without
// a sample or a scan, fits with a term held, and synthetic scans with known truth.

#include <brdfs/instrument_scans.h>

#include <brdfs/catalog.h>
#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/instrument/veil.h>
#include <brdfs/fit/prediction.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gsl/gsl_blas.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multifit.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

namespace hshfit::brdfs {
namespace {

using test::Coverage;
using test::noisyScans;
using test::samplesOfAScan;
using test::ScanTruth;

/// Without apertures, so that columns are values of open().
const ScanTruth pointTruth{.source = "", .detector = "", .scaleWidth = 0, .along = 0};

FitSamples pointScans(std::size_t scans, std::uint64_t seed) {
    std::mt19937_64 random(seed + 1);
    return noisyScans(test::exactScans(pointTruth, scans, seed), pointTruth, random);
}

/// Diffuse part, lobe and dark signal by GSL, with samples left out.
class LinearReadings {
public:
    static constexpr std::size_t count = 3;

    LinearReadings(const FitSamples& samples, const std::set<std::size_t>& without) {
        const std::vector<double> diffuse = valuesOf(*open("lambert:kd=1"), samples),
                                  lobe = valuesOf(*open("ggx:ks=1,F0=.9,alpha=.1"), samples);
        const std::size_t rows = samples.size() - without.size();
        gsl_matrix* x = gsl_matrix_alloc(rows, count);
        gsl_vector *y = gsl_vector_alloc(rows), *w = gsl_vector_alloc(rows),
                   *c = gsl_vector_alloc(count);
        gsl_matrix* covariance = gsl_matrix_alloc(count, count);
        std::size_t row = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (without.contains(k)) continue;
            const double columns[count] = {diffuse[k], lobe[k],
                                           1 / (samples.wo[k].z * samples.wiZ[k])};
            for (std::size_t i = 0; i < count; ++i) gsl_matrix_set(x, row, i, columns[i]);
            gsl_vector_set(y, row, samples.values[k]);
            gsl_vector_set(w, row++, 1 / std::pow(samples.sigmas[k], 2));
        }
        gsl_multifit_linear_workspace* work = gsl_multifit_linear_alloc(rows, count);
        gsl_multifit_wlinear(x, w, y, c, covariance, &chiSquare, work);
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = gsl_vector_get(c, i);
            for (std::size_t j = 0; j < count; ++j)
                covariances[i][j] = gsl_matrix_get(covariance, i, j);
        }
        gsl_multifit_linear_free(work);
        gsl_matrix_free(x), gsl_matrix_free(covariance);
        gsl_vector_free(y), gsl_vector_free(w), gsl_vector_free(c);
    }
    double values[count] = {}, covariances[count][count] = {}, chiSquare = 0;
};

// By all routes: chi-square and covariance, HC3 and CR3 as sums over fits without a sample or scan.
TEST(InstrumentErrors, OfLinearTermsAreThoseOfGsl) {
    const FitSamples samples = pointScans(14, 3);
    FitOptions options{.model = "lambert + ggx:F0=.9,alpha=.1", .loss = Loss::Kind::l2};
    options.uncertainty.report = options.uncertainty.profile = true;
    options.instrument = parseInstrument({.dark = "fit:both"});
    const FitResult result = fit(samples, options);
    const Uncertainty& study = *result.uncertainty;
    const LinearReadings reference(samples, {});
    ASSERT_EQ(result.parameters.size(), LinearReadings::count);
    EXPECT_EQ(result.parameters[2].name, "dark");
    EXPECT_TRUE(result.parameters[2].instrument);
    EXPECT_NEAR(study.chiSquare, reference.chiSquare, 1e-9 * reference.chiSquare);
    EXPECT_EQ(study.degreesOfFreedom, samples.size() - LinearReadings::count);
    double samplesOut[LinearReadings::count] = {}, scansOut[LinearReadings::count] = {};
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const LinearReadings rest(samples, {k});
        for (std::size_t i = 0; i < LinearReadings::count; ++i)
            samplesOut[i] += std::pow(rest.values[i] - reference.values[i], 2);
    }
    const std::size_t scans = samples.size() / samplesOfAScan;
    for (std::size_t s = 0; s < scans; ++s) {
        std::set<std::size_t> own;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (samples.scans[k] == s) own.insert(k);
        const LinearReadings rest(samples, own);
        for (std::size_t i = 0; i < LinearReadings::count; ++i)
            scansOut[i] += std::pow(rest.values[i] - reference.values[i], 2);
    }
    const double share = static_cast<double>(scans - 1) / static_cast<double>(scans);
    for (std::size_t i = 0; i < LinearReadings::count; ++i) {
        const double error = std::sqrt(reference.covariances[i][i]);
        EXPECT_NEAR(result.parameters[i].value, reference.values[i], 1e-5 * error);
        for (std::size_t j = 0; j < LinearReadings::count; ++j)
            EXPECT_NEAR(study.covariance[i * LinearReadings::count + j],
                        reference.covariances[i][j], 1e-8 * std::abs(reference.covariances[i][j]));
        EXPECT_NEAR(*study.parameters[i].sandwich, std::sqrt(samplesOut[i]), 1e-5 * error);
        EXPECT_NEAR(*study.parameters[i].scans, std::sqrt(share * scansOut[i]), 1e-5 * error);
        EXPECT_NEAR(*result.parameters[i].standardError, *study.parameters[i].scans, 1e-9);
        ASSERT_TRUE(study.parameters[i].profile);
        EXPECT_TRUE(study.parameters[i].profile->quadratic);
        EXPECT_NEAR((*study.parameters[i].profile->within95.high - reference.values[i]) / error,
                    gsl_cdf_ugaussian_Qinv(0.025), 1e-3);
    }
}

// With three scans errors follow from the stated uncertainties: the variance of f is g^T C g, g its
// two columns.
TEST(InstrumentErrors, OfFAreThoseOfTheMaterialByGsl) {
    const FitSamples samples = pointScans(3, 3);
    FitOptions options{.model = "lambert + ggx:F0=.9,alpha=.1", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    options.instrument = parseInstrument({.dark = "fit:both"});
    const FitResult result = fit(samples, options);
    const LinearReadings reference(samples, {});
    const Prediction own = predict(result, samples);
    const std::vector<double> diffuse = valuesOf(*open("lambert:kd=1"), samples),
                              lobe = valuesOf(*open("ggx:ks=1,F0=.9,alpha=.1"), samples);
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double g[2] = {diffuse[k], lobe[k]};
        double f = 0, variance = 0;
        for (int i = 0; i < 2; ++i) {
            f += g[i] * reference.values[i];
            for (int j = 0; j < 2; ++j) variance += g[i] * reference.covariances[i][j] * g[j];
        }
        EXPECT_NEAR(own.values[k], f, 1e-6 * f);
        EXPECT_NEAR(own.errors[k], std::sqrt(variance), 1e-7 * std::sqrt(variance));
    }
}

/// kd, ks, dark signal and the scale of each scan, with or without a prior: residuals of GSL.
struct ScaledReadings {
    const FitSamples& samples;
    std::vector<double> diffuse, lobe;
    std::size_t scans;
    double width;  ///< 0: the first scan is the reference

    std::size_t parameters() const { return 3 + scans - (width > 0 ? 0 : 1); }
    std::size_t rows() const { return samples.size() + (width > 0 ? scans : 0); }

    static int residuals(const gsl_vector* x, void* self, gsl_vector* f) {
        const auto& own = *static_cast<const ScaledReadings*>(self);
        const auto scaleOf = [&](std::size_t s) {
            if (own.width > 0) return gsl_vector_get(x, 3 + s);
            return s == 0 ? 1 : gsl_vector_get(x, 2 + s);
        };
        for (std::size_t k = 0; k < own.samples.size(); ++k) {
            const double m =
                gsl_vector_get(x, 0) * own.diffuse[k] + gsl_vector_get(x, 1) * own.lobe[k];
            const double reading =
                scaleOf(own.samples.scans[k]) * m + gsl_vector_get(x, 2) / own.samples.wo[k].z;
            gsl_vector_set(f, k, (reading - own.samples.values[k]) / own.samples.sigmas[k]);
        }
        for (std::size_t s = 0; own.width > 0 && s < own.scans; ++s)
            gsl_vector_set(f, own.samples.size() + s,
                           (std::log(scaleOf(s)) + own.width * own.width / 2) / own.width);
        return GSL_SUCCESS;
    }
};

class ScanScales : public testing::TestWithParam<double> {};

// All parameters at once by GSL's Levenberg-Marquardt, scales among them.
TEST_P(ScanScales, AndTheirErrorsAreThoseOfGsl) {
    const double width = GetParam();
    ScanTruth truth = pointTruth;
    truth.scaleWidth = 0.05;
    constexpr std::size_t scans = 9;
    std::mt19937_64 random(8);
    const FitSamples samples = noisyScans(test::exactScans(truth, scans, 4), truth, random);
    ScaledReadings own{samples, valuesOf(*open("lambert:kd=1"), samples),
                       valuesOf(*open("ggx:ks=1,F0=.9,alpha=.1"), samples), scans, width};
    gsl_multifit_nlinear_fdf equations{};
    equations.f = ScaledReadings::residuals;
    equations.n = own.rows();
    equations.p = own.parameters();
    equations.params = &own;
    gsl_multifit_nlinear_parameters how = gsl_multifit_nlinear_default_parameters();
    gsl_multifit_nlinear_workspace* work =
        gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, own.rows(), own.parameters());
    gsl_vector* x = gsl_vector_alloc(own.parameters());
    gsl_vector_set_all(x, 1);
    gsl_vector_set(x, 0, 0.4), gsl_vector_set(x, 1, 0.3), gsl_vector_set(x, 2, 0);
    gsl_multifit_nlinear_init(x, &equations, work);
    int info = 0;
    gsl_multifit_nlinear_driver(200, 1e-12, 1e-12, 1e-12, nullptr, nullptr, &info, work);
    const gsl_vector* found = gsl_multifit_nlinear_position(work);
    double chiSquare = 0;
    gsl_blas_ddot(gsl_multifit_nlinear_residual(work), gsl_multifit_nlinear_residual(work),
                  &chiSquare);
    gsl_matrix* covariance = gsl_matrix_alloc(own.parameters(), own.parameters());
    gsl_multifit_nlinear_covar(gsl_multifit_nlinear_jac(work), 0, covariance);

    FitOptions options{.model = "lambert + ggx:F0=.9,alpha=.1", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    options.instrument =
        parseInstrument({.dark = "fit", .scale = width > 0 ? fmt::format("{}", width) : "fit"});
    const FitResult result = fit(samples, options);
    const Uncertainty& study = *result.uncertainty;
    ASSERT_EQ(result.parameters.size(), own.parameters());
    EXPECT_NEAR(study.chiSquare, chiSquare, 1e-7 * chiSquare);
    EXPECT_EQ(study.degreesOfFreedom, own.rows() - own.parameters());
    for (std::size_t i = 0; i < own.parameters(); ++i) {
        const double error = std::sqrt(gsl_matrix_get(covariance, i, i));
        EXPECT_NEAR(result.parameters[i].value, gsl_vector_get(found, i), 1e-4 * error)
            << result.parameters[i].name;
        EXPECT_NEAR(*study.parameters[i].normal, error, 1e-4 * error) << result.parameters[i].name;
        EXPECT_TRUE(result.parameters[i].standardError);
    }
    EXPECT_EQ(result.parameters.back().name, fmt::format("scale {}", scans));
    EXPECT_EQ(result.instrument->scales.size(), scans);
    gsl_matrix_free(covariance);
    gsl_vector_free(x);
    gsl_multifit_nlinear_free(work);
}

INSTANTIATE_TEST_SUITE_P(Widths, ScanScales, testing::Values(0.0, 0.05));

// A profile's end, with the dark signal stated there.
TEST(InstrumentErrors, ProfilesEndWhereChiSquareHasRisen) {
    ScanTruth truth = pointTruth;
    truth.scaleWidth = 0.02;
    truth.noise = 0.1;
    std::mt19937_64 random(2);
    const FitSamples samples = noisyScans(test::exactScans(truth, 12, 6), truth, random);
    FitOptions options{.model = truth.model, .loss = Loss::Kind::l2, .starts = 2};
    options.uncertainty.report = options.uncertainty.profile = true;
    options.instrument = parseInstrument({.dark = "fit", .scale = "2%"});
    const FitResult result = fit(samples, options);
    ASSERT_EQ(result.parameters[3].name, "dark");
    const auto& profile = *result.uncertainty->parameters[3].profile;
    options.uncertainty.profile = false;
    for (const auto& [end, rise] : {std::pair{profile.within68.low, 1.0},
                                    {profile.within68.high, 1.0},
                                    {profile.within95.high, gsl_cdf_chisq_Qinv(0.05, 1)}}) {
        ASSERT_TRUE(end);
        options.instrument = parseInstrument({.dark = fmt::format("{}", *end), .scale = "2%"});
        const Uncertainty held = *fit(samples, options).uncertainty;
        EXPECT_NEAR(held.chiSquare - result.uncertainty->chiSquare, rise, 2e-3 * rise) << *end;
    }
    // Scales have no profile: they are eliminated.
    EXPECT_FALSE(result.uncertainty->parameters.back().profile);
}

FitResult bootstrapped(const FitSamples& samples, const ScanTruth& truth, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FitOptions options = test::scanFit(truth, true);
    options.uncertainty.bootstrap = 300;
    return fit(samples, options);
}

// A standard deviation of 300 draws is known to 4 %.
TEST(InstrumentErrors, BootstrapAgreesWithErrorsByScanAndNotWithThreads) {
    ScanTruth truth;
    truth.source = truth.detector = "";
    std::mt19937_64 random(4);
    const FitSamples samples = noisyScans(test::exactScans(truth, 80, 9), truth, random);
    const FitResult one = bootstrapped(samples, truth, 1), more = bootstrapped(samples, truth, 3);
    for (std::size_t i = 0; i < 4; ++i) {
        const ParameterUncertainty& own = one.uncertainty->parameters[i];
        EXPECT_EQ(own.bootstrap->error, more.uncertainty->parameters[i].bootstrap->error);
        EXPECT_NEAR(own.bootstrap->error / *own.scans, 1, 0.15) << one.parameters[i].name;
    }
    EXPECT_EQ(one.uncertainty->bootstrapFailures, 0u);
    for (std::size_t i = 0; i < one.parameters.size(); ++i)
        EXPECT_EQ(one.parameters[i].value, more.parameters[i].value);
}

// A constant that an instrument adds is one that a Lambertian surface reflects.
TEST(InstrumentErrors, AnOffsetAndADiffusePartAreNamedAmbiguous) {
    const FitSamples samples = pointScans(14, 5);
    FitOptions options{.model = "lambert + ggx:F0=.9,alpha=.1", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    options.instrument = parseInstrument({.offset = "fit"});
    const FitResult result = fit(samples, options);
    ASSERT_EQ(result.ambiguous.size(), 1u);
    EXPECT_EQ(result.ambiguous[0], (std::vector<std::string>{"lambert.kd", "offset"}));
    EXPECT_FALSE(result.parameters[0].standardError);
    // Stated, it is taken away.
    options.instrument = parseInstrument({.offset = "0.02"});
    options.model = "lambert";
    FitSamples constant = samples;
    for (double& value : constant.values) value = 0.4 / pi + 0.02;
    EXPECT_NEAR(fit(constant, options).parameters[0].value, 0.4, 1e-9);
}

TEST(InstrumentErrors, StrayLightIsFound) {
    FitSamples samples = pointScans(14, 7);
    const auto brdf = open(pointTruth.spec);
    const std::vector<double> mean = valuesOf(*brdf, veilOf(*brdf, samples, 1e-6).sums);
    const Veil veil = veilOf(*brdf, samples, 1e-6);
    const std::vector<double> f = valuesOf(*brdf, samples);
    constexpr double share = 0.03;
    for (std::size_t k = 0; k < samples.size(); ++k)
        samples.values[k] = (1 - share) * f[k] + share * mean[veil.of[k]];
    FitOptions options{.model = pointTruth.model, .loss = Loss::Kind::l2, .starts = 4};
    options.instrument = parseInstrument({.stray = "fit", .tolerance = 1e-6});
    const FitResult result = fit(samples, options);
    ASSERT_EQ(result.parameters.back().name, "stray");
    EXPECT_NEAR(result.parameters.back().value, share, 1e-5);
    EXPECT_NEAR(result.parameters[0].value, pointTruth.alpha, 1e-5);
    EXPECT_NEAR(result.parameters[1].value, pointTruth.kd, 1e-5);
}

// Whole scans are held out, and predicted with the instrument.
TEST(InstrumentRanking, HeldOutScansArePredictedWithTheInstrument) {
    ScanTruth truth;
    truth.source = "";
    std::mt19937_64 random(17);
    const FitSamples samples = noisyScans(test::exactScans(truth, 60, 12), truth, random);
    const std::string models[] = {truth.model, "lambert + beckmann:F0=.9"};
    const auto with = compareModels(samples, models, test::scanFit(truth, true)),
               without = compareModels(samples, models, test::scanFit(truth, false));
    EXPECT_EQ(with[0].model, truth.model);
    EXPECT_FALSE(with[1].tied);
    // Noise of sqrt(2) sigma and scales of two are all that is left.
    EXPECT_LT(with[0].heldOut, 0.7 * without[0].heldOut);
}

// Three scans are too few for errors of three parameters by scan. Errors follow from the stated
// uncertainties and the prior of scales, and hold; without either, the fit is refused.
TEST(InstrumentCoverage, OfThreeScansIsByStatedUncertainties) {
    constexpr std::size_t repeats = 600, scans = 3;
    const ScanTruth truth{.source = "", .detector = "", .dark = 0, .along = 0};
    const FitSamples exact = test::exactScans(truth, scans, 46);
    FitOptions options{.model = truth.model, .loss = Loss::Kind::l2, .starts = 1};
    options.uncertainty.report = true;
    options.instrument = parseInstrument({.scale = "0.02"});
    Coverage coverage;
    std::mt19937_64 random(9);
    for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
        const FitResult fitted = fit(noisyScans(exact, truth, random), options);
        const double values[] = {truth.alpha, truth.kd, truth.ks};
        for (std::size_t i = 0; i < std::size(values); ++i) {
            coverage.add(fitted.parameters[i].value - values[i],
                         *fitted.parameters[i].standardError);
            EXPECT_FALSE(fitted.uncertainty->parameters[i].scans);
        }
    }
    std::printf("coverage of 68.3 %% and 95 %%: %.3f %.3f\n", coverage.one(), coverage.two());
    EXPECT_NEAR(coverage.one(), 0.685, 0.035);
    EXPECT_NEAR(coverage.two(), 0.95, 0.02);
    FitSamples unstated = noisyScans(exact, truth, random);
    unstated.sigmas.clear();
    options.instrument = {};
    EXPECT_THROW(fit(unstated, options), NumericError);
}

// 200 scans with apertures, a dark signal, a scale each and noise that runs along them; as many
// draws as the suite has time for. docs/figures/fit_coverage.cpp has more.
TEST(InstrumentCoverage, OfStatedErrorsIsNominalAndFarOffWithoutTheTerms) {
    constexpr std::size_t repeats = 60, scans = 200;
    const ScanTruth truth;
    const FitSamples exact = test::exactScans(truth, scans, 2026);
    Coverage with, without;
    std::mt19937_64 random(7);
    for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
        const FitSamples samples = noisyScans(exact, truth, random);
        const FitResult fitted = fit(samples, test::scanFit(truth, true)),
                        plain = fit(samples, test::scanFit(truth, false));
        const double values[] = {truth.alpha, truth.kd, truth.ks, truth.dark};
        for (std::size_t i = 0; i < std::size(values); ++i) {
            with.add(fitted.parameters[i].value - values[i],
                     *fitted.uncertainty->parameters[i].scans);
            if (i < 3)
                without.add(plain.parameters[i].value - values[i],
                            *plain.uncertainty->parameters[i].scans);
        }
    }
    std::printf("coverage of 68.3 %% and 95 %%: %.3f %.3f, without the terms %.3f %.3f\n",
                with.one(), with.two(), without.one(), without.two());
    // Three standard deviations of a share of so many draws, of which some are correlated.
    const double draws = static_cast<double>(repeats * 2);
    EXPECT_NEAR(with.one(), 0.6827, 3 * std::sqrt(0.6827 * 0.3173 / draws));
    EXPECT_NEAR(with.two(), 0.95, 3 * std::sqrt(0.95 * 0.05 / draws));
    EXPECT_LT(without.two(), 0.4);
}

}  // namespace
}  // namespace hshfit::brdfs
