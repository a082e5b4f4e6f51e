// Uncertainties common to all samples: budgets against tables of the GUM, sums by hand, and fits to
// samples that the error of a contribution has changed.

#include <brdfs/campaigns.h>
#include <brdfs/catalog.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/instrument/turned.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/fit/propagated_errors.h>
#include <brdfs/instrument_scans.h>
#include <brdfs/random_draws.h>
#include <hshfit/error.h>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace hshfit::brdfs {
namespace {

constexpr double known = std::numeric_limits<double>::infinity();

BudgetRow row(double standard, double degrees, double sensitivity = 1) {
    BudgetRow result;
    result.standard = standard;
    result.sensitivity = sensitivity;
    result.degrees = degrees;
    return result;
}

// JCGM 100:2008, H.1.6 and table H.1: the length of an end gauge, nm. The annex divides by (32
// nm)^4 rounded, 31.7 nm, and states 32 nm and 16.7 degrees of freedom.
TEST(Budget, OfAnEndGaugeIsThatOfTheGum) {
    ParameterBudget budget;
    budget.rows = {row(25, 18), row(9.7, 25.6), row(2.9, 50), row(16.6, 2)};
    combine(budget);
    EXPECT_NEAR(budget.combined, 32, 0.5);
    EXPECT_NEAR(budget.degrees, 16.7, 0.1);
    double shares = 0;
    for (const BudgetRow& own : budget.rows) shares += own.share;
    EXPECT_NEAR(shares, 1, 1e-12);
}

// JCGM 100:2008, table G.2, the column of 95.45 %.
TEST(Budget, CoverageFactorsAreThoseOfTheGum) {
    const std::pair<double, double> rows[] = {{1, 13.97}, {2, 4.53},  {5, 2.65},   {10, 2.28},
                                              {16, 2.17}, {50, 2.05}, {known, 2.0}};
    for (const auto& [degrees, factor] : rows) {
        ParameterBudget budget;
        budget.rows = {row(3, degrees, -2)};
        combine(budget);
        EXPECT_NEAR(budget.coverage, factor, 0.005) << degrees;
        EXPECT_DOUBLE_EQ(budget.combined, 6);
        EXPECT_DOUBLE_EQ(budget.expanded, budget.coverage * 6);
        EXPECT_EQ(budget.degrees, degrees);
    }
}

Contribution contribution(std::string_view on, double standard, double degrees = known) {
    Contribution result;
    result.name = on;
    result.standard = standard;
    result.degrees = degrees;
    for (const ActsOn& kind : contributionKinds())
        if (kind.name == on) result.on = kind;
    return result;
}

std::vector<Contribution> oneOfEach() {
    return {contribution("scale", 0.008),    contribution("linearity", 0.003, 12),
            contribution("offset", 0.001),   contribution("dark", 0.0005, 6),
            contribution("incidence", 0.05), contribution("detector", 0.04)};
}

/// Readings without stated uncertainties.
FitSamples sweeps(const std::string& spec, const std::vector<double>& incidences) {
    FitSamples samples = test::exactSweeps(incidences, {}, spec);
    samples.sigmas.clear();
    return samples;
}

// kd of a Lambertian surface is pi times the mean of the readings: every number of its budget by
// hand.
TEST(Budget, OfALambertianSurfaceIsThatByHand) {
    FitSamples samples = sweeps("lambert:kd=.5", {20, 40});
    samples.scans.clear();
    std::mt19937_64 random(4);
    for (double& value : samples.values) value += 0.002 * test::normal(random);
    samples.sigmas.assign(samples.values.size(), 0.002);
    FitOptions options{.model = "lambert", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    options.contributions = oneOfEach();
    const FitResult result = fit(samples, options);

    const auto n = static_cast<double>(samples.size());
    double sum = 0, largest = 0;
    for (const double y : samples.values) sum += y, largest = std::max(largest, y);
    const double kd = pi * sum / n;
    double squares = 0, linearity = 0, dark = 0, detector = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const double y = samples.values[k], residual = (y - sum / n) / (1 - 1 / n);
        squares += residual * residual;
        linearity += pi / n * y * std::log10(y / largest);
        dark += pi / n / samples.wo[k].z;
        // d cos(theta) / cos(theta); the mirror direction is on the side of -x.
        detector += pi / n * (kd / pi) * samples.wo[k].x / samples.wo[k].z * radians(1.0);
    }
    const double ofSamples = pi / n * std::sqrt(squares);
    const double sensitivities[] = {1, kd, linearity, pi, dark, 0, detector};
    const double uncertainties[] = {ofSamples, 0.008, 0.003, 0.001, 0.0005, 0.05, 0.04};
    const double freedoms[] = {n - 1, known, 12, known, 6, known, known};
    ASSERT_TRUE(result.budget);
    const ParameterBudget& budget = result.budget->parameters.at(0);
    ASSERT_EQ(budget.rows.size(), 7u);
    EXPECT_NEAR(budget.value, kd, 1e-10);
    double variance = 0, fourths = 0;
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_NEAR(budget.rows[i].sensitivity, sensitivities[i], 1e-10) << i;
        EXPECT_NEAR(budget.rows[i].standard, uncertainties[i], 1e-10) << i;
        EXPECT_NEAR(budget.rows[i].contribution, std::abs(sensitivities[i]) * uncertainties[i],
                    1e-10);
        if (std::isfinite(freedoms[i]))
            EXPECT_NEAR(budget.rows[i].degrees, freedoms[i], 1e-6) << i;
        else
            EXPECT_EQ(budget.rows[i].degrees, known);
        const double square = std::pow(sensitivities[i] * uncertainties[i], 2);
        variance += square;
        fourths += square * square / freedoms[i];
    }
    EXPECT_NEAR(budget.combined, std::sqrt(variance), 1e-10);
    EXPECT_NEAR(*result.parameters[0].standardError, std::sqrt(variance), 1e-10);
    EXPECT_NEAR(budget.degrees, variance * variance / fourths, 1e-5 * budget.degrees);
    EXPECT_NEAR(budget.expanded, budget.coverage * std::sqrt(variance), 1e-10);
    // Everywhere the error of f is the error of kd over pi.
    const DirectionPair pairs[] = {{directionFromAngles(0.3, 0), directionFromAngles(0.6, 2)}};
    const Prediction prediction = predict(result, pairs);
    EXPECT_NEAR(prediction.errors[0], std::sqrt(variance) / pi, 1e-10);
    EXPECT_NEAR(prediction.degrees[0], budget.degrees, 1e-5 * budget.degrees);
}

/// The samples as an error q of a contribution leaves them.
FitSamples withError(const FitSamples& samples, const Brdf& truth, const Contribution& own,
                     double q) {
    using Kind = ActsOn::Kind;
    FitSamples result = samples;
    const AngleZeros zeros{own.on.kind == Kind::incidence ? radians(q) : 0,
                           own.on.kind == Kind::detector ? radians(q) : 0};
    const FitSamples moved = turned(samples, {&zeros, 1});
    const std::vector<double> f = valuesOf(truth, moved);
    const double largest = *std::ranges::max_element(samples.values);
    for (std::size_t v = 0; v < result.values.size(); ++v) {
        const double cosine = samples.wo[v % samples.size()].z;
        double& y = result.values[v];
        if (own.on.kind == Kind::scale) y *= 1 + q;
        if (own.on.kind == Kind::linearity) y *= 1 + q * std::log10(y / largest);
        if (own.on.kind == Kind::offset) y += q;
        if (own.on.kind == Kind::dark) y += q / cosine;
        if (own.on.unit == "degrees") y = f[v] * moved.wo[v % samples.size()].z / cosine;
    }
    return result;
}

/// Sensitivities are the changes of fits to samples with an error of either sign, to 0.2 % or 0.1 %
/// of the combined uncertainty.
void expectThoseOfRefits(const FitSamples& samples, const Brdf& truth, FitOptions options) {
    options.uncertainty.report = true;
    options.contributions = oneOfEach();
    const FitResult result = fit(samples, options);
    ASSERT_TRUE(result.budget);
    FitOptions plain = options;
    plain.contributions.clear();
    for (std::size_t j = 0; j < options.contributions.size(); ++j) {
        const Contribution& own = options.contributions[j];
        const double step = 0.02 * own.standard;
        const FitResult above = fit(withError(samples, truth, own, step), plain),
                        below = fit(withError(samples, truth, own, -step), plain);
        ASSERT_EQ(above.parameters.size(), result.parameters.size());
        std::size_t place = 0;
        for (const ParameterBudget& budget : result.budget->parameters) {
            while (result.parameters[place].name != budget.name ||
                   result.parameters[place].channel != budget.channel)
                ++place;
            const double change =
                (above.parameters[place].value - below.parameters[place].value) / (2 * step);
            EXPECT_NEAR(budget.rows[1 + j].sensitivity, change,
                        2e-3 * std::abs(change) + 1e-3 * budget.combined / own.standard)
                << own.name << " " << budget.name;
        }
    }
}

const char* const glossy = "lambert:kd=.3 + ggx:ks=.2,F0=.9,alpha=.2";

TEST(Sensitivities, AreThoseOfFitsToChangedSamples) {
    FitSamples samples = sweeps(glossy, {15, 35, 50});
    samples.scans.clear();
    const auto truth = open(glossy);
    for (const Loss::Kind loss : {Loss::Kind::cosine, Loss::Kind::logRelative})
        expectThoseOfRefits(samples, *truth, {.model = "lambert + ggx:F0=.9", .loss = loss});
    for (const double value : samples.values) samples.sigmas.push_back(0.01 * value);
    expectThoseOfRefits(samples, *truth, {.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2});
}

TEST(Sensitivities, GoThroughTheTermsOfAnInstrument) {
    FitSamples samples = sweeps(glossy, {10, 15, 25, 35, 42, 50, 55});
    for (const double value : samples.values) samples.sigmas.push_back(0.01 * value);
    FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2};
    options.instrument = parseInstrument(
        {.dark = "fit", .scale = "2%", .incidenceZero = "0.1:scan", .detectorZero = "0.05"});
    expectThoseOfRefits(samples, *open(glossy), options);
}

TEST(Sensitivities, OfChannelsApartAndOfLawsOverTheWavelength) {
    FitSamples grey = sweeps(glossy, {15, 35, 50});
    grey.scans.clear();
    FitSamples samples = grey;
    samples.channels.kind = Channels::Kind::spectral;
    samples.channels.wavelengths = {450, 550, 650};
    for (int c = 1; c < 3; ++c)
        samples.values.insert(samples.values.end(), grey.values.begin(), grey.values.end());
    const auto truth = open(glossy);
    FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::cosine};
    options.perChannel = true;
    expectThoseOfRefits(samples, *truth, options);
    options.perChannel = false;
    options.dispersion = "kd=poly:1";
    expectThoseOfRefits(samples, *truth, options);
}

// A scale common to all samples moves kd and ks together.
TEST(Budget, ChangesCorrelationsAsOneErrorDoes) {
    FitSamples samples = sweeps(glossy, {15, 35, 50});
    samples.scans.clear();
    std::mt19937_64 random(5);
    for (double& value : samples.values) value *= 1 + 1e-5 * test::normal(random);
    FitOptions options{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::cosine};
    options.contributions = {contribution("scale", 0.01)};
    const FitResult result = fit(samples, options);
    const std::size_t n = result.parameters.size();
    ASSERT_EQ(n, 3u);
    EXPECT_GT(result.correlations[1 * n + 2], 0.999);
    EXPECT_DOUBLE_EQ(result.correlations[1 * n + 1], 1);
    EXPECT_NEAR(*result.parameters[1].standardError, 0.01 * result.parameters[1].value, 1e-5);
}

// kd at a wavelength is pi times a mean, of readings that are correlated along scans: its variance
// by hand, for the weights of generalised least squares and for the equal ones of fits with laws
// and with terms of the instrument. Two wavelengths have the correlation of their readings.
TEST(CorrelatedErrors, OfALambertianSurfaceAreThoseByHand) {
    FitSamples samples = sweeps("lambert:kd=.5", {20, 40});
    samples.channels = Channels::spectral({500, 550});
    samples.values = valuesOf(*open("lambert:kd=.5"), samples);
    samples.sigmas.assign(samples.values.size(), 0.002);
    samples.correlation = parseSigma("1%,correlation:angle=10deg,wavelength=100nm").correlation;
    FitOptions options{.model = "lambert", .loss = Loss::Kind::l2};
    options.uncertainty.report = true;
    const auto count = static_cast<Eigen::Index>(samples.size());
    Eigen::MatrixXd r = Eigen::MatrixXd::Zero(count, count);
    for (std::size_t j = 0; j < samples.size(); ++j)
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double apart =
                j == k ? 0 : std::acos(std::clamp(dot(samples.wo[j], samples.wo[k]), -1.0, 1.0));
            if (samples.scans[j] == samples.scans[k])
                r(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) =
                    std::exp(-apart / radians(10.0));
        }
    const double sum = r.sum();
    const double error = pi / static_cast<double>(samples.size()) * 0.002 * std::sqrt(sum);
    const double generalised = pi * 0.002 / std::sqrt(r.inverse().sum());
    EXPECT_LT(generalised, 0.999 * error);
    // Along the scans the error is more than 1.9 times as large as by independent readings.
    EXPECT_GT(sum, 3.61 * static_cast<double>(samples.size()));
    for (const bool laws : {false, true}) {
        options.dispersion = laws ? "kd=free" : "";
        const FitResult result = fit(samples, options);
        ASSERT_EQ(result.parameters.size(), 2u);
        for (std::size_t c = 0; c < 2; ++c) {
            const double own = laws ? error : generalised;
            EXPECT_NEAR(*result.parameters[c].standardError, own, 1e-8 * own);
            EXPECT_NEAR(*result.uncertainty->parameters[c].correlated, own, 1e-8 * own);
            EXPECT_FALSE(result.uncertainty->parameters[c].scans);
        }
        EXPECT_NEAR(result.correlations[1], std::exp(-0.5), 1e-8);
        EXPECT_EQ(result.uncertainty->probability.has_value(), !laws);
    }
    options.dispersion = "";
    options.instrument = parseInstrument({.dark = "0"});
    const FitResult read = fit(samples, options);
    EXPECT_NEAR(*read.parameters[1].standardError, error, 1e-8 * error);
    EXPECT_NEAR(read.correlations[1], std::exp(-0.5), 1e-8);
}

TEST(CorrelatedErrors, NameWhatTheyLack) {
    FitSamples samples = sweeps("lambert:kd=.5", {20, 40});
    samples.sigmas.assign(samples.values.size(), 0.002);
    samples.correlation.wavelength = 10;
    FitOptions options{.model = "lambert", .loss = Loss::Kind::l2};
    EXPECT_THROW(fit(samples, options), UsageError);
    samples.correlation = {.angle = 0.1};
    samples.scans.clear();
    EXPECT_THROW(fit(samples, options), UsageError);
    FitSamples many = sweeps("lambert:kd=.5", std::vector<double>(1100, 20));
    many.sigmas.assign(many.values.size(), 0.002);
    many.scans.assign(many.size(), 0);
    ASSERT_GT(many.size(), 30000u);
    many.correlation = {.angle = 0.1};
    EXPECT_THROW(fit(many, options), UsageError);
    EXPECT_DOUBLE_EQ(parseSigma("2%,correlation:angle=3deg").correlation.angle, radians(3.0));
    EXPECT_EQ(parseSigma("column,correlation:wavelength=20").correlation.wavelength, 20);
    EXPECT_EQ(parseSigma("s.csv,correlation:angle=3").path, "s.csv");
    for (const char* text :
         {"2%,correlation:", "2%,correlation:angle", "2%,correlation:angle=0",
          "2%,correlation:angle=3nm", "2%,correlation:time=3", ",correlation:angle=3",
          "2%,correlation:angle=3,angle=4", "2%,correlation:angle=3,wavelength=x"})
        EXPECT_THROW(parseSigma(text), UsageError) << text;
}

// 300 campaigns of each kind, whose errors the fit is told of: shares of one and two standard
// errors within three of their own standard deviations.
TEST(Campaigns, HoldTheTruthAsOftenAsStated) {
    constexpr std::size_t repeats = 300;
    for (const test::Campaign& campaign : test::campaigns()) {
        std::vector<FitResult> results(repeats);
        tbb::parallel_for(std::size_t{0}, repeats, [&](std::size_t r) {
            results[r] = fit(campaign.measured(1000 + r), campaign.options);
        });
        for (std::size_t i = 0; i < results.front().parameters.size(); ++i) {
            const FittedParameter& first = results.front().parameters[i];
            if (first.instrument) continue;
            const test::Coverage own = test::coverageOf(results, i);
            for (const auto& [share, stated] :
                 {std::pair{own.one(), 0.6827}, std::pair{own.two(), 0.9545}})
                EXPECT_NEAR(share, stated, 3 * std::sqrt(stated * (1 - stated) / repeats))
                    << campaign.name << " " << first.name << " " << first.channel;
        }
    }
}

TEST(Budget, RefusesRobustKernels) {
    FitOptions options{.model = "lambert", .robust = Robust::huber};
    options.contributions = {contribution("scale", 0.01)};
    EXPECT_THROW(fit(sweeps("lambert:kd=.5", {20}), options), UsageError);
}

}  // namespace
}  // namespace hshfit::brdfs
