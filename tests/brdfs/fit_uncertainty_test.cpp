// Uncertainties of fits against GSL, leave-one-out fits, fits with a parameter held, and synthetic
// scans with known truth.

#include <brdfs/catalog.h>
#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/fit_samples.h>
#include <brdfs/fit/residual_rows.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/random_draws.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multifit.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <Eigen/Dense>

#include <cmath>
#include <memory>
#include <random>
#include <set>
#include <vector>

namespace hshfit::brdfs {
namespace {

constexpr std::size_t scanLength = 6;

using test::directionBelow, test::normal, test::uniform;

/// Scans of outgoing directions through the lobe, each at an incident direction of its own. Values
/// are f of `spec`.
FitSamples scansOf(const std::string& spec, std::size_t scans, std::mt19937_64& random) {
    FitSamples samples;
    samples.isotropic = true;
    samples.origin = SampleOrigin::measured;
    for (std::size_t s = 0; s < scans; ++s) {
        const Direction wi = directionBelow(1.2, random);
        const double turn = azimuth(wi) + pi + 0.4 * normal(random);
        for (std::size_t k = 0; k < scanLength; ++k) {
            samples.wiX.push_back(wi.x);
            samples.wiY.push_back(wi.y);
            samples.wiZ.push_back(wi.z);
            samples.wo.push_back(directionFromAngles(
                1.25 * (static_cast<double>(k) + uniform(random)) / scanLength, turn));
            samples.scans.push_back(s);
            samples.weights.push_back(1);
        }
    }
    samples.values = valuesOf(*open(spec), samples);
    return samples;
}

FitSamples withNoise(FitSamples samples, double share, std::mt19937_64& random) {
    for (double& value : samples.values) {
        samples.sigmas.push_back(share * value * (0.5 + uniform(random)));
        value += samples.sigmas.back() * normal(random);
    }
    return samples;
}

/// A linear model in closed form: weighted least squares by GSL on columns that open() evaluates.
class Linear {
public:
    static constexpr std::size_t count = 2;

    Linear(const FitSamples& samples, const std::set<std::size_t>& without) {
        const std::vector<double> diffuse = valuesOf(*open("lambert:kd=1"), samples),
                                  lobe = valuesOf(*open("ggx:ks=1,F0=.5,alpha=.3"), samples);
        const std::size_t rows = samples.size() - without.size();
        gsl_matrix* x = gsl_matrix_alloc(rows, count);
        gsl_vector *y = gsl_vector_alloc(rows), *w = gsl_vector_alloc(rows),
                   *c = gsl_vector_alloc(count);
        gsl_matrix* covariance = gsl_matrix_alloc(count, count);
        std::size_t row = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (without.contains(k)) continue;
            gsl_matrix_set(x, row, 0, diffuse[k]);
            gsl_matrix_set(x, row, 1, lobe[k]);
            gsl_vector_set(y, row, samples.values[k]);
            gsl_vector_set(w, row++, samples.weight(0, k));
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
        diffuse_ = diffuse, lobe_ = lobe;
    }
    double at(std::size_t k) const { return values[0] * diffuse_[k] + values[1] * lobe_[k]; }
    /// Variance of the fitted value at a sample.
    double varianceAt(std::size_t k) const {
        const double x[] = {diffuse_[k], lobe_[k]};
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j) sum += x[i] * covariances[i][j] * x[j];
        return sum;
    }

    double values[count] = {}, covariances[count][count] = {}, chiSquare = 0;

private:
    std::vector<double> diffuse_, lobe_;
};

const std::string linearModel = "lambert + ggx:F0=.5,alpha=.3",
                  linearTruth = "lambert:kd=.4 + ggx:ks=.3,F0=.5,alpha=.3";

class LinearFit : public testing::Test {
protected:
    void SetUp() override {
        std::mt19937_64 random(11);
        samples = withNoise(scansOf(linearTruth, 12, random), 0.05, random);
        reference = std::make_unique<Linear>(samples, std::set<std::size_t>());
        FitOptions options{.model = linearModel, .loss = Loss::Kind::l2};
        options.uncertainty.report = options.uncertainty.profile = true;
        result = fit(samples, options);
        study = *result.uncertainty;
    }

    FitSamples samples;
    std::unique_ptr<Linear> reference;
    FitResult result;
    Uncertainty study;
};

constexpr double rounding = 1e-9;

TEST_F(LinearFit, ChiSquareAndCovarianceAreThoseOfGsl) {
    EXPECT_NEAR(study.chiSquare, reference->chiSquare, rounding * reference->chiSquare);
    EXPECT_EQ(study.degreesOfFreedom, samples.size() - Linear::count);
    const double degrees = static_cast<double>(study.degreesOfFreedom);
    EXPECT_NEAR(*study.probability, gsl_cdf_chisq_Q(reference->chiSquare, degrees), rounding);
    EXPECT_NEAR(study.outlierBound,
                gsl_cdf_tdist_Qinv(0.025 / static_cast<double>(samples.size()), degrees - 1), 1e-7);
    for (std::size_t i = 0; i < Linear::count; ++i) {
        EXPECT_NEAR(result.parameters[i].value, reference->values[i], rounding);
        for (std::size_t j = 0; j < Linear::count; ++j) {
            const double expected = reference->covariances[i][j];
            EXPECT_NEAR(study.covariance[i * Linear::count + j], expected,
                        rounding * std::abs(expected));
        }
        EXPECT_NEAR(*study.parameters[i].normal, std::sqrt(reference->covariances[i][i]), rounding);
    }
}

// By their definitions, each sample left out of a fit of GSL.
TEST_F(LinearFit, InfluenceIsThatOfFitsWithoutTheSample) {
    const double degrees = static_cast<double>(study.degreesOfFreedom);
    double leverages = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const ValueInfluence& own = study.values[k];
        const double sigma = samples.sigmas[k];
        const Linear rest(samples, {k});
        EXPECT_NEAR(own.model, reference->at(k), rounding);
        EXPECT_NEAR(own.leverage, reference->varianceAt(k) / (sigma * sigma), rounding);
        leverages += own.leverage;
        const double variance = rest.chiSquare / (degrees - 1);
        EXPECT_NEAR(own.studentised,
                    (samples.values[k] - rest.at(k)) /
                        std::sqrt(variance * (sigma * sigma + rest.varianceAt(k))),
                    1e-7);
        double moved = 0;
        for (std::size_t j = 0; j < samples.size(); ++j)
            moved += std::pow((reference->at(j) - rest.at(j)) / samples.sigmas[j], 2);
        EXPECT_NEAR(own.cook, moved / (Linear::count * reference->chiSquare / degrees), 1e-7);
    }
    EXPECT_NEAR(leverages, Linear::count, rounding);
}

// HC3 and CR3 of a linear model are sums over fits of GSL without a sample, or a scan.
TEST_F(LinearFit, SandwichesAreSumsOverFitsWithoutASampleOrAScan) {
    double samplesOut[Linear::count] = {}, scansOut[Linear::count] = {};
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Linear rest(samples, {k});
        for (std::size_t i = 0; i < Linear::count; ++i)
            samplesOut[i] += std::pow(rest.values[i] - reference->values[i], 2);
    }
    const std::size_t scans = samples.size() / scanLength;
    for (std::size_t s = 0; s < scans; ++s) {
        std::set<std::size_t> own;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (samples.scans[k] == s) own.insert(k);
        const Linear rest(samples, own);
        for (std::size_t i = 0; i < Linear::count; ++i)
            scansOut[i] += std::pow(rest.values[i] - reference->values[i], 2);
    }
    const double share = static_cast<double>(scans - 1) / static_cast<double>(scans);
    for (std::size_t i = 0; i < Linear::count; ++i) {
        EXPECT_NEAR(*study.parameters[i].sandwich, std::sqrt(samplesOut[i]), 1e-7);
        EXPECT_NEAR(*study.parameters[i].scans, std::sqrt(share * scansOut[i]), 1e-7);
        EXPECT_NEAR(*result.parameters[i].standardError, *study.parameters[i].scans, rounding);
    }
    EXPECT_EQ(study.scans, scans);
}

TEST_F(LinearFit, ProfilesAreTheNormalIntervals) {
    for (std::size_t i = 0; i < Linear::count; ++i) {
        const double error = std::sqrt(reference->covariances[i][i]);
        ASSERT_TRUE(study.parameters[i].profile);
        const auto& profile = *study.parameters[i].profile;
        EXPECT_TRUE(profile.quadratic);
        for (const auto& [interval, quantile] :
             {std::pair{profile.within68, 1.0},
              {profile.within95, gsl_cdf_ugaussian_Qinv(0.025)}}) {
            EXPECT_NEAR((*interval.high - reference->values[i]) / error, quantile, 1e-3);
            EXPECT_NEAR((reference->values[i] - *interval.low) / error, quantile, 1e-3);
        }
    }
}

// The variance of a mean of S equal scans has S - 1 degrees of freedom (Gosset 1908).
TEST(ScanDegrees, OfTheMeanOfEqualScansAreOneLessThanTheScans) {
    constexpr int scans = 7;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Constant(1, 1, 1);
    const std::vector<ScanSums> sums(scans, {3 * one, Eigen::VectorXd::Zero(1)});
    EXPECT_NEAR(scanDegrees(sums, one / (3 * scans), one).front(), scans - 1, 1e-9);
}

// A chi-square with n degrees of freedom has a mean of n and a variance of 2 n.
TEST(ScanDegrees, AreThoseOfTheVariancesOfDrawnLines) {
    constexpr std::size_t scans = 12, perScan = 3;
    const auto place = [](std::size_t v) {
        const double x = static_cast<double>(v) / (scans * perScan);
        return 4 * x * x * x;  // the last scans decide the slope
    };
    Eigen::MatrixXd rows(scans * perScan, 2);
    for (std::size_t v = 0; v < scans * perScan; ++v)
        rows.row(static_cast<Eigen::Index>(v)) << 1, place(v);
    const Eigen::MatrixXd inverse = (rows.transpose() * rows).inverse();
    const auto part = [&](const auto& of, std::size_t s) {
        return of.middleRows(static_cast<Eigen::Index>(s * perScan), perScan);
    };
    std::mt19937_64 random(5);
    constexpr int draws = 20000;
    double mean = 0, square = 0;
    std::vector<ScanSums> sums(scans);
    for (int d = 0; d < draws; ++d) {
        Eigen::VectorXd y(rows.rows());
        for (double& value : y) value = normal(random);
        const Eigen::VectorXd residual = y - rows * (inverse * (rows.transpose() * y));
        for (std::size_t s = 0; s < scans; ++s)
            sums[s] = {part(rows, s).transpose() * part(rows, s),
                       part(rows, s).transpose() * part(residual, s)};
        const double variance = (inverse * scanSpread(sums, inverse) * inverse)(1, 1);
        mean += variance / draws;
        square += variance * variance / draws;
    }
    const double degrees = scanDegrees(sums, inverse, Eigen::MatrixXd::Identity(2, 2))[1];
    EXPECT_LT(degrees, scans / 2.0);
    // The ratio of 20000 draws is known to some 3 %.
    EXPECT_NEAR(2 * mean * mean / (square - mean * mean), degrees, 0.1 * degrees);
}

// The ends of a profile, with the parameter held there by the specification of the model.
TEST(Uncertainty, ProfilesEndWhereChiSquareHasRisen) {
    std::mt19937_64 random(3);
    FitSamples samples =
        withNoise(scansOf("lambert:kd=.4 + ggx:ks=.3,F0=.9,alpha=.3", 8, random), 0.4, random);
    samples.scans.clear();
    FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2};
    options.uncertainty.report = options.uncertainty.profile = true;
    const FitResult result = fit(samples, options);
    const Uncertainty& study = *result.uncertainty;
    ASSERT_EQ(result.parameters[0].name, "ggx.alpha");
    const auto& profile = *study.parameters[0].profile;
    EXPECT_FALSE(profile.quadratic);
    options.uncertainty.profile = false;
    for (const auto& [end, rise] : {std::pair{profile.within68.low, 1.0},
                                    {profile.within68.high, 1.0},
                                    {profile.within95.low, gsl_cdf_chisq_Qinv(0.05, 1)},
                                    {profile.within95.high, gsl_cdf_chisq_Qinv(0.05, 1)}}) {
        ASSERT_TRUE(end);
        options.model = fmt::format("lambert + ggx:F0=.9,alpha={}", *end);
        const Uncertainty held = *fit(samples, options).uncertainty;
        EXPECT_NEAR(held.chiSquare - study.chiSquare, rise, 1e-3 * rise) << *end;
    }
}

// Its line is what a laboratory looks up.
TEST(Uncertainty, ANamedOutlierIsTheValueThatWasSpoilt) {
    std::mt19937_64 random(5);
    FitSamples samples = withNoise(scansOf(linearTruth, 40, random), 0.02, random);
    for (std::size_t k = 0; k < samples.size(); ++k) samples.rows.push_back(100 + k);
    constexpr std::size_t spoilt = 77;
    samples.values[spoilt] += 9 * samples.sigmas[spoilt];
    FitOptions options{.model = "lambert + ggx:F0=.5", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    const FitResult result = fit(samples, options);
    const auto outliers = outliersOf(samples, *result.uncertainty);
    ASSERT_EQ(outliers.size(), 1u);
    EXPECT_EQ(rowOf(samples, outliers[0]), 100 + spoilt);
}

FitResult bootstrapped(const FitSamples& samples, std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2, .starts = 2};
    options.uncertainty.report = true;
    options.uncertainty.bootstrap = 500;
    return fit(samples, options);
}

// A standard deviation of 500 draws is known to 3 %.
TEST(Uncertainty, BootstrapAgreesWithTheSandwichAndNotWithThreads) {
    std::mt19937_64 random(9);
    FitSamples samples =
        withNoise(scansOf("lambert:kd=.4 + ggx:ks=.3,F0=.9,alpha=.3", 100, random), 0.05, random);
    for (const bool scans : {true, false}) {
        if (!scans) samples.scans.clear();
        const FitResult one = bootstrapped(samples, 1), more = bootstrapped(samples, 3);
        for (std::size_t i = 0; i < one.parameters.size(); ++i) {
            const ParameterUncertainty& own = one.uncertainty->parameters[i];
            EXPECT_EQ(own.bootstrap->error, more.uncertainty->parameters[i].bootstrap->error);
            EXPECT_NEAR(own.bootstrap->error / *one.parameters[i].standardError, 1, 0.12)
                << one.parameters[i].name;
            const Interval& within = own.bootstrap->within95;
            EXPECT_NEAR((*within.high - *within.low) / (2 * own.bootstrap->error),
                        gsl_cdf_ugaussian_Qinv(0.025), 0.25);
        }
        EXPECT_EQ(one.uncertainty->bootstrapFailures, 0u);
    }
}

/// The share of intervals of one and of two (1.96) standard errors that hold the truth.
struct Coverage {
    std::size_t within = 0, within2 = 0, count = 0;
    void add(double deviation) {
        ++count;
        within += std::abs(deviation) < 1;
        within2 += std::abs(deviation) < gsl_cdf_ugaussian_Qinv(0.025);
    }
    double one() const { return static_cast<double>(within) / static_cast<double>(count); }
    double two() const { return static_cast<double>(within2) / static_cast<double>(count); }
};

// 200 scans with independent noise of 2 %, a factor of its own for each scan, off by 3 %, and noise
// of 2 % that runs along the scan (correlation 0.8 between neighbours).
TEST(ScanCoverage, OfStatedErrorsIsNominalByScanAndFarOffWithoutScans) {
    constexpr std::size_t repeats = 2000, scans = 200;
    const std::string spec = "lambert:kd=.4 + ggx:ks=.3,F0=.9,alpha=.3";
    std::mt19937_64 random(2026);
    const FitSamples exact = scansOf(spec, scans, random);
    Coverage byScan, sandwich, plain;
    for (std::size_t repeat = 0; repeat < repeats; ++repeat) {
        FitSamples samples = exact;
        double factor = 0, along = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            if (k % scanLength == 0) factor = 0.03 * normal(random), along = normal(random);
            const double f = exact.values[k];
            samples.sigmas.push_back(0.02 * f);
            samples.values[k] += f * (factor + 0.02 * along + 0.02 * normal(random));
            along = 0.8 * along + 0.6 * normal(random);
        }
        FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2, .starts = 1};
        options.uncertainty.report = true;
        const FitResult result = fit(samples, options);
        const double truth[] = {0.3, 0.4, 0.3};
        for (std::size_t i = 0; i < std::size(truth); ++i) {
            const ParameterUncertainty& own = result.uncertainty->parameters[i];
            const double off = result.parameters[i].value - truth[i];
            byScan.add(off / *own.scans);
            sandwich.add(off / *own.sandwich);
            plain.add(off / *own.normal);
        }
    }
    std::printf(
        "coverage of 68.3 %% and 95 %%: by scan %.3f %.3f, sandwich %.3f %.3f, "
        "normal %.3f %.3f\n",
        byScan.one(), byScan.two(), sandwich.one(), sandwich.two(), plain.one(), plain.two());
    EXPECT_GT(byScan.one(), 0.66);
    EXPECT_LT(byScan.one(), 0.70);
    EXPECT_GT(byScan.two(), 0.94);
    EXPECT_LT(byScan.two(), 0.96);
    EXPECT_LT(sandwich.one(), 0.55);
    EXPECT_LT(plain.one(), 0.5);
}

// A model with a parameter too many predicts held-out scans as well; one without the lobe does not.
TEST(ScanRanking, ModelsTieWhereScansDoNotTellThemApart) {
    std::mt19937_64 random(21);
    const FitSamples samples = withNoise(scansOf(linearTruth, 60, random), 0.05, random);
    FitOptions options{.model = "", .loss = Loss::Kind::l2, .starts = 4};
    options.uncertainty.report = true;
    const std::string models[] = {linearModel, "lambert + ggx:F0=.5", "lambert"};
    const std::vector<ModelRank> ranks = compareModels(samples, models, options);
    ASSERT_EQ(ranks.size(), 3u);
    // The wider model has the lower loss; of what the data do not tell apart the simpler is first.
    EXPECT_EQ(ranks[0].model, linearModel);
    EXPECT_FALSE(ranks[0].tied);
    EXPECT_TRUE(ranks[1].tied);
    EXPECT_LT(ranks[0].fit.parameters.size(), ranks[1].fit.parameters.size());
    EXPECT_EQ(ranks[0].simplest, ranks[0].heldOut > ranks[1].heldOut);
    EXPECT_EQ(ranks[2].model, "lambert");
    EXPECT_FALSE(ranks[2].tied);
    for (const ModelRank& rank : ranks) {
        const double terms = static_cast<double>(rank.fit.parameters.size());
        const double count = static_cast<double>(samples.size());
        EXPECT_NEAR(rank.fit.aic, rank.fit.uncertainty->chiSquare + 2 * terms, 1e-6);
        EXPECT_NEAR(rank.fit.bic, rank.fit.uncertainty->chiSquare + terms * std::log(count), 1e-6);
    }
}

TEST(Uncertainty, SubsetsKeepUncertaintiesAndNumberTheirScans) {
    std::mt19937_64 random(2);
    const FitSamples samples = withNoise(scansOf(linearTruth, 5, random), 0.02, random);
    const std::vector<std::size_t> chosen = {3 * scanLength, 3 * scanLength + 2, scanLength + 1};
    const FitSamples few = samples.subset(chosen);
    EXPECT_EQ(few.scans, (std::vector<std::size_t>{0, 0, 1}));
    for (std::size_t i = 0; i < chosen.size(); ++i)
        EXPECT_EQ(few.sigmas[i], samples.sigmas[chosen[i]]);
}

TEST(Uncertainty, StatementsThatDoNotFitAreRefused) {
    std::mt19937_64 random(1);
    FitSamples samples = withNoise(scansOf(linearTruth, 4, random), 0.02, random);
    EXPECT_THROW(fit(samples, {.model = linearModel, .loss = Loss::Kind::cosine}), UsageError);
    EXPECT_THROW(
        fit(samples, {.model = linearModel, .loss = Loss::Kind::l2, .robust = Robust::huber}),
        UsageError);
    // Fewer scans than parameters leave the uncertainties of the samples alone to give errors.
    for (std::size_t& scan : samples.scans) scan /= 2;
    EXPECT_NO_THROW(fit(samples, {.model = linearModel, .loss = Loss::Kind::l2}));
    samples.sigmas.clear();
    EXPECT_THROW(fit(samples, {.model = linearModel, .loss = Loss::Kind::l2}), NumericError);
    for (const char* text : {"2", "x", "2%+", "2%+3%", "1+2", "-2%", "0", "nan%", "2%+0.001+1"}) {
        if (std::string_view(text) == "2")
            EXPECT_EQ(parseSigma(text).absolute, 2);
        else
            EXPECT_THROW(parseSigma(text), UsageError) << text;
    }
    const SigmaStatement both = parseSigma("2%+0.001");
    EXPECT_EQ(both.relative, 0.02);
    EXPECT_EQ(both.absolute, 0.001);
    for (const char* text : {"0", "-1", "1.5", "columns"})
        EXPECT_THROW(parseScans(text), UsageError) << text;
}

}  // namespace
}  // namespace hshfit::brdfs
