// The choice of a model's optional parts, and the brief searches that it is made by.

#include <brdfs/catalog.h>
#include <brdfs/fit/choose_parts.h>
#include <brdfs/fit/minimise.h>
#include <brdfs/random_draws.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

FitSamples samplesOf(const std::string& spec, double noise) {
    FitSamples samples = gatherSamples(*open(spec), {}).drawn(800, 1);
    std::mt19937_64 random(5);
    for (double& value : samples.values) value *= std::exp(noise * test::normal(random));
    return samples;
}

FitOptions optionsOf(const std::string& model) {
    return {.model = model, .loss = Loss::Kind::log};
}

TEST(ChooseParts, TakesThePartThatIsThereAndNoOther) {
    const PartSearch search =
        chooseParts(samplesOf("gltf-pbr:baseColorFactor=.6/.3/.1,roughnessFactor=.5,"
                              "clearcoatFactor=.8,clearcoatRoughnessFactor=.15",
                              0.02),
                    optionsOf("gltf-pbr"));
    EXPECT_EQ(search.parts, std::vector<std::string>{"clearcoat"});
    const double least = 1 - PartOptions{}.leastGain;
    // By their number of parts: the fit that those with one part more started at.
    std::vector<const PartTrial*> taken;
    for (const PartTrial& trial : search.trials)
        if (trial.taken) taken.push_back(&trial);
    ASSERT_EQ(taken.size(), 2u);
    for (const PartTrial& trial : search.trials) {
        EXPECT_TRUE(trial.failure.empty()) << trial.failure;
        if (trial.parts.empty()) continue;
        const PartTrial& before = *taken[trial.parts.size() - 1];
        // A wider model fits no worse, up to where a brief search ends.
        EXPECT_LT(trial.loss, 1.001 * before.loss);
        if (trial.heldOut) {
            EXPECT_LE(trial.loss, least * before.loss);
            EXPECT_TRUE(!trial.taken || *trial.heldOut <= least * *before.heldOut);
        }
    }
}

TEST(ChooseParts, TakesNoneWhereThereIsNone) {
    const PartSearch search = chooseParts(
        samplesOf("gltf-pbr:baseColorFactor=.6/.3/.1,roughnessFactor=.5,metallicFactor=.3", 0.02),
        optionsOf("gltf-pbr"));
    EXPECT_TRUE(search.parts.empty());
    for (std::size_t k = 1; k < search.trials.size(); ++k) {
        EXPECT_FALSE(search.trials[k].heldOut);  // no gain to be checked
        EXPECT_GT(search.trials[k].loss, 0);
    }
    EXPECT_EQ(textOf(search).find("taken"), textOf(search).rfind("taken"));
}

/// Pairs of directions with f and noise in proportion to it; a third lies about the mirror
/// direction, where f is a hundred times larger.
FitSamples scatteredSamples(const Brdf& brdf, double noise, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    constexpr std::size_t count = 1500;
    FitSamples samples;
    samples.isotropic = true;
    samples.origin = SampleOrigin::measured;
    for (std::size_t k = 0; k < count; ++k) {
        const double theta = std::acos(1 - 0.9 * test::uniform(random));
        double other = std::acos(1 - 0.9 * test::uniform(random));
        double turn = 2 * pi * test::uniform(random);
        if (k % 3 == 0) {
            other = std::clamp(theta + 0.14 * test::normal(random), 0.0, 1.46);
            turn = pi + 0.17 * test::normal(random);
        }
        const Direction wi = directionFromAngles(theta, 0), wo = directionFromAngles(other, turn);
        samples.wiX.push_back(wi.x);
        samples.wiY.push_back(wi.y);
        samples.wiZ.push_back(wi.z);
        samples.wo.push_back(wo);
        samples.values.push_back(evaluate(brdf, wi, wo).front() *
                                 (1 + noise * test::normal(random)));
    }
    samples.weights.assign(count, 1);
    return samples;
}

// Least squares of f hang on some dozens of samples about the peak, whose noise a coat takes on.
TEST(ChooseParts, TakesNoneForTheNoiseOfBrightSamples) {
    const auto brdf = open("openpbr");
    FitOptions options{.model = "openpbr"};
    options.loss = Loss::Kind::cosine;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const PartSearch search = chooseParts(scatteredSamples(*brdf, 0.02, seed), options);
        EXPECT_TRUE(search.parts.empty()) << "seed " << seed << "\n" << textOf(search);
    }
}

// A coat of the standard's index, and one of another, seen through noise.
TEST(ChooseParts, LeavesDefaultsThatTheDataDoNotContradict) {
    const std::string base = "openpbr:fuzz_weight=0,specular_weight=1,specular_ior=1.5";
    for (const double index : {1.6, 2.1}) {
        const PartSearch search = chooseParts(
            samplesOf("openpbr:base_color=.6/.3/.1,specular_roughness=.5,coat_weight=.7,"
                      "coat_roughness=.2,coat_ior=" +
                          std::to_string(index),
                      0.02),
            optionsOf(base));
        ASSERT_NE(std::ranges::find(search.parts, "coat"), search.parts.end());
        const auto held = std::ranges::find(search.held, "coat_ior", &HeldParameter::name);
        EXPECT_EQ(held != search.held.end(), index == 1.6) << textOf(search);
        if (held == search.held.end()) continue;
        EXPECT_EQ(held->value, 1.6);
        EXPECT_NE(withParts(base, search).find("coat_ior=1.6"), std::string::npos);
    }
}

// Unknown values of a start are taken from the searches.
TEST(GivenStart, MayBeOfSomeShapes) {
    const FitSamples samples =
        samplesOf("lambert:kd=.2+ggx:alpha=.1,ks=.4,F0=1+ggx:alpha=.5,ks=.5,F0=1", 0);
    FitOptions options = optionsOf("lambert+ggx:F0=1+ggx:F0=1");
    options.from = {0.1, std::numeric_limits<double>::quiet_NaN()};
    std::size_t searches = 0;
    options.progress = [&](std::size_t, std::size_t total) { searches = total - 1; };
    options.starts = 4;
    const FitResult result = fit(samples, options);
    EXPECT_EQ(searches, 4u);
    EXPECT_LT(result.loss, 1e-6);
}

TEST(BriefFit, HasNearlyTheLeastLoss) {
    const FitSamples samples = samplesOf("cook-torrance:m=.3,kd=.1/.2/.3,ks=.5", 0.1);
    for (const std::string model : {"lambert+ggx", "lambert+gtr"}) {
        FitOptions options = optionsOf(model);
        const FitResult whole = fit(samples, options);
        options.brief = true;
        const FitResult brief = fit(samples, options);
        EXPECT_LT(brief.loss, 1.002 * whole.loss) << model;
        EXPECT_LE(brief.evaluations, whole.evaluations) << model;
    }
}

/// y = a exp(b t) through values that it does not fit: the part that Gauss-Newton's matrix lacks is
/// as large as the matrix.
class Exponential {
public:
    explicit Exponential(std::size_t every) : every_(every) {}
    Equations operator()(std::span<const double> x, bool) const {
        ++calls;
        Equations sum{0, std::vector<double>(2), std::vector<double>(4), {}};
        for (std::size_t k = 0; k < 400; k += every_) {
            const double t = static_cast<double>(k) / 400, grown = std::exp(x[1] * t);
            const double residual = x[0] * grown - (2 + 6 * std::sin(9 * t));
            const double slopes[] = {grown, x[0] * t * grown};
            const double share = static_cast<double>(every_);
            sum.cost += share * residual * residual / 2;
            for (std::size_t i = 0; i < 2; ++i) {
                sum.gradient[i] += share * slopes[i] * residual;
                for (std::size_t j = 0; j < 2; ++j)
                    sum.hessian[2 * i + j] += share * slopes[i] * slopes[j];
            }
        }
        return sum;
    }
    mutable std::size_t calls = 0;

private:
    std::size_t every_;
};

TEST(Minimise, SecondDerivativesOfFewerSamplesLeadToTheSameMinimum) {
    const std::vector<double> start{1, 1}, lower{-50, -50}, upper{50, 50};
    const Exponential all(1), some(5);
    const Minimum plain = minimise(std::cref(all), start, lower, upper);
    all.calls = 0;
    const SumOfSquares fewer = std::cref(some);
    const Minimum found = minimise(std::cref(all), start, lower, upper, {.fewer = &fewer});
    EXPECT_TRUE(plain.converged && found.converged);
    EXPECT_LT(all.calls, some.calls);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(found.x[i], plain.x[i], 1e-5);
}

// (10 (a - b)^2 + (b - 3)^2) / 2 with b <= 1 is least at a = b = 1.
TEST(Minimise, AParameterWithinRoundingOfItsBoundLeavesTheOthersFree) {
    const SumOfSquares sum = [](std::span<const double> x, bool) {
        const double apart = x[0] - x[1], beyond = x[1] - 3;
        return Equations{(10 * apart * apart + beyond * beyond) / 2,
                         {10 * apart, beyond - 10 * apart},
                         {10, -10, -10, 11},
                         {}};
    };
    const std::vector<double> lower{-50, -50}, upper{50, 1};
    const Minimum found = minimise(sum, {0, 1 - 1e-15}, lower, upper);
    EXPECT_TRUE(found.converged);
    EXPECT_LE(found.evaluations, 12);
    for (const double x : found.x) EXPECT_NEAR(x, 1, 1e-6);
}

}  // namespace
}  // namespace hshfit::brdfs
