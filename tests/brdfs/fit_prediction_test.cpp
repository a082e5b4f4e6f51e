// Errors of the fitted f: against leave-one-out fits by GSL, against fits to resampled data, and by
// their coverage of a known truth.

#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit/scan_spread.h>
#include <brdfs/random_draws.h>
#include <hshfit/linear_algebra/decompositions.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_multifit.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using test::directionBelow, test::normal, test::uniform;

DirectionPair pairFrom(std::mt19937_64& random) {
    const Direction wi = directionBelow(1.3, random);
    const double turn = azimuth(wi) + pi + normal(random);
    return {wi, directionFromAngles(1.3 * uniform(random), turn)};
}

FitSamples samplesOf(const std::string& spec, std::size_t count, std::mt19937_64& random) {
    FitSamples samples;
    samples.isotropic = true;
    samples.origin = SampleOrigin::measured;
    for (std::size_t k = 0; k < count; ++k) {
        const auto [wi, wo] = pairFrom(random);
        samples.wiX.push_back(wi.x);
        samples.wiY.push_back(wi.y);
        samples.wiZ.push_back(wi.z);
        samples.wo.push_back(wo);
        samples.weights.push_back(1);
    }
    samples.values = valuesOf(*open(spec), samples);
    return samples;
}

/// Noise of unequal size, which the fit is told only if `stated`: the sandwich does not mind.
void addNoise(FitSamples& samples, std::mt19937_64& random, bool stated = false) {
    for (double& value : samples.values) {
        const double sigma = 0.004 + 0.03 * value;
        value += sigma * normal(random);
        if (stated) samples.sigmas.push_back(sigma);
    }
}

std::vector<DirectionPair> pairsOf(std::size_t count, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<DirectionPair> pairs;
    for (std::size_t k = 0; k < count; ++k) pairs.push_back(pairFrom(random));
    return pairs;
}

const std::string linearModel = "lambert + ggx:F0=.5,alpha=.3",
                  linearTruth = "lambert:kd=.4 + ggx:ks=.3,F0=.5,alpha=.3";

/// kd and ks by GSL without one sample; `without` beyond the samples: of all.
std::vector<double> linearFit(const FitSamples& samples, std::size_t without) {
    const std::vector<double> diffuse = valuesOf(*open("lambert:kd=1"), samples),
                              lobe = valuesOf(*open("ggx:ks=1,F0=.5,alpha=.3"), samples);
    const std::size_t rows = samples.size() - (without < samples.size() ? 1 : 0);
    gsl_matrix *x = gsl_matrix_alloc(rows, 2), *covariance = gsl_matrix_alloc(2, 2);
    gsl_vector *y = gsl_vector_alloc(rows), *c = gsl_vector_alloc(2);
    std::size_t row = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (k == without) continue;
        gsl_matrix_set(x, row, 0, diffuse[k]);
        gsl_matrix_set(x, row, 1, lobe[k]);
        gsl_vector_set(y, row++, samples.values[k]);
    }
    gsl_multifit_linear_workspace* work = gsl_multifit_linear_alloc(rows, 2);
    double squares = 0;
    gsl_multifit_linear(x, y, c, covariance, &squares, work);
    std::vector<double> result{gsl_vector_get(c, 0), gsl_vector_get(c, 1)};
    gsl_multifit_linear_free(work);
    gsl_matrix_free(x), gsl_matrix_free(covariance), gsl_vector_free(y), gsl_vector_free(c);
    return result;
}

// f without sample i differs from f by g (X^T X)^-1 x_i r_i / (1 - h_i), so that HC3's variance of
// a linear fit is the sum of squares of these differences.
TEST(Prediction, ErrorsOfLinearFitsAreThoseOfLeaveOneOutFits) {
    std::mt19937_64 random(3);
    FitSamples samples = samplesOf(linearTruth, 60, random);
    addNoise(samples, random);
    const FitResult result = fit(samples, {.model = linearModel, .loss = Loss::Kind::l2});
    const std::vector<DirectionPair> pairs = pairsOf(7, 9);
    const Prediction prediction = predict(result, pairs);
    ASSERT_EQ(prediction.channels, 1u);
    const std::vector<double> all = linearFit(samples, samples.size());
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const double diffuse = evaluate(*open("lambert:kd=1"), pairs[k].wi, pairs[k].wo)[0];
        const double lobe = evaluate(*open("ggx:ks=1,F0=.5,alpha=.3"), pairs[k].wi, pairs[k].wo)[0];
        EXPECT_NEAR(prediction.values[k], all[0] * diffuse + all[1] * lobe, 1e-9);
        double variance = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const std::vector<double> one = linearFit(samples, i);
            variance += std::pow((one[0] - all[0]) * diffuse + (one[1] - all[1]) * lobe, 2);
        }
        EXPECT_NEAR(prediction.errors[k], std::sqrt(variance), 1e-6 * std::sqrt(variance));
    }
}

// The parameters of both terms have no error, and f has the same error as by one term alone.
TEST(Prediction, HasAnErrorWhereTheDataDoNotTellParametersApart) {
    std::mt19937_64 random(5);
    FitSamples samples = samplesOf("lambert:kd=.5", 80, random);
    addNoise(samples, random);
    const FitResult two = fit(samples, {.model = "lambert + lambert", .loss = Loss::Kind::l2}),
                    one = fit(samples, {.model = "lambert", .loss = Loss::Kind::l2});
    ASSERT_FALSE(two.ambiguous.empty());
    const std::vector<DirectionPair> pairs = pairsOf(3, 2);
    const Prediction a = predict(two, pairs), b = predict(one, pairs);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        EXPECT_GT(b.errors[k], 0);
        EXPECT_NEAR(a.errors[k], b.errors[k], 1e-6 * b.errors[k]);
    }
}

TEST(Prediction, BootstrapAndLinearisedErrorsAgree) {
    std::mt19937_64 random(8);
    FitSamples samples = samplesOf("lambert:kd=.3 + ggx:ks=.4,F0=.5,alpha=.25", 400, random);
    samples.channels = Channels::spectral({500, 600});
    const std::vector<double> first = samples.values;
    samples.values.insert(samples.values.end(), first.begin(), first.end());
    addNoise(samples, random);
    for (const bool perChannel : {false, true}) {
        FitOptions options{.model = "lambert + ggx:F0=.5",
                           .loss = Loss::Kind::l2,
                           .perChannel = perChannel,
                           .starts = 4};
        options.uncertainty.report = true;
        options.uncertainty.bootstrap = 400;
        const FitResult result = fit(samples, options);
        const std::vector<DirectionPair> pairs = pairsOf(12, 4);
        const Prediction prediction = predict(result, pairs);
        ASSERT_TRUE(prediction.bootstrap);
        ASSERT_EQ(prediction.channels, 2u);
        for (std::size_t v = 0; v < prediction.values.size(); ++v) {
            // 400 draws give a standard deviation to 1 / sqrt(800), 3.5 %.
            const double ratio = prediction.bootstrap->errors[v] / prediction.errors[v];
            EXPECT_NEAR(ratio, 1, 0.2) << v << " " << perChannel;
            EXPECT_LT(*prediction.bootstrap->within95[v].low, prediction.values[v]);
            EXPECT_GT(*prediction.bootstrap->within95[v].high, prediction.values[v]);
        }
    }
}

// With one coefficient all pairs change together; with two, Scheffe's factor is that for all
// pairs that there are.
TEST(Prediction, SimultaneousFactorLiesBetweenThatOfOnePairAndScheffes) {
    std::mt19937_64 random(6);
    FitSamples samples = samplesOf(linearTruth, 100, random);
    addNoise(samples, random);
    const std::vector<DirectionPair> pairs = pairsOf(200, 4);
    EXPECT_NEAR(Prediction::pointwise(0.95), gsl_cdf_ugaussian_Pinv(0.975), 1e-12);
    EXPECT_NEAR(Prediction::pointwise(0.95, 7), gsl_cdf_tdist_Pinv(0.975, 7), 1e-12);
    const FitResult one =
        fit(samples, {.model = "lambert + ggx:F0=.5,alpha=.3,ks=.3", .loss = Loss::Kind::l2});
    const double ofOne = simultaneousFactor(one, pairs, 0.95, 1, 40000);
    EXPECT_NEAR(ofOne, predict(one, pairs).widest(0.95), 0.03);
    const FitResult two = fit(samples, {.model = linearModel, .loss = Loss::Kind::l2});
    const double ofTwo = simultaneousFactor(two, pairs, 0.95, 1, 40000);
    const double degrees = std::ranges::min(predict(two, pairs).degrees),
                 scheffe = std::sqrt(2 * gsl_cdf_fdist_Pinv(0.95, 2, degrees));
    EXPECT_GT(ofTwo, gsl_cdf_tdist_Pinv(0.975, degrees) + 0.1);
    EXPECT_LT(ofTwo, scheffe + 0.03);
}

// With equal weights and one column of ones all N values decide alike: N - 1 degrees of freedom. A
// value with a leverage near 1 decides alone.
TEST(Prediction, DegreesOfFreedomAreThoseOfTheValuesThatDecide) {
    constexpr Eigen::Index count = 12;
    Eigen::MatrixXd rows = Eigen::MatrixXd::Ones(count, 1), of = Eigen::MatrixXd::Ones(1, 1);
    Eigen::MatrixXd inverse = (rows.transpose() * rows).inverse();
    EXPECT_NEAR(valueDegrees(rows, inverse, of)[0], count - 1, 1e-9);
    std::vector<ScanSums> scans;
    rows = Eigen::MatrixXd::Random(count, 3);
    for (Eigen::Index k = 0; k < count; ++k)
        scans.push_back({rows.row(k).transpose() * rows.row(k), Eigen::VectorXd::Zero(3)});
    inverse = (rows.transpose() * rows).inverse();
    of = Eigen::MatrixXd::Random(5, 3);
    const std::vector<double> byValue = valueDegrees(rows, inverse, of),
                              byScan = scanDegrees(scans, inverse, of);
    for (std::size_t i = 0; i < byValue.size(); ++i) EXPECT_NEAR(byValue[i], byScan[i], 1e-9);
    rows.row(0) *= 1e4;
    inverse = (rows.transpose() * rows).inverse();
    EXPECT_NEAR(valueDegrees(rows, inverse, rows.topRows(1))[0], 1, 0.01);
}

/// The shares of data sets with known truth whose bands hold it.
struct Coverage {
    double within68 = 0, within95 = 0, all95 = 0;
    double byNormal95 = 0;  ///< of f -+ 1.96 errors
};

const double oneSigma = std::erf(std::sqrt(0.5));

/// Cuts samples into scans, each of them with its own factor.
void addScans(FitSamples& samples, std::size_t count, std::mt19937_64& random) {
    std::vector<double> factors;
    for (std::size_t s = 0; s < count; ++s) factors.push_back(1 + 0.03 * normal(random));
    for (std::size_t k = 0; k < samples.size(); ++k) {
        samples.scans.push_back(k * count / samples.size());
        samples.values[k] *= factors[samples.scans.back()];
    }
}

/// `scans`: so many, each with an error of 3 % in its scale; 0: none.
Coverage coverageOf(std::size_t draws, std::size_t values, bool stated, std::size_t scans = 0) {
    const std::string truth = "lambert:kd=.3 + ggx:ks=.4,F0=.5,alpha=.25";
    constexpr std::size_t count = 16;
    const std::vector<DirectionPair> pairs = pairsOf(count, 12);
    std::vector<double> expected;
    for (const DirectionPair& pair : pairs)
        expected.push_back(evaluate(*open(truth), pair.wi, pair.wo)[0]);
    std::atomic<std::size_t> within68 = 0, within95 = 0, all95 = 0, widest = 0;
    tbb::parallel_for(std::size_t{0}, draws, [&](std::size_t d) {
        std::mt19937_64 random(d + 100);
        FitSamples samples = samplesOf(truth, values, random);
        addNoise(samples, random, stated);
        if (scans > 0) addScans(samples, scans, random);
        const FitResult result =
            fit(samples, {.model = "lambert + ggx:F0=.5", .loss = Loss::Kind::l2, .starts = 1});
        const Prediction prediction = predict(result, pairs);
        const double factor = simultaneousFactor(result, pairs, 0.95, 1, 1000);
        double most = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const double z = std::abs(prediction.values[k] - expected[k]) / prediction.errors[k];
            within68 += z < Prediction::pointwise(oneSigma, prediction.degrees[k]);
            within95 += z < Prediction::pointwise(0.95, prediction.degrees[k]);
            widest += z < Prediction::pointwise(0.95);
            most = std::max(most, z);
        }
        all95 += most < factor;
    });
    const double all = static_cast<double>(draws);
    const Coverage shares{static_cast<double>(within68) / (all * count),
                          static_cast<double>(within95) / (all * count),
                          static_cast<double>(all95) / all,
                          static_cast<double>(widest) / (all * count)};
    for (const auto& [name, share] : {std::pair{"within68", shares.within68},
                                      {"within95", shares.within95},
                                      {"all95", shares.all95},
                                      {"byNormal95", shares.byNormal95}})
        testing::Test::RecordProperty(name, std::to_string(share));
    return shares;
}

// Binomial errors of the shares are at most the errors by as many independent values as there are
// sets, 0.010 and 0.005: values at the pairs of one set are correlated.
TEST(PredictionCoverage, BandsHoldTheTruthAtTheirStatedRates) {
    const Coverage shares = coverageOf(2000, 400, true);
    EXPECT_NEAR(shares.within68, 0.68, 0.02);
    EXPECT_NEAR(shares.within95, 0.95, 0.01);
    // By the fewest degrees of freedom among the pairs: rather too wide.
    EXPECT_GT(shares.all95, 0.95 - 0.015);
    EXPECT_LT(shares.all95, 0.98);
}

// Without stated noise few values of the peak determine most of the loss, so that their variance
// is known to few degrees of freedom.
TEST(PredictionCoverage, OfUnstatedNoiseTheyHoldByStudentsDistribution) {
    const Coverage shares = coverageOf(1000, 1000, false);
    EXPECT_NEAR(shares.within68, 0.68, 0.03);
    EXPECT_NEAR(shares.within95, 0.95, 0.015);
    EXPECT_NEAR(shares.all95, 0.95, 0.03);
}

// Twelve scans are few: normal bands hold the truth too seldom.
TEST(PredictionCoverage, OfFewScansTheyHoldByStudentsDistribution) {
    const Coverage shares = coverageOf(1000, 480, true, 12);
    EXPECT_NEAR(shares.within68, 0.68, 0.03);
    EXPECT_NEAR(shares.within95, 0.95, 0.015);
    EXPECT_NEAR(shares.all95, 0.95, 0.03);
    EXPECT_LT(shares.byNormal95, shares.within95 - 0.01);
}

}  // namespace
}  // namespace hshfit::brdfs
