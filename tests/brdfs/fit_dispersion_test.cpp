// Laws over the wavelength: the curves themselves against published formulas, and fits under laws
// against fits without, a known truth, and resampled data.

#include <brdfs/catalog.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/fit/dispersed_problem.h>
#include <brdfs/fit/dispersion_json.h>
#include <brdfs/fit/dispersion_law.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/fit_json.h>
#include <brdfs/fit/prediction.h>
#include <brdfs/presets/metals.h>
#include <brdfs/spectral_samples.h>
#include <hshfit/error.h>

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

using namespace test;

/// n of fused silica: Malitson 1965 (10.1364/JOSA.55.001205).
double silica(double nanometres) {
    const double square = nanometres * nanometres * 1e-6;
    const double b[] = {0.6961663, 0.4079426, 0.8974794}, c[] = {0.0684043, 0.1162414, 9.896161};
    double sum = 1;
    for (std::size_t i = 0; i < 3; ++i) sum += b[i] * square / (square - c[i] * c[i]);
    return std::sqrt(sum);
}

LawCurve curveOf(const std::string& law, double least, double most,
                 const std::vector<double>& wavelengths) {
    return LawCurve(parseDispersion("p=" + law).at(0), least, most, wavelengths);
}

double valueAt(const LawCurve& curve, double nanometres, const std::vector<double>& coefficients) {
    std::vector<double> slopes(curve.count());
    return curve.at(nanometres, coefficients, slopes.data());
}

TEST(DispersionLaw, SellmeiersFormulaIsThatOfSilica) {
    // The value that Malitson's paper is known for: n at the yellow line of helium.
    EXPECT_NEAR(silica(587.56), 1.45846, 1e-5);
    const std::vector<double> wavelengths = range(350, 2000, 34);
    std::vector<double> n;
    for (const double nm : wavelengths) n.push_back(silica(nm));
    double worst[4] = {};
    for (int terms = 1; terms <= 3; ++terms) {
        const LawCurve curve =
            curveOf("sellmeier:" + std::to_string(terms), 0.01, 100, wavelengths);
        const std::vector<double> found = curve.nearest(n);
        for (const double nm : range(350, 2000, 200))
            worst[terms] = std::max(worst[terms], std::abs(valueAt(curve, nm, found) - silica(nm)));
    }
    // Three terms are the formula itself; fewer are worse.
    EXPECT_LT(worst[3], 2e-5);
    EXPECT_LT(worst[3], worst[2]);
    EXPECT_LE(worst[2], worst[1] * 1.01);
    EXPECT_LT(worst[1], 0.01);
}

TEST(DispersionLaw, CurvesStayInTheirBoundsAndDerivativesAreTheirs) {
    const std::vector<double> wavelengths = range(400, 1000, 31);
    std::mt19937_64 random(4);
    for (const char* law :
         {"shared", "cauchy:1", "cauchy:2", "cauchy:4", "sellmeier:1", "sellmeier:2", "sellmeier:3",
          "poly:1", "poly:5", "spline:4", "spline:9"}) {
        const LawCurve curve = curveOf(law, 0.01, 5, wavelengths);
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<double> x;
            for (std::size_t j = 0; j < curve.count(); ++j)
                x.push_back(curve.lower()[j] +
                            uniform(random) * (curve.upper()[j] - curve.lower()[j]));
            const double nm = 400 + 600 * uniform(random);
            std::vector<double> slopes(curve.count());
            const double value = curve.at(nm, x, slopes.data());
            EXPECT_GE(value, 0.01 - 1e-12) << law;
            EXPECT_LE(value, 5 + 1e-9) << law;
            if (std::string(law).starts_with("sellmeier")) {
                EXPECT_GT(value, 1) << law;
            }
            for (std::size_t j = 0; j < x.size(); ++j) {
                const double step = 1e-6 * (curve.upper()[j] - curve.lower()[j]);
                std::vector<double> above = x, below = x;
                above[j] += step, below[j] -= step;
                const double slope =
                    (valueAt(curve, nm, above) - valueAt(curve, nm, below)) / (2 * step);
                EXPECT_NEAR(slopes[j], slope, 1e-4 * (1 + std::abs(slope))) << law << " " << j;
            }
        }
    }
}

// By the formulas as they are printed.
TEST(DispersionLaw, ReportedTermsGiveTheCurve) {
    const std::vector<double> wavelengths = range(400, 1000, 31);
    std::mt19937_64 random(9);
    for (const std::string law : {"cauchy:3", "sellmeier:3"}) {
        const LawCurve curve = curveOf(law, 1, 4, wavelengths);
        std::vector<double> x;
        for (std::size_t j = 0; j < curve.count(); ++j)
            x.push_back(curve.lower()[j] + uniform(random) * (curve.upper()[j] - curve.lower()[j]));
        const LawCurve::Reported terms = curve.reported(x);
        for (const double nm : {400.0, 533.0, 1000.0}) {
            const double square = nm * nm * 1e-6;
            double value = law == "cauchy:3" ? 0 : 1;
            for (std::size_t i = 0; i < 3; ++i)
                value += law == "cauchy:3"
                             ? terms.values[i] / std::pow(square, static_cast<double>(i))
                             : terms.values[2 * i] * square / (square - terms.values[2 * i + 1]);
            EXPECT_NEAR(law == "cauchy:3" ? value : std::sqrt(value), valueAt(curve, nm, x), 1e-10);
        }
        // Poles on either side of the band.
        if (law == "cauchy:3") continue;
        EXPECT_LT(terms.values[1], 0.4 * 0.4);
        EXPECT_LT(terms.values[3], 0.4 * 0.4);
        EXPECT_GT(terms.values[5], 1);
        for (std::size_t j = 0; j < x.size(); ++j) {
            const double step = 1e-6 * (curve.upper()[j] - curve.lower()[j]);
            std::vector<double> above = x, below = x;
            above[j] += step, below[j] -= step;
            const auto a = curve.reported(above), b = curve.reported(below);
            for (std::size_t i = 0; i < x.size(); ++i) {
                const double slope = (a.values[i] - b.values[i]) / (2 * step);
                EXPECT_NEAR(terms.slopes[i * x.size() + j], slope, 1e-4 * (1 + std::abs(slope)));
            }
        }
    }
}

TEST(DispersionLaw, SplinesHoldCubicsAndPolynomialsTheirDegree) {
    const std::vector<double> wavelengths = range(400, 1000, 31);
    std::vector<double> cubic;
    const auto f = [](double nm) {
        const double t = (nm - 700) / 300;
        return 2 + t - 0.5 * t * t + 0.7 * t * t * t;
    };
    for (const double nm : wavelengths) cubic.push_back(f(nm));
    for (const char* law : {"poly:3", "spline:4", "spline:8"}) {
        const LawCurve curve = curveOf(law, -10, 10, wavelengths);
        const std::vector<double> x = curve.nearest(cubic);
        for (const double nm : {400.0, 433.3, 700.0, 999.0, 1000.0})
            EXPECT_NEAR(valueAt(curve, nm, x), f(nm), 1e-7) << law;
    }
}

TEST(DispersionLaw, WrongStatementsNameWhatWouldBeRight) {
    const auto refused = [](const std::function<void()>& action, const std::string& part) {
        try {
            action();
            ADD_FAILURE() << part;
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    for (const auto& [text, part] :
         std::vector<std::pair<std::string, std::string>>{{"", "PARAMETER=LAW"},
                                                          {"kd", "PARAMETER=LAW"},
                                                          {"kd=cubic", "spline"},
                                                          {"kd=spline:3", "4 to 200"},
                                                          {"kd=spline:x", "4 to 200"},
                                                          {"kd=free:2", "no number"},
                                                          {"ior=sellmeier:4", "1 to 3"},
                                                          {"kd=poly:2,", "PARAMETER=LAW"}})
        refused([&laws = text] { parseDispersion(laws); }, part);
    const auto model = [](const std::string& laws) {
        DispersedModel("lambert + ggx:fresnel=dielectric", true, range(400, 700, 5),
                       parseDispersion(laws));
    };
    refused([&] { model("kd=cauchy"); }, "index of refraction");
    refused([&] { model("alpha=sellmeier"); }, "index of refraction");
    refused([&] { model("n=cauchy"); }, "ggx.ior");
    refused([&] { model("kd=spline:6"); }, "5 wavelengths");
    refused([&] { model("kd=poly:1,lambert.kd=poly:2"); }, "two laws");
    refused(
        [&] {
            DispersedModel("ggx + ggx:alpha=.1", true, {400, 500}, parseDispersion("ks=poly:1"));
        },
        "several terms");
    refused(
        [] {
            DispersedModel("ggx + ggx", true, {400, 500}, parseDispersion("ggx.ks=poly:1"));
        },
        "ggx1.ks");
}

TEST(DispersedFit, WithTheLawsOfThePlainFitItIsThePlainFit) {
    FitSamples samples = spectralSamples(160, 2);
    for (const bool scans : {false, true}) {
        if (scans)
            for (std::size_t k = 0; k < samples.size(); ++k) samples.scans.push_back(k / 5);
        const FitResult plain = fit(samples, optionsOf("")),
                        laws = fit(samples, optionsOf("ggx.alpha=shared,kd=free"));
        ASSERT_EQ(plain.parameters.size(), laws.parameters.size());
        EXPECT_NEAR(plain.loss, laws.loss, 1e-9 * plain.loss);
        EXPECT_NEAR(plain.aic, laws.aic, 1e-7 * std::abs(plain.aic));
        EXPECT_EQ(plain.uncertainty->degreesOfFreedom, laws.uncertainty->degreesOfFreedom);
        EXPECT_NEAR(plain.uncertainty->chiSquare, laws.uncertainty->chiSquare, 1e-6);
        for (const FittedParameter& own : plain.parameters) {
            const FittedParameter& other = parameter(laws, own.name, own.channel);
            ASSERT_TRUE(own.standardError && other.standardError) << own.name;
            EXPECT_NEAR(own.value, other.value, 1e-3 * *own.standardError) << own.name;
            EXPECT_NEAR(*own.standardError, *other.standardError, 1e-3 * *own.standardError)
                << own.name << " " << own.channel;
        }
        for (std::size_t i = 0; i < plain.uncertainty->values.size(); ++i)
            ASSERT_NEAR(plain.uncertainty->values[i].leverage, laws.uncertainty->values[i].leverage,
                        1e-4);
    }
}

TEST(DispersedFit, DerivativesAreThoseOfTheCost) {
    const FitSamples samples = spectralSamples(60, 3);
    const DispersedModel laws(model, true, wavelengths,
                              parseDispersion("ior=sellmeier:2,kd=spline:5,alpha=poly:1"));
    const DispersedProblem problem(samples, laws, Loss::Kind::l2);
    std::mt19937_64 random(7);
    std::vector<double> x;
    for (std::size_t j = 0; j < laws.count(); ++j)
        x.push_back(std::max(laws.lower()[j], -3.0) +
                    (0.3 + 0.4 * uniform(random)) *
                        (std::min(laws.upper()[j], 1.0) - std::max(laws.lower()[j], -3.0)));
    const Equations equations = problem.joint(x, true);
    for (std::size_t j = 0; j < x.size(); ++j) {
        const double step = 1e-6;
        std::vector<double> above = x, below = x;
        above[j] += step, below[j] -= step;
        const double slope =
            (problem.joint(above, false).cost - problem.joint(below, false).cost) / (2 * step);
        EXPECT_NEAR(equations.gradient[j], slope, 1e-5 * (1e-3 + std::abs(slope))) << j;
    }
}

TEST(DispersedFit, CauchysTermsAreRecoveredAtTheStatedRate) {
    constexpr std::size_t draws = 120;
    std::vector<double> squares(4 * draws, 0);
    tbb::parallel_for(std::size_t{0}, draws, [&](std::size_t d) {
        FitOptions options = optionsOf("ior=cauchy:2,kd=poly:1");
        options.starts = 1;
        const FitResult result = fit(spectralSamples(200, 100 + d), options);
        EXPECT_TRUE(result.converged);
        const FittedParameter& alpha = parameter(result, "ggx.alpha");
        const FittedParameter &a = parameter(result, "ggx.ior.A"),
                              &b = parameter(result, "ggx.ior.B");
        const double expected[] = {indexA, indexB, 0.2, 0.2};
        const FittedParameter* own[] = {&a, &b, &alpha, &parameter(result, "lambert.kd@400nm")};
        for (std::size_t i = 0; i < 4; ++i)
            squares[i * draws + d] =
                std::pow((own[i]->value - expected[i]) / *own[i]->standardError, 2);
        // Values less 2 of Cauchy, 2 of the line, 1 of alpha.
        EXPECT_EQ(result.uncertainty->degreesOfFreedom, 200 * wavelengths.size() - 5);
        EXPECT_NEAR(result.uncertainty->reducedChiSquare(), 1, 0.15);
    });
    for (std::size_t i = 0; i < 4; ++i) {
        double mean = 0;
        for (std::size_t d = 0; d < draws; ++d)
            mean += squares[i * draws + d] / static_cast<double>(draws);
        // The mean of 120 squares of normal variables: 1 +- 0.13.
        EXPECT_NEAR(mean, 1, 0.45) << i;
    }
}

// The ends of profiles, with the parameter held there by the specification of the model.
TEST(DispersedFit, ProfilesEndWhereChiSquareHasRisen) {
    const FitSamples samples = spectralSamples(150, 8);
    FitOptions options = optionsOf("ior=cauchy:1,kd=poly:1");
    options.uncertainty.profile = true;
    const FitResult result = fit(samples, options);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < result.parameters.size(); ++i) {
        const std::string& name = result.parameters[i].name;
        if (name != "ggx.ior.A" && name != "ggx.alpha") continue;
        ASSERT_TRUE(result.uncertainty->parameters[i].profile) << name;
        const auto& profile = *result.uncertainty->parameters[i].profile;
        for (const auto& [end, rise] : {std::pair{profile.within68.low, 1.0},
                                        {profile.within95.high, gsl_cdf_chisq_Qinv(0.05, 1)}}) {
            ASSERT_TRUE(end) << name;
            FitOptions held =
                optionsOf(name == "ggx.alpha" ? "ior=cauchy:1,kd=poly:1" : "kd=poly:1");
            held.model += fmt::format(",{}={:.12g}", name == "ggx.alpha" ? "alpha" : "ior", *end);
            const double chiSquare = fit(samples, held).uncertainty->chiSquare;
            EXPECT_NEAR(chiSquare - result.uncertainty->chiSquare, rise, 2e-3 * rise) << name;
            ++compared;
        }
    }
    EXPECT_EQ(compared, 4u);
}

// With noise this small the fit is as good as linear, in terms that several coefficients share too.
TEST(DispersedFit, ProfilesAreTheNormalIntervals) {
    for (const std::string laws : {"ior=cauchy:2,kd=poly:1", "ior=sellmeier:1,kd=spline:4"}) {
        FitOptions options = optionsOf(laws);
        options.uncertainty.profile = true;
        const FitResult result = fit(spectralSamples(150, 9), options);
        for (std::size_t i = 0; i < result.parameters.size(); ++i) {
            const ParameterUncertainty& own = result.uncertainty->parameters[i];
            const std::string& name = result.parameters[i].name;
            ASSERT_TRUE(own.profile && own.profile->within95.low && own.profile->within95.high)
                << laws << " " << name;
            const double value = result.parameters[i].value,
                         half = gsl_cdf_ugaussian_Qinv(0.025) * *own.normal;
            EXPECT_NEAR(*own.profile->within95.high - value, half, 0.05 * half) << name;
            EXPECT_NEAR(value - *own.profile->within95.low, half, 0.05 * half) << name;
        }
    }
}

TEST(DispersedFit, OpensBetweenItsWavelengthsWhereTheLawsAllow) {
    const FitSamples samples = spectralSamples(120, 5);
    const auto presetOf = [&](const FitResult& result, const FitOptions& options) {
        return fitPreset({"data", &samples, options, result, "2%", "", &samples}).dump();
    };
    const FitOptions options = optionsOf("ior=cauchy:2,kd=spline:4");
    const FitResult result = fit(samples, options);
    const std::string text = presetOf(result, options);
    const auto whole = openPreset(text, "f.json");
    EXPECT_EQ(whole->channels().wavelengths, wavelengths);
    const Direction wi = directionFromAngles(0.5, 0), wo = directionFromAngles(0.6, 3);
    // At the wavelengths of the data it is the same, between them near the truth.
    const auto same = openDispersed(text, "f.json", "400:800:50");
    const std::vector<double> a = evaluate(*whole, wi, wo), b = evaluate(*same, wi, wo);
    for (std::size_t c = 0; c < a.size(); ++c) EXPECT_NEAR(a[c], b[c], 1e-9 * a[c]);
    const auto between = openDispersed(text, "f.json", "425/611.5");
    EXPECT_EQ(between->channels().wavelengths, (std::vector<double>{425, 611.5}));
    const std::vector<double> f = evaluate(*between, wi, wo);
    for (std::size_t c = 0; c < 2; ++c) {
        const double expected =
            evaluate(*open(truthAt(between->channels().wavelengths[c])), wi, wo)[0];
        EXPECT_NEAR(f[c], expected, 0.01 * expected);
    }
    const auto refused = [&](const std::string& preset, const std::string& nm,
                             const std::string& part) {
        try {
            openDispersed(preset, "f.json", nm);
            ADD_FAILURE() << nm;
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
        }
    };
    refused(text, "399", "from 400 to 800 nm");
    refused(text, "801", "from 400 to 800 nm");
    const FitOptions freely = optionsOf("ior=cauchy:2");
    const std::string ofFree = presetOf(fit(samples, freely), freely);
    EXPECT_EQ(openDispersed(ofFree, "f.json", "450/500")->channels().count(), 2u);
    refused(ofFree, "425", "lambert.kd=spline");
    const FitOptions plain = optionsOf("");
    refused(presetOf(fit(samples, plain), plain), "450", "no laws");
    nlohmann::json broken = nlohmann::json::parse(text);
    broken["fit"]["dispersion"]["laws"][0]["coefficients"][0] = 1e9;
    EXPECT_THROW(openDispersed(broken.dump(), "f.json", "450"), InputError);
    broken["fit"]["dispersion"]["laws"].erase(1);
    EXPECT_THROW(openDispersed(broken.dump(), "f.json", "450"), InputError);
}

// A polynomial of degree 1 has the values at both ends of the band as coefficients.
TEST(DispersedFit, OpensWithAModelThatStandsTwice) {
    const auto presetOf = [](const std::string& first, const std::string& second) {
        const auto line = [](double nanometres) {
            return nlohmann::json{{"wavelength", nanometres}, {"spec", "lambert:kd=.5"}};
        };
        const auto law = [](const std::string& parameter, double low, double high) {
            return nlohmann::json{
                {"parameter", parameter}, {"law", "poly:1"}, {"coefficients", {low, high}}};
        };
        return nlohmann::json{
            {"format", "hshfit-preset"},
            {"version", 1},
            {"spectrum", {line(400), line(500), line(600)}},
            {"fit",
             {{"model", "lambert + lambert"},
              {"dispersion",
               {{"isotropic", true}, {"laws", {law(first, .1, .3), law(second, .25, .35)}}}}}}}
            .dump();
    };
    // The second is a file without numbers, as earlier versions wrote them.
    for (const auto& [first, second] :
         {std::pair{"lambert1.kd", "lambert2.kd"}, std::pair{"lambert.kd", "lambert.kd"}}) {
        const auto brdf = openDispersed(presetOf(first, second), "f.json", "550");
        EXPECT_NEAR(evaluate(*brdf, {0, 0, 1}, {0, 0, 1})[0], (0.25 + 0.325) / pi, 1e-9) << first;
    }
    EXPECT_THROW(openDispersed(presetOf("lambert2.kd", "lambert1.kd"), "f.json", "550"),
                 InputError);
}

TEST(DispersedFit, MetalsKeepTheirTabulatedIndex) {
    const auto gold = [](double nm) {
        const MetalRow row = indexAt(findMetal("gold"), nm);
        return fmt::format("ggx:fresnel=conductor,ior={},k={},alpha=0.25,ks=0.8", row.n, row.k);
    };
    const FitSamples samples = spectralSamples(120, 6, gold);
    FitOptions options = optionsOf("ks=shared");
    options.model = "ggx:metal=gold,kd=0";
    const FitResult result = fit(samples, options);
    ASSERT_EQ(result.parameters.size(), 2u);
    for (const auto& [name, truth] : {std::pair{"alpha", 0.25}, {"ks", 0.8}}) {
        const FittedParameter& own = parameter(result, name);
        EXPECT_NEAR(own.value, truth, 4 * *own.standardError) << name;
    }
    EXPECT_NEAR(result.uncertainty->reducedChiSquare(), 1, 0.15);
    for (std::size_t c = 0; c < wavelengths.size(); ++c) {
        const MetalRow row = indexAt(findMetal("gold"), wavelengths[c]);
        EXPECT_NE(result.spectrum[c].spec.find(fmt::format("ior={},k={}", row.n, row.k)),
                  std::string::npos)
            << result.spectrum[c].spec;
    }
    // Another metal fits worse.
    options.model = "ggx:metal=iron,kd=0";
    EXPECT_GT(fit(samples, options).uncertainty->chiSquare, 5 * result.uncertainty->chiSquare);
    // The data need wavelengths.
    FitSamples grey = samples.channel(0);
    EXPECT_THROW(fit(grey, options), UsageError);
}

TEST(DispersedFit, BootstrapAndLinearisedErrorsAgree) {
    FitOptions options = optionsOf("ior=cauchy:2,kd=poly:1");
    options.uncertainty.bootstrap = 200;
    const FitSamples samples = spectralSamples(300, 8);
    const FitResult result = fit(samples, options);
    EXPECT_EQ(result.uncertainty->bootstrapDraws, 200u);
    EXPECT_EQ(result.uncertainty->bootstrapFailures, 0u);
    for (std::size_t i = 0; i < result.parameters.size(); ++i) {
        const ParameterUncertainty& own = result.uncertainty->parameters[i];
        // 200 draws give a standard deviation to 5 %.
        EXPECT_NEAR(own.bootstrap->error / *own.sandwich, 1, 0.25) << result.parameters[i].name;
        EXPECT_NEAR(*own.normal / *own.sandwich, 1, 0.25) << result.parameters[i].name;
    }
    std::vector<DirectionPair> pairs;
    for (int k = 1; k < 9; ++k)
        pairs.push_back({directionFromAngles(0.5, 0), directionFromAngles(0.15 * k, pi)});
    const Prediction prediction = predict(result, pairs);
    ASSERT_TRUE(prediction.bootstrap);
    ASSERT_EQ(prediction.channels, wavelengths.size());
    const std::vector<double> f = [&] {
        std::vector<double> all(prediction.values.size());
        const auto brdf = openFit(result);
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            const std::vector<double> own = evaluate(*brdf, pairs[k].wi, pairs[k].wo);
            for (std::size_t c = 0; c < own.size(); ++c) all[c * pairs.size() + k] = own[c];
        }
        return all;
    }();
    for (std::size_t v = 0; v < f.size(); ++v) {
        EXPECT_NEAR(prediction.values[v], f[v], 1e-9 * f[v]);
        EXPECT_NEAR(prediction.bootstrap->errors[v] / prediction.errors[v], 1, 0.3) << v;
    }
}

}  // namespace
}  // namespace hshfit::brdfs
