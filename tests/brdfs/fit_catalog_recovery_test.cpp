// Every model of the catalog, with every choice that frees other parameters, isotropic and not:
// parameters drawn over the whole ranges of its own table row come back within the errors that the
// fit states, or the fit says what it cannot tell; of coloured data in each channel. HSHFIT_DRAWS
// sets how many of each, HSHFIT_VERBOSE prints them; without, one on fewer samples
// (docs/reference/fit.md).
#include <brdfs/catalog.h>
#include <brdfs/fit/distributions.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/free_parameters.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

struct Case {
    const Model* model;
    std::string choice;  ///< "fresnel=conductor"; empty: as by default
    bool isotropic;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.model->name << (c.choice.empty() ? "" : ":") << c.choice
               << (c.isotropic ? "" : ", anisotropic");
}

/// From the tables alone.
std::vector<Case> casesOf() {
    std::vector<Case> cases;
    for (const Model& model : models()) {
        std::set<std::string> choices{""};
        // The same parameters, but f is not linear in kd.
        if (model.name == "oren-nayar") choices.emplace("variant=full");
        bool anisotropic = false;
        for (const Parameter& parameter : model.parameters)
            for (const FitRange& range : parameter.fit) {
                // A choice that is the default is the same as the empty one, and is taken out
                // below. A name alone is a part that is fitted once it is stated, a film of R, G
                // and B: fit_film_test.
                if (range.choice.find('=') != range.choice.npos) choices.emplace(range.choice);
                anisotropic = anisotropic || range.data == FitRange::Data::anisotropic ||
                              !range.follows.empty();
            }
        for (const Parameter& parameter : model.parameters)
            if (!parameter.choices.empty())
                choices.erase(fmt::format("{}={}", parameter.name, parameter.choices.front()));
        for (const std::string& choice : choices) {
            cases.push_back({&model, choice, true});
            if (anisotropic) cases.push_back({&model, choice, false});
        }
    }
    return cases;
}

struct Truth {
    std::string spec;
    std::vector<FreeParameter> free;
    std::vector<std::vector<double>> values;  ///< one for all channels, or one for each
};

/// Values of R, G and B of a colour over the one that is drawn.
constexpr double shares[] = {1, 0.6, 0.3};

/// `coloured`: colours of which a fit of coloured data finds each channel's have three values.
Truth draw(const Case& c, std::mt19937_64& random, bool coloured = false) {
    const Parameters stated = readParameters(c.model->name, c.model->parameters, c.choice);
    Truth truth{
        std::string(c.model->name), freeParameters(*c.model, stated, c.isotropic, false), {}};
    char separator = ':';
    const auto add = [&](const std::string& text) {
        if (text.empty()) return;
        truth.spec += separator + text;
        separator = ',';
    };
    add(c.choice);
    for (const auto& [key, values] : withHeldParameters(*c.model, stated, c.isotropic).numbers)
        if (!stated.given(key)) add(fmt::format("{}={}", key, values.front()));
    for (const FreeParameter& p : truth.free) {
        const double share = static_cast<double>(random() >> 11) * 0x1p-53;
        const double value = p.logarithmic ? p.startLow * std::pow(p.startHigh / p.startLow, share)
                                           : p.startLow + share * (p.startHigh - p.startLow);
        truth.values.push_back({value});
        if (coloured && p.colour && (p.linear || p.albedo))
            truth.values.back() = {shares[0] * value, shares[1] * value, shares[2] * value};
        for (const std::string& key : p.keys)
            add(fmt::format("{}={}", key, fmt::join(truth.values.back(), "/")));
    }
    return truth;
}

constexpr double most = 5;  // in standard errors

/// Under a coat OpenPBR's base reflects by this index (openpbr.h), which two values of
/// specular_ior share: one below the index of the coat, one above.
double indexUnderCoat(double ior, double coatIor, double coatWeight) {
    const double ratio = ior / coatIor;
    return ior + coatWeight * (std::max(ratio, 1 / ratio) - ior);
}

/// The difference of specular_ior that a fit's index under the coat amounts to.
double offOfIndex(const Truth& truth, const FitResult& result) {
    const auto ofTruth = [&](std::string_view key) {
        for (std::size_t i = 0; i < truth.free.size(); ++i)
            if (truth.free[i].keys.front() == key) return truth.values[i].front();
        throw std::logic_error(std::string(key));
    };
    const auto ofFit = [&](std::string_view key) {
        return std::ranges::find(result.parameters, key, &FittedParameter::name)->value;
    };
    const double ior = ofFit("specular_ior"), coat = ofFit("coat_ior"), step = 1e-6;
    const double weight = ofFit("coat_weight"), own = indexUnderCoat(ior, coat, weight);
    const double slope = (indexUnderCoat(ior + step, coat, weight) - own) / step;
    const double target =
        indexUnderCoat(ofTruth("specular_ior"), ofTruth("coat_ior"), ofTruth("coat_weight"));
    return std::abs((own - target) / slope);
}

/// The distance of two values of a parameter; a lobe turned by half a turn is the same lobe.
double distance(const FreeParameter& parameter, double a, double b) {
    const double apart = std::abs(a - b);
    const std::string& key = parameter.keys.front();
    return key == "anisotropyRotation" || key == "geometry_tangent"
               ? std::abs(std::remainder(apart, pi))
               : apart;
}

/// `reported`: not converged, or parameters that the fit calls ambiguous, at a bound, or correlated
/// by more than 0.95, with a loss that is as low as the loss of the truth.
enum class Outcome { recovered, reported, wrong };

struct Judged {
    Outcome outcome = Outcome::recovered;
    std::string why;
    double squares = 0;  ///< of deviations in units of the stated errors, where all are stated
    int counted = 0;
};

/// `truth` against what a fit claims.
Judged judge(const Truth& truth, const FitSamples& samples, const FitResult& result) {
    const FitSamples dark = [&] {
        FitSamples copy = samples;
        std::ranges::fill(copy.values, 0.0);
        return copy;
    }();
    const auto brdf = open(truth.spec);
    const double own = lossOf(*brdf, samples, Loss::Kind::cosine),
                 size = lossOf(*brdf, dark, Loss::Kind::cosine);
    Judged judged;
    const bool doubtful = !result.converged || !result.ambiguous.empty();
    double worst = 0;
    // Whether all that is away is said to be traded against another parameter.
    bool traded = true;
    const auto correlated = [&](std::size_t at) {
        const std::size_t n = result.parameters.size();
        for (std::size_t j = 0; j < n; ++j)
            if (j != at && std::abs(result.correlations[at * n + j]) > 0.95) return true;
        return false;
    };
    const auto judgeOne = [&](const FreeParameter& p, double value, const std::string& channel) {
        const std::string label = p.keys.front() + (channel.empty() ? "" : " " + channel);
        const auto found = std::ranges::find(result.parameters, label, &FittedParameter::label);
        if (found == result.parameters.end()) throw std::logic_error(label);
        const double error = found->standardError.value_or(0);
        // Errors are of first order: on the scale on which the fit moves the parameter.
        const bool shared = p.keys.front() == "specular_ior";
        const double off = shared          ? offOfIndex(truth, result)
                           : p.logarithmic ? std::abs(std::log(found->value / value)) * found->value
                                           : distance(p, found->value, value);
        judged.why +=
            fmt::format("{} {:.4g}: {:.6g} +- {:.2g}{}; ", label, value, found->value, error,
                        found->standardError   ? ""
                        : found->bound.empty() ? " open"
                                               : " bound");
        if (!found->standardError) return;
        const double z = off / std::max(error, 1e-300);
        worst = std::max(worst, z);
        if (z > most)
            traded =
                traded && correlated(static_cast<std::size_t>(found - result.parameters.begin()));
        judged.squares += z * z;
        ++judged.counted;
    };
    const std::vector<std::string> names = samples.channels.names();
    for (std::size_t i = 0; i < truth.values.size(); ++i) {
        const std::vector<double>& values = truth.values[i];
        // All that a fit of coloured data has for each channel.
        const FreeParameter& p = truth.free[i];
        const bool each = names.size() > 1 && (p.linear || p.albedo);
        for (std::size_t c = 0; c < (each ? names.size() : 1); ++c)
            judgeOne(p, values[values.size() == 1 ? 0 : c], each ? names[c] : "");
    }
    judged.why +=
        fmt::format("loss {:.4g}, the truth's {:.4g} of {:.4g}, worst z {:.3g}, {}{}", result.loss,
                    own, size, worst, result.converged ? "converged" : "not converged",
                    result.ambiguous.empty() ? "" : ", ambiguous");
    const bool higher = result.loss > own * (1 + 1e-6) + 1e-6 * size;
    const bool away = worst > most;
    const bool bound = std::ranges::any_of(
        result.parameters, [](const FittedParameter& p) { return !p.bound.empty(); });
    if (!result.converged || (doubtful && !higher))
        judged.outcome = Outcome::reported;
    else if (higher || (away && !bound && !traded))
        judged.outcome = Outcome::wrong;
    else if (away)
        judged.outcome = Outcome::reported;
    return judged;
}

class CatalogRecovery : public testing::TestWithParam<Case> {
protected:
    static int draws(int usual) {
        const char* text = std::getenv("HSHFIT_DRAWS");
        return text ? std::atoi(text) : usual;
    }
    /// Models whose masking or albedo is an integral, or whose value is a sum of dozens of terms.
    static bool isSlow() {
        const std::string_view name = GetParam().model->name;
        return name == "he" || name == "gtr";
    }
    static std::size_t sizeOf() {
        return std::getenv("HSHFIT_DRAWS") ? 1500 : isSlow() ? 200 : 500;
    }
    static int startsOf() { return std::getenv("HSHFIT_DRAWS") ? 16 : isSlow() ? 4 : 8; }
    static std::string modelOf() {
        return fmt::format("{}{}{}", GetParam().model->name, GetParam().choice.empty() ? "" : ":",
                           GetParam().choice);
    }

    static void check(double noise, int count, bool coloured = false) {
        const std::size_t size = sizeOf();
        const int starts = startsOf();
        std::mt19937_64 random(11);
        std::normal_distribution<double> normal;
        int outcomes[3] = {};
        double squares = 0;
        int counted = 0;
        for (int trial = 0; trial < count; ++trial) {
            const Truth truth = draw(GetParam(), random, coloured);
            FitSamples samples = gatherSamples(*open(truth.spec), {}).drawn(size, random());
            for (double& value : samples.values) value *= 1 + noise * normal(random);
            const Judged judged =
                judge(truth, samples, fit(samples, {.model = modelOf(), .starts = starts}));
            ++outcomes[static_cast<int>(judged.outcome)];
            EXPECT_NE(judged.outcome, Outcome::wrong) << truth.spec << "\n  " << judged.why;
            if (std::getenv("HSHFIT_VERBOSE"))
                fmt::print("{} {}\n   {}\n", static_cast<int>(judged.outcome), truth.spec,
                           judged.why);
            if (judged.outcome != Outcome::recovered) continue;
            squares += judged.squares;
            counted += judged.counted;
        }
        fmt::print("{}: {} draws, {} recovered, {} reported, {} wrong; mean z^2 {:.3f} of {}\n",
                   testing::PrintToString(GetParam()), count, outcomes[0], outcomes[1], outcomes[2],
                   counted ? squares / counted : 0, counted);
    }
};

TEST_P(CatalogRecovery, WithoutNoise) {
    check(0, draws(1));
}

TEST_P(CatalogRecovery, WithNoise) {
    check(0.05, draws(1));
}

// With noise but for the standard materials, whose shapes lie in long valleys: along these, errors
// of first order are too small, of colours as of grey data (docs/results/fits.md).
TEST_P(CatalogRecovery, OfColours) {
    check(0, draws(1), true);
    if (GetParam().model->parts.empty()) check(0.05, draws(1), true);
}

double chiSquareOf(const Brdf& brdf, const FitSamples& samples) {
    const std::vector<double> f = valuesOf(brdf, samples);
    double sum = 0;
    for (std::size_t k = 0; k < f.size(); ++k)
        sum += std::pow((samples.values[k] - f[k]) / samples.sigmas[k], 2);
    return sum;
}

// With the noise stated, the chi-square of the truth exceeds the chi-square of the fit by a
// chi-square variable with as many degrees of freedom as there are parameters (Wilks 1938,
// 10.1214/aoms/1177732360), whatever the scale of the parameters and their correlation. Draws in
// which the data leave something open, or in which a parameter ends at a bound, are not counted,
// since their fits report it. For models with more than eight parameters a few starts may miss the
// minimum; such misses are counted.
TEST_P(CatalogRecovery, TheTruthIsAsFarFromTheFitAsTheNoiseImplies) {
    constexpr double noise = 0.05;
    std::mt19937_64 random(23);
    std::normal_distribution<double> normal;
    const int count = draws(2);
    double squares = 0;
    int degrees = 0, counted = 0, missed = 0;
    for (int trial = 0; trial < count; ++trial) {
        const Truth truth = draw(GetParam(), random);
        FitSamples samples = gatherSamples(*open(truth.spec), {}).drawn(sizeOf(), random());
        std::vector<std::size_t> lit;
        for (std::size_t k = 0; k < samples.size(); ++k)
            if (samples.values[k] > 1e-9) lit.push_back(k);
        samples = samples.subset(lit);
        std::ranges::fill(samples.weights, 1.0);
        for (double& value : samples.values) {
            samples.sigmas.push_back(noise * value);
            value *= 1 + noise * normal(random);
        }
        const FitResult result =
            fit(samples, {.model = modelOf(), .loss = Loss::Kind::l2, .starts = startsOf()});
        const bool bound = std::ranges::any_of(
            result.parameters, [](const FittedParameter& p) { return !p.bound.empty(); });
        const bool open = !result.converged || !result.ambiguous.empty() || bound;
        const double own =
            chiSquareOf(*brdfs::open(truth.spec), samples) - chiSquareOf(*openFit(result), samples);
        if (std::getenv("HSHFIT_VERBOSE"))
            fmt::print("{} {}: {:.3g} of {}\n   {}\n", open ? "open" : "counted", truth.spec, own,
                       result.parameters.size(), result.spec);
        if (own < -1e-3) {
            ++missed;
            EXPECT_GT(result.parameters.size(), 8u) << truth.spec << "\n  " << result.spec;
            continue;
        }
        if (open) continue;
        squares += own;
        degrees += static_cast<int>(result.parameters.size());
        ++counted;
    }
    const double above = degrees > 0 ? chiSquareProbability(squares, degrees) : 1;
    fmt::print("{}: {} draws, {} counted, {} missed, chi-square {:.4g} of {}, probability {:.3g}\n",
               testing::PrintToString(GetParam()), count, counted, missed, squares, degrees, above);
    // None of some fifty cases falls below by chance.
    if (degrees > 0) {
        EXPECT_GT(above, 1e-4);
        EXPECT_LT(above, 1 - 1e-4);
    }
}

INSTANTIATE_TEST_SUITE_P(Models, CatalogRecovery, testing::ValuesIn(casesOf()));

}  // namespace
}  // namespace hshfit::brdfs
