// Few measurements against a library whose materials are known sums of terms.

#include <hshfit/error.h>
#include <hshfit/material_library/few_samples.h>
#include <hshfit/material_library/log_terms.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace hshfit::material_library {
namespace {

const LogSpace& space() {
    static const LogSpace one;
    return one;
}

LogMaterial mixed(double a, double b, double c) {
    LogMaterial material{std::vector<double>(logTerms().size(), 0.0), {20.0}};
    material.exponents[40] = a;
    material.exponents[60] = b;
    material.exponents[5] = c;
    return material;
}

class FewSamples : public testing::Test {
protected:
    /// Thirty materials of three normal numbers, learned once.
    static const Library& learned() {
        static const Library library = [] {
            std::mt19937 random(1);
            std::normal_distribution<double> number(0, 0.3);
            std::vector<Measured> all;
            for (int n = 0; n < 30; ++n) {
                const double a = number(random), b = number(random), c = number(random);
                all.push_back(space().project(LogBrdf(mixed(a, b, c), "made"),
                                              "m" + std::to_string(100 + n), "made"));
            }
            return learn(space(), std::move(all), {}, {.components = 3, .bytes = 24},
                         {.log = 0.3, .maximum = 10, .flip = 1});
        }();
        return library;
    }
    /// f at pairs spread over the hemispheres, with relative errors of `sigma`.
    static std::vector<Observation> observed(const Brdf& brdf, std::size_t count, double sigma,
                                             unsigned seed) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> angle(0, 1.3), turn(0, pi);
        std::normal_distribution<double> error(0, sigma);
        std::vector<Observation> all;
        for (std::size_t k = 0; k < count; ++k) {
            const DirectionPair pair{directionFromAngles(angle(random), 0),
                                     directionFromAngles(angle(random), turn(random))};
            const double f = evaluate(brdf, pair.wi, pair.wo)[0];
            all.push_back({pair, {f * (1 + error(random))}, {sigma * f}});
        }
        return all;
    }

    const Library& library_ = learned();
};

TEST_F(FewSamples, ThreeNumbersComeBackFromTwelveSamples) {
    const LogBrdf truth(mixed(0.3, -0.2, 0.25), "truth");
    Posterior posterior(space(), library_);
    const double before = posterior.expectedError();
    const Agreement agreement = posterior.observe(observed(truth, 12, 0.005, 2));
    EXPECT_TRUE(agreement.known);
    EXPECT_EQ(agreement.degreesOfFreedom, 12u);
    EXPECT_LT(posterior.expectedError(), before / 3);
    EXPECT_LT(formError(truth, LogBrdf(posterior.material(), "found"), errorPairs()).logError,
              0.06);
}

TEST_F(FewSamples, AStrangerIsNotKnown) {
    LogMaterial strange = mixed(0, 0, 0);
    strange.exponents[90] = 1.5;
    strange.exponents[20] = -2;
    Posterior posterior(space(), library_);
    EXPECT_FALSE(posterior.observe(observed(LogBrdf(strange, "strange"), 20, 0.005, 3)).known);
}

TEST_F(FewSamples, BandsOfOneDeviationHoldTwoThirdsOfTheTruth) {
    std::mt19937 random(4);
    std::normal_distribution<double> number(0, 0.3);
    std::size_t inside = 0, all = 0;
    for (unsigned n = 0; n < 40; ++n) {
        const double a = number(random), b = number(random), c = number(random);
        const LogBrdf truth(mixed(a, b, c), "truth");
        Posterior posterior(space(), library_);
        posterior.observe(observed(truth, 3, 0.02, 100 + n));
        for (const Observation& at : observed(truth, 20, 0, 200 + n)) {
            const Band band = posterior.bands(std::vector{at.pair}).front();
            inside += at.values[0] >= band.low[0] && at.values[0] <= band.high[0];
            ++all;
        }
    }
    const double share = static_cast<double>(inside) / static_cast<double>(all);
    EXPECT_GT(share, 0.55);
    EXPECT_LT(share, 0.85);
}

/// A material of twelve normal numbers of falling spread.
LogMaterial many(std::mt19937& random) {
    std::normal_distribution<double> number;
    LogMaterial material = mixed(0, 0, 0);
    for (std::size_t n = 0; n < 12; ++n)
        material.exponents[20 + 11 * n] = 0.3 * number(random) / static_cast<double>(n + 1);
    return material;
}

TEST_F(FewSamples, BandsHoldTwoThirdsWhereTheBasisIsTooSmallAndSamplesAreInOnePlane) {
    std::mt19937 random(5);
    std::vector<Measured> all;
    for (int n = 0; n < 40; ++n)
        all.push_back(
            space().project(LogBrdf(many(random), "made"), "m" + std::to_string(100 + n), "made"));
    const Library library = learn(space(), std::move(all), {}, {.components = 3, .bytes = 24},
                                  {.log = 10, .maximum = 10, .flip = 1});
    Posterior posterior(space(), library);
    std::size_t inside = 0, checked = 0, known = 0;
    std::uniform_real_distribution<double> angle(-1.3, 1.3);
    std::normal_distribution<double> error(0, 0.02);
    for (unsigned n = 0; n < 40; ++n) {
        const LogBrdf truth(many(random), "truth");
        std::vector<Observation> samples;
        for (int k = 0; k < 20; ++k) {
            const DirectionPair pair{directionFromAngles(std::abs(angle(random)), 0),
                                     directionFromAngles(angle(random), 0)};
            const double f = evaluate(truth, pair.wi, pair.wo)[0];
            samples.push_back({pair, {f * (1 + error(random))}, {0.02 * f}});
        }
        known += posterior.observe(samples).known;
        for (const Observation& at : observed(truth, 40, 0, 300 + n)) {
            const Band band = posterior.bands(std::vector{at.pair}).front();
            inside += at.values[0] >= band.low[0] && at.values[0] <= band.high[0];
            ++checked;
        }
    }
    EXPECT_NEAR(static_cast<double>(inside) / static_cast<double>(checked), 0.68, 0.07);
    EXPECT_GE(known, 36u);
}

TEST_F(FewSamples, AFinalLibraryHasItsMaterialsFromTheirCodes) {
    Library final = library_;
    final.measured.clear();
    const LogBrdf truth(mixed(0.3, -0.2, 0.25), "truth");
    Posterior posterior(space(), final);
    EXPECT_TRUE(posterior.observe(observed(truth, 12, 0.005, 2)).known);
    EXPECT_LT(formError(truth, LogBrdf(posterior.material(), "found"), errorPairs()).logError,
              0.06);
}

TEST_F(FewSamples, ExpectedErrorsFallAndAreThoseAfterTheMeasurement) {
    const Posterior prior(space(), library_);
    const std::vector<NextPair> pairs = prior.next({.count = 6});
    ASSERT_EQ(pairs.size(), 6u);
    double before = prior.expectedError();
    std::vector<Observation> observations;
    for (const NextPair& next : pairs) {
        EXPECT_LT(next.expectedError, before);
        before = next.expectedError;
        const Band mean = prior.bands(std::vector{next.pair}).front();
        std::vector<double> sigmas;
        for (const double f : mean.value) sigmas.push_back(0.02 * f);
        observations.push_back({next.pair, mean.value, sigmas});
    }
    Posterior after(space(), library_);
    after.observe(observations);
    EXPECT_NEAR(after.expectedError(), before, 0.02 * before);
    EXPECT_GT(prior.next({.count = 6, .inPlane = true}).back().expectedError, 0.9 * before);
    for (const NextPair& next : prior.next({.count = 4, .inPlane = true}))
        EXPECT_NEAR(std::sin(azimuth(next.pair.wo)), 0, 1e-9);
}

TEST_F(FewSamples, TooSmallLibrariesAndNoSamplesAreRefused) {
    Posterior posterior(space(), library_);
    EXPECT_THROW(posterior.observe({}), UsageError);
    Library small = library_;
    small.measured.resize(2);
    EXPECT_THROW(Posterior(space(), small), InputError);
}

}  // namespace
}  // namespace hshfit::material_library
