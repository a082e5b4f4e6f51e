// Coordinates from f at a few pairs, against materials whose coordinates are known, and the errors
// of rounding that many materials share the work of, against errors of one material at a time.

#include <hshfit/material_library/internal/rounding_errors.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/pair_fit.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::material_library {
namespace {

/// Three components that are sums of a few terms, and a mean of f = e^-2.
Basis basis() {
    const std::size_t terms = logTerms().size();
    Basis made{.mean = std::vector<double>(terms, 0.0),
               .components = std::vector<double>(3 * terms, 0.0),
               .widths = {8, 8, 8},
               .step = 0.01};
    std::vector<double> here(terms), there(terms);
    logTerms().evaluate({0, 0, 1}, {0, 0, 1}, here.data());
    logTerms().evaluate(directionFromAngles(1.4, 2), directionFromAngles(0.9, 0), there.data());
    for (std::size_t t = 0; t < terms; ++t)
        if (here[t] == 1 && there[t] == 1) made.mean[t] = -2;  // the constant
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t n = 0; n < 4; ++n)
            made.components[k * terms + 40 + 5 * k + n] = n % 2 == 0 ? 1 : -0.5;
    return made;
}

std::vector<float> valuesOf(const LogMaterial& material) {
    const std::vector<double> f = evaluateOn(LogBrdf(material, "made"), fitPairs());
    return {f.begin(), f.end()};
}

TEST(PairFit, FindsTheCoordinatesAndBoundsThatAMaterialHas) {
    const Basis three = basis();
    const PairFit fit(three);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-20, 20);
    for (int trial = 0; trial < 8; ++trial) {
        const double numbers[] = {number(random), number(random), number(random), 120};
        const std::vector<float> f = valuesOf(fromNumbers(three, numbers, 1));
        double found[4];
        fit.fit(f.data(), found);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], numbers[k], 0.01) << k;
        // No value is beyond the bound, which would hide coordinates.
        EXPECT_LT(*std::ranges::max_element(f), 5);
        // The least code that is above all values.
        const double most = std::log(*std::ranges::max_element(f) + logOffset);
        EXPECT_GE(std::log(logOffset) + found[3] / topsPerLog, most - 1e-6);
        EXPECT_LT(std::log(logOffset) + (found[3] - 1) / topsPerLog, most);
        const PairFit::Squares none = fit.squares(f.data(), found);
        EXPECT_LT(none.difference, 1e-6 * none.value);
        // A wrong number shows in the error by the derivative of f.
        found[0] += 10;
        EXPECT_GT(fit.squares(f.data(), found).difference, 1e-3 * none.value);
    }
}

TEST(PairFit, PairsAddUpToBothHemispheresAndSeeTheMirrorDirection) {
    const PairSample& pairs = fitPairs();
    double sum = 0;
    for (const double weight : pairs.weights) sum += weight;
    EXPECT_NEAR(sum, 1, 1e-12);
    for (std::size_t k = pairs.size() - 32; k < pairs.size(); ++k) {
        const Direction wi = pairs.incoming(k), wo = pairs.outgoing(k);
        EXPECT_EQ(pairs.weights[k], 0);
        EXPECT_NEAR(wi.x + wo.x, 0, 1e-15);
        EXPECT_EQ(wi.z, wo.z);
    }
}

TEST(PairFit, BlackIsExact) {
    const PairFit fit(basis());
    const std::vector<float> f(fitPairs().size(), 0.0F);
    double found[4];
    fit.fit(f.data(), found);
    EXPECT_EQ(found[3], 0);
    EXPECT_LT(fit.squares(f.data(), found).difference, 1e-30);
}

TEST(PairFit, FarthestBeginsFarFromTheMeanAndTakesNoMaterialTwice) {
    const std::size_t size = fitPairs().size();
    std::vector<float> values;
    for (const float level : {0.1F, 0.11F, 0.1F, 4.0F, 0.5F})
        values.insert(values.end(), size, level);
    EXPECT_EQ(farthest(values, 5, 2), (std::vector<std::size_t>{3, 0}));
    const std::vector<std::size_t> all = farthest(values, 5, 5);
    EXPECT_EQ(all.size(), 4u);  // two are alike
    EXPECT_EQ(all[2], 4u);
}

TEST(RoundingErrors, AreThoseOfOneMaterialAtATime) {
    const Basis three = basis();
    std::mt19937 random(6);
    std::uniform_real_distribution<double> number(-60, 60);
    std::normal_distribution<float> off(0.0F, 0.05F);
    std::vector<Measured> measured;
    std::vector<std::vector<std::uint8_t>> codes;
    for (const std::size_t channels : {1, 3, 3}) {
        std::vector<double> numbers;
        for (std::size_t c = 0; c < channels; ++c)
            for (int k = 0; k < 4; ++k) numbers.push_back(k < 3 ? number(random) : 70);
        const LogMaterial exact = fromNumbers(three, numbers.data(), channels);
        Measured one{.name = "a", .source = "made", .exponents = {}, .tops = {}};
        for (const double e : exact.exponents) one.exponents.push_back(static_cast<float>(e));
        for (std::size_t t = 60; t < 80; ++t) one.exponents[t] += off(random);
        one.tops.assign(channels, static_cast<float>(exact.tops[0]));
        measured.push_back(one);
        codes.emplace_back();
        for (std::size_t c = 0; c < channels; ++c) {
            std::vector<double> coordinates;
            for (std::size_t k = 0; k < 3; ++k)
                coordinates.push_back(three.step * numbers[4 * c + k]);
            const auto packed = pack(three, coordinates, exact.tops[c]);
            codes.back().insert(codes.back().end(), packed.begin(), packed.end());
        }
    }
    std::vector<RoundedMaterial> together;
    for (std::size_t m = 0; m < 3; ++m) together.push_back({measured[m], codes[m]});
    const std::vector<FormError> found = RoundingErrors(three).of(together);
    for (std::size_t m = 0; m < 3; ++m) {
        const FormError expected = formError(LogBrdf(measured[m].material(), "f"),
                                             LogBrdf(decode(three, codes[m]), "g"), errorPairs());
        EXPECT_GT(expected.logError, 1e-4);
        EXPECT_NEAR(found[m].meanLog, expected.meanLog, 1e-3 * expected.meanLog);
        EXPECT_NEAR(found[m].logError, expected.logError, 1e-3 * expected.logError);
        EXPECT_NEAR(found[m].relativeL2, expected.relativeL2, 1e-3 * expected.relativeL2);
        EXPECT_NEAR(found[m].maximum, expected.maximum, 1e-3 * expected.maximum);
        EXPECT_NEAR(found[m].largest, expected.largest, 1e-4 * expected.largest);
    }
}

}  // namespace
}  // namespace hshfit::material_library
