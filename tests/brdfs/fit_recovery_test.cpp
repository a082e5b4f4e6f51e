// Fits recover the parameters of synthetic data within the stated errors, at the rate that
// these imply, or report that the data do not determine them.
#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <hshfit/error.h>

#include "measured_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

struct Drawn {
    std::string name;
    double low, high;
    bool logarithmic = false;
};

/// A model, and where its parameters are drawn from. Colours are drawn grey.
struct Case {
    const char* model;
    std::vector<Drawn> parameters;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.model;
}

const Case cases[] = {
    {"lambert", {{"kd", 0.02, 0.95}}},
    {"minnaert", {{"kd", 0.02, 0.95}, {"k", 0.3, 2}}},
    {"blinn-phong", {{"kd", 0.02, 0.9}, {"ks", 0.05, 2}, {"exponent", 4, 2e3, true}}},
    {"phong", {{"kd", 0.02, 0.9}, {"ks", 0.05, 2}, {"exponent", 4, 300, true}}},
    {"ward", {{"kd", 0.02, 0.9}, {"ks", 0.02, 0.6}, {"ax", 0.02, 0.5, true}}},
    {"ggx", {{"kd", 0.02, 0.9}, {"F0", 0.02, 0.9}, {"alpha", 0.02, 0.7, true}}},
    {"beckmann", {{"kd", 0.02, 0.9}, {"F0", 0.02, 0.9}, {"alpha", 0.03, 0.6, true}}},
    {"cook-torrance",
     {{"kd", 0.02, 0.9}, {"ks", 0.1, 1}, {"F0", 0.02, 0.6}, {"m", 0.03, 0.5, true}}},
    {"abc:variant=microfacet",
     {{"kd", 0.02, 0.9}, {"A", 1, 50}, {"B", 50, 1e4, true}, {"C", 0.6, 2}, {"ior", 1.2, 2}}},
    {"sg", {{"kd", 0.02, 0.9}, {"ks", 0.05, 2}, {"sharpness", 4, 300, true}}},
};

class Recovery : public testing::TestWithParam<Case> {
protected:
    struct Truth {
        std::string spec;
        std::vector<std::pair<std::string, double>> values;
    };
    Truth draw(std::mt19937_64& random) const {
        Truth truth{GetParam().model, {}};
        char separator = truth.spec.find(':') == std::string::npos ? ':' : ',';
        for (const Drawn& p : GetParam().parameters) {
            const double share = static_cast<double>(random() >> 11) * 0x1p-53;
            const double value = p.logarithmic ? p.low * std::pow(p.high / p.low, share)
                                               : p.low + share * (p.high - p.low);
            truth.spec += fmt::format("{}{}={}", separator, p.name, value);
            separator = ',';
            truth.values.emplace_back(p.name, value);
            if (p.name == "ax") truth.spec += fmt::format(",ay={}", value);
        }
        return truth;
    }
    /// Samples of the truth, by everyone's own directions, with relative noise.
    static FitSamples samplesOf(const Truth& truth, double noise, std::mt19937_64& random) {
        FitSamples samples = gatherSamples(*open(truth.spec), {}).drawn(3000, random());
        std::normal_distribution<double> normal;
        for (double& value : samples.values) value *= 1 + noise * normal(random);
        return samples;
    }
    static const FittedParameter& find(const FitResult& result, const std::string& name) {
        for (const FittedParameter& parameter : result.parameters)
            if (parameter.name == name) return parameter;
        throw std::logic_error(name);
    }
};

TEST_P(Recovery, IsExactWithoutNoise) {
    std::mt19937_64 random(5);
    for (int trial = 0; trial < 3; ++trial) {
        const Truth truth = draw(random);
        const FitSamples samples = samplesOf(truth, 0, random);
        const FitResult result = fit(samples, {.model = GetParam().model});
        EXPECT_TRUE(result.converged) << truth.spec << " " << result.message;
        for (const auto& [name, value] : truth.values) {
            const FittedParameter& parameter = find(result, name);
            // Kept within what rounding leaves open, and that is little.
            if (parameter.standardError) {
                EXPECT_LE(std::abs(parameter.value - value), 4 * *parameter.standardError)
                    << name << " of " << truth.spec;
                EXPECT_LT(*parameter.standardError, 1e-5 * (value + 0.01)) << truth.spec;
            }
        }
        EXPECT_TRUE(result.ambiguous.empty()) << truth.spec;
    }
}

// z = (fitted - true) / standard error is normal: of N values the share beyond 2 is 4.6 %. The sum
// of z^2 over all trials is chi-square with about N degrees of freedom; parameters of one trial
// correlate, so that trials and not parameters are counted: the bound holds for each parameter by
// itself.
TEST_P(Recovery, ErrorsAreAsStatedWithNoise) {
    std::mt19937_64 random(17);
    constexpr int trials = 24;
    std::vector<double> squares(GetParam().parameters.size(), 0.0);
    std::vector<int> counted(squares.size(), 0);
    for (int trial = 0; trial < trials; ++trial) {
        const Truth truth = draw(random);
        const FitResult result =
            fit(samplesOf(truth, 0.05, random), {.model = GetParam().model, .starts = 6});
        EXPECT_TRUE(result.converged) << truth.spec << " " << result.message;
        for (std::size_t i = 0; i < truth.values.size(); ++i) {
            const auto& [name, value] = truth.values[i];
            const FittedParameter& parameter = find(result, name);
            if (!parameter.standardError) continue;  // at a bound, or ambiguous and said so
            const double z = (parameter.value - value) / *parameter.standardError;
            // Normal beyond 5: one in 1.7 million.
            EXPECT_LT(std::abs(z), 5) << name << " of " << truth.spec;
            squares[i] += z * z;
            ++counted[i];
        }
    }
    for (std::size_t i = 0; i < squares.size(); ++i) {
        ASSERT_GE(counted[i], trials * 3 / 4) << GetParam().parameters[i].name;
        // Chi-square of n degrees: mean n, deviation sqrt(2 n); four deviations either way, and
        // a tenth for what the errors themselves err by.
        const double n = counted[i], four = 4 * std::sqrt(2 * n);
        EXPECT_LT(squares[i], 1.1 * (n + four)) << GetParam().parameters[i].name;
        EXPECT_GT(squares[i], 0.9 * (n - four)) << GetParam().parameters[i].name;
    }
}

INSTANTIATE_TEST_SUITE_P(Models, Recovery, testing::ValuesIn(cases));

FitSamples constantSamples() {
    FitSamples samples = gatherSamples(*open("lambert:kd=.5"), {}).drawn(500, 1);
    return samples;
}

TEST(Degenerate, ConstantDataLeaveTheShapeOpen) {
    const FitResult result = fit(constantSamples(), {.model = "blinn-phong"});
    // Either ks is at 0, and then the exponent is undetermined, or the exponent is, and then the
    // lobe is as constant as kd.
    EXPECT_FALSE(result.ambiguous.empty()) << result.spec;
    EXPECT_LT(result.loss, 1e-6);
    for (const FittedParameter& parameter : result.parameters)
        if (parameter.name == "exponent" && parameter.bound.empty()) {
            EXPECT_FALSE(parameter.standardError);
        }
}

TEST(Degenerate, DarkDataAreFittedByNothing) {
    FitSamples samples = constantSamples();
    std::fill(samples.values.begin(), samples.values.end(), 0.0);
    const FitResult result = fit(samples, {.model = "ward"});
    for (const FittedParameter& parameter : result.parameters)
        if (parameter.linear) {
            EXPECT_EQ(parameter.value, 0);
            EXPECT_EQ(parameter.bound, "lower");
        }
    EXPECT_FALSE(result.ambiguous.empty());
}

TEST(Degenerate, OneDarkChannelLeavesTheOthers) {
    FitSamples samples =
        gatherSamples(*open("ward:kd=.1/.2/.3,ks=.1/.2/.3,ax=.2,ay=.2"), {}).drawn(2000, 1);
    std::fill_n(samples.values.begin() + static_cast<std::ptrdiff_t>(samples.size()),
                samples.size(), 0.0);
    const FitResult result = fit(samples, {.model = "ward"});
    ASSERT_TRUE(result.converged);
    for (const FittedParameter& parameter : result.parameters) {
        if (parameter.channel == "G") {
            EXPECT_EQ(parameter.value, 0) << parameter.name;
        }
        if (parameter.name == "ax") {
            EXPECT_NEAR(parameter.value, 0.2, 1e-6);
        }
        if (parameter.name == "ks" && parameter.channel == "B") {
            EXPECT_NEAR(parameter.value, 0.3, 1e-6);
        }
    }
}

TEST(Degenerate, OneSampleIsTooFew) {
    EXPECT_THROW(fit(constantSamples().subset({7}), {.model = "ward"}), NumericError);
}

TEST(Degenerate, NothingLeftToFitIsAnError) {
    EXPECT_THROW(gatherSamples(*open("lambert"), {.grazingCut = 0}), NumericError);
    EXPECT_THROW(fit(constantSamples(), {.model = "lambert:kd=.2"}), UsageError);
    EXPECT_THROW(fit(constantSamples(), {.model = "lambret"}), UsageError);
    EXPECT_THROW(fit(constantSamples(), {.model = "ward:axe=1"}), UsageError);
}

TEST(Degenerate, ShapesPerChannelNeedAScale) {
    const FitSamples samples =
        gatherSamples(
            *open("lambert:kd=.1/.2/.3 + ggx:ks=.3/0/0,alpha=.1 + ggx:ks=0/.5/.7,alpha=.3"), {})
            .drawn(900, 1);
    EXPECT_THROW(
        fit(samples, {.model = "disney:clearcoat=0,sheen=0", .perChannel = true, .starts = 2}),
        UsageError);
    const FitResult result = fit(samples, {.model = "ggx", .perChannel = true});
    for (const FittedParameter& parameter : result.parameters)
        if (parameter.name == "alpha") {
            EXPECT_NEAR(parameter.value, parameter.channel == "R" ? 0.1 : 0.3, 1e-5)
                << parameter.channel;
        }
}

// Cells that are no numbers, or marked as invalid, within good data are left out and counted: at
// theta_h = 0 every cell is above the horizon.
TEST(Degenerate, NumbersThatAreNoneAreMaskedAndCounted) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const test::TemporaryFile file(test::merlFile([&](int c, int h, int d, int p) {
                                       if (h == 0 && d >= 10 && d < 20 && p == 7)
                                           return c == 1 ? nan : 2.0;
                                       if (h == 0 && d >= 30 && d < 33 && p == 9)
                                           return std::numeric_limits<double>::infinity();
                                       return h == 0 && d == 40 && p < 5 ? -1.0 : 2;
                                   }),
                                   ".binary");
    const FitSamples samples = gatherSamples(*open(file.path()), {});
    EXPECT_EQ(samples.masked.notFinite, 13u);
    EXPECT_EQ(samples.masked.invalid, 5u);
    EXPECT_EQ(samples.size() + samples.masked.belowHorizon + 18, 90u * 90 * 180);
    const FitResult result = fit(samples, {.model = "lambert"});
    ASSERT_TRUE(result.converged);
    const double scales[] = {1, 1.15, 1.66};  // Matusik et al. 2003: of R, G and B over 1500
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(result.parameters[c].value, pi * 2 * scales[c] / 1500, 1e-9);
}

// Twice the same lobe: which of the two is which cannot be told.
TEST(Ambiguity, TwoEqualTermsAreReported) {
    const FitSamples samples = gatherSamples(*open("lambert:kd=.3"), {}).drawn(500, 1);
    const FitResult result = fit(samples, {.model = "lambert+oren-nayar:sigma=0"});
    ASSERT_EQ(result.ambiguous.size(), 1u);
    EXPECT_EQ(result.ambiguous.front().size(), 2u);
    for (const FittedParameter& parameter : result.parameters)
        EXPECT_FALSE(parameter.standardError) << parameter.name;
}

TEST(Robust, OutliersPullLess) {
    FitSamples samples = gatherSamples(*open("ward:kd=.2,ks=.2,ax=.2,ay=.2"), {}).drawn(2000, 1);
    std::mt19937_64 random(3);
    for (std::size_t k = 0; k < samples.values.size(); k += 20) samples.values[k] += 3;
    const auto errorOf = [&](Robust robust) {
        const FitResult result = fit(samples, {.model = "ward", .robust = robust});
        double error = 0;
        for (const FittedParameter& p : result.parameters)
            error = std::max(error, std::abs(p.value - 0.2));
        return error;
    };
    const double plain = errorOf(Robust::none), huber = errorOf(Robust::huber),
                 cauchy = errorOf(Robust::cauchy);
    EXPECT_GT(plain, 0.05);
    EXPECT_LT(huber, plain / 5);
    EXPECT_LT(cauchy, plain / 5);
}

// Every loss of samples is smallest for the fit that minimised it; `picture` is one of pixels.
TEST(Losses, EachFitIsBestByItsOwn) {
    const FitSamples samples =
        gatherSamples(*open("lambert:kd=.1/.2/.3 + ggx:alpha=.2,F0=.05"), {}).drawn(1500, 2);
    std::vector<std::string> specs;
    const auto ofSamples = losses().first(losses().size() - 1);
    ASSERT_EQ(losses().back().kind, Loss::Kind::picture);
    for (const Loss& loss : ofSamples)
        specs.push_back(fit(samples, {.model = "ward", .loss = loss.kind}).spec);
    for (std::size_t own = 0; own < specs.size(); ++own)
        for (std::size_t other = 0; other < specs.size(); ++other) {
            const Loss::Kind kind = losses()[own].kind;
            EXPECT_LE(lossOf(*open(specs[own]), samples, kind),
                      lossOf(*open(specs[other]), samples, kind) * (1 + 1e-9))
                << losses()[own].name << " against " << losses()[other].name;
        }
}

TEST(GivenStart, IsTheOnlyOneAndLeadsToTheSameMinimum) {
    const FitSamples samples =
        gatherSamples(*open("lambert:kd=.1/.2/.3 + ggx:alpha=.2,F0=.05"), {}).drawn(1500, 2);
    const FitResult searched = fit(samples, {.model = "lambert+ward"});
    std::size_t searches = 0;
    const FitResult given =
        fit(samples, {.model = "lambert+ward",
                      .from = {0.3},
                      .progress = [&](std::size_t, std::size_t total) { searches = total - 1; }});
    EXPECT_EQ(searches, 1u);
    EXPECT_TRUE(given.converged);
    EXPECT_NEAR(given.loss, searched.loss, 1e-9 * searched.loss);
}

TEST(GivenStart, OfAnotherKindIsRefused) {
    const FitSamples samples = gatherSamples(*open("ggx:alpha=.2"), {}).drawn(300, 2);
    EXPECT_THROW(fit(samples, {.model = "lambert+ward", .from = {0.2, 0.3}}), UsageError);
    EXPECT_THROW(fit(samples, {.model = "ggx", .dispersion = "alpha=cauchy:2", .from = {0.2}}),
                 UsageError);
}

}  // namespace
}  // namespace hshfit::brdfs
