// Averages over apertures against closed forms and brute force; slits, stray light and the
// derivatives of the model that an instrument sees.

#include <brdfs/catalog.h>
#include <brdfs/composed/spectrum.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/instrument/instrument_problem.h>
#include <brdfs/fit/instrument/patch_sums.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace hshfit::brdfs {
namespace {

double sumOf(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

Aperture cone(double half) {
    return parseAperture(fmt::format("cone:{}", half));
}

/// Samples at pairs of directions, as if they had been measured.
FitSamples samplesAt(const std::vector<DirectionPair>& pairs) {
    FitSamples samples = unmeasuredSamples(pairs, Channels(), true);
    samples.origin = SampleOrigin::measured;
    samples.values.assign(pairs.size(), 1);
    return samples;
}

/// f as an instrument averages it, with quadratures refined to its tolerance.
std::vector<double> averageOf(const Brdf& brdf, const std::vector<DirectionPair>& pairs,
                              const Instrument& instrument) {
    const FitSamples samples = samplesAt(pairs);
    const PatchSearch search =
        searchLevels(brdf, samples, instrument, std::vector<PatchLevels>(pairs.size()));
    EXPECT_FALSE(search.exhausted);
    return valuesOf(brdf, averaged(samples, instrument, search.levels));
}

/// Midpoints of rings about a direction, by the solid angle between their edges.
PatchNodes midpoints(double half, const Direction& nominal, std::size_t rings) {
    PatchNodes nodes;
    const double theta = polarAngle(nominal), phi = azimuth(nominal);
    const std::size_t turns = 4 * rings;
    for (std::size_t i = 0; i < rings; ++i) {
        const double inner = half * static_cast<double>(i) / static_cast<double>(rings),
                     outer = half * static_cast<double>(i + 1) / static_cast<double>(rings);
        const double r = (inner + outer) / 2;
        for (std::size_t j = 0; j < turns; ++j) {
            const double t = 2 * pi * (static_cast<double>(j) + 0.25) / static_cast<double>(turns);
            // About z, turned by theta about y, then by phi about z.
            const double x = std::sin(r) * std::cos(t), y = std::sin(r) * std::sin(t),
                         z = std::cos(r);
            const Direction d = rotateAboutZ({x * std::cos(theta) + z * std::sin(theta), y,
                                              z * std::cos(theta) - x * std::sin(theta)},
                                             phi);
            if (!(d.z > 0)) continue;
            nodes.directions.push_back(d);
            nodes.weights.push_back(d.z * (std::cos(inner) - std::cos(outer)) * 2 * pi /
                                    static_cast<double>(turns));
        }
    }
    return nodes;
}

double bruteAverage(const Brdf& brdf, const PatchNodes& in, const PatchNodes& out) {
    double sum = 0;
    std::vector<double> x, y, z, f(in.directions.size());
    for (const Direction& d : in.directions) x.push_back(d.x), y.push_back(d.y), z.push_back(d.z);
    for (std::size_t j = 0; j < out.directions.size(); ++j) {
        brdf.eval(out.directions[j], {x.data(), y.data(), z.data(), x.size()}, f.data());
        for (std::size_t i = 0; i < f.size(); ++i) sum += out.weights[j] * in.weights[i] * f[i];
    }
    return sum / (sumOf(in.weights) * sumOf(out.weights));
}

// The projected solid angle of a cone about n is pi sin^2(half) cos(theta).
TEST(Apertures, ConesHaveTheirProjectedSolidAngle) {
    for (const double half : {0.01, 1.0, 20.0, 40.0})
        for (const double theta : {0.0, 1e-9, 30.0, 49.9}) {
            const double expected =
                pi * std::pow(std::sin(radians(half)), 2) * std::cos(radians(theta));
            for (const std::size_t level : {1, 2, 5})
                EXPECT_NEAR(
                    sumOf(patchNodes(cone(half), directionFromAngles(radians(theta), 1), level)
                              .weights),
                    expected, 1e-13 * expected)
                    << half << " " << theta;
        }
}

// A corner's configuration factor, four times: Howell's catalog of configuration factors, B-3.
TEST(Apertures, RectanglesHaveTheirProjectedSolidAngle) {
    const Aperture aperture = parseAperture("rectangle:10x25");
    const double x = std::tan(radians(10)), y = std::tan(radians(25));
    const double a = std::hypot(1, x), b = std::hypot(1, y);
    const double expected = 2 * (x / a * std::atan(y / a) + y / b * std::atan(x / b));
    EXPECT_NEAR(sumOf(patchNodes(aperture, {0, 0, 1}, 6).weights), expected, 1e-9);
    EXPECT_EQ(aperture.half, radians(10));
    EXPECT_EQ(aperture.across, radians(25));
}

// Cones that the horizon cuts, to what is left of them: midpoints in great number.
TEST(Apertures, TheHorizonCutsThem) {
    for (const auto& [half, theta] : {std::pair{5.0, 87.0}, {5.0, 89.99}, {60.0, 50.0}}) {
        const Direction nominal = directionFromAngles(radians(theta), 2);
        const double expected = sumOf(midpoints(radians(half), nominal, 1500).weights);
        EXPECT_NEAR(sumOf(patchNodes(cone(half), nominal, 8).weights), expected, 1e-5 * expected);
        const PatchNodes wide =
            patchNodes(parseAperture(fmt::format("rectangle:{}x1", half)), nominal, 6);
        for (const Direction& d : wide.directions) {
            EXPECT_GT(d.z, 0);
            EXPECT_NEAR(std::hypot(d.x, d.y, d.z), 1, 1e-15);
        }
    }
}

TEST(Apertures, LambertIsUnchanged) {
    const Instrument instrument =
        parseInstrument({.source = "rectangle:2x7", .detector = "cone:25"});
    const double grazing = radians(89.99);
    for (const double f :
         averageOf(*open("lambert:kd=.5"),
                   {{{0, 0, 1}, {0, 0, 1}},
                    {directionFromAngles(0.3, 0), directionFromAngles(1.2, 2)},
                    {directionFromAngles(grazing, 0), directionFromAngles(grazing, pi)}},
                   instrument))
        EXPECT_NEAR(f, 0.5 / pi, 1e-13);
}

// At normal incidence a cosine lobe is cos^n of the polar angle: over a cone about the normal
// 2 (1 - c^(n+2)) / ((n + 2) (1 - c^2)) of its peak, c the cosine of the half angle.
TEST(Apertures, CosineLobesHaveTheirClosedForm) {
    for (const double n : {1.0, 20.0, 1e3, 1e5})
        for (const double half : {0.5, 3.0, 30.0}) {
            // A hundred and sixty times as wide as the lobe: beyond the quadratures.
            if (n > 1e4 && half > 10) continue;
            const auto brdf = open(fmt::format("phong:kd=0,ks=1,exponent={}", n));
            const DirectionPair pair{{0, 0, 1}, {0, 0, 1}};
            const double peak = evaluate(*brdf, pair.wi, pair.wo).front();
            const double c = std::cos(radians(half));
            const double expected = 2 * (1 - std::pow(c, n + 2)) / ((n + 2) * (1 - c * c));
            const Instrument instrument =
                parseInstrument({.detector = fmt::format("cone:{}", half), .tolerance = 1e-6});
            EXPECT_NEAR(averageOf(*brdf, {pair}, instrument).front() / peak, expected,
                        2e-6 * expected)
                << n << " " << half;
        }
}

// Also of a lobe ten times as narrow as the aperture, and of one beside it that touches its rim.
TEST(Apertures, AveragesAreThoseOfBruteForce) {
    const Direction wi = directionFromAngles(radians(40), 0);
    struct Case {
        const char* spec;
        const char *source, *detector;
        double away;  ///< of the nominal direction from the mirror direction, degrees
        double tolerance = 1e-5;
    };
    for (const Case& own :
         {Case{"ggx:ks=1,F0=.9,alpha=.004", "", "cone:2", 0},
          Case{"ggx:ks=1,F0=.9,alpha=.004", "", "cone:2", 2},
          Case{"beckmann:ks=1,F0=.9,alpha=.01", "", "cone:2", 1},
          Case{"lambert:kd=.2 + ggx:ks=1,F0=.9,alpha=.1", "cone:1.5", "cone:3", 4},
          Case{"oren-nayar:kd=.5,sigma=.4", "cone:3", "cone:3", -82, 1e-3}}) {
        const auto brdf = open(own.spec);
        const Direction wo = directionFromAngles(radians(40 + own.away), pi);
        const Instrument instrument = parseInstrument(
            {.source = own.source, .detector = own.detector, .tolerance = own.tolerance});
        const bool two = instrument.source.finite();
        const PatchNodes in = two ? midpoints(instrument.source.half, wi, 24)
                                  : PatchNodes{{wi}, {1}},
                         out = midpoints(instrument.detector.half, wo, two ? 40 : 700);
        const double expected = bruteAverage(*brdf, in, out);
        EXPECT_NEAR(averageOf(*brdf, {{wi, wo}}, instrument).front(), expected,
                    (two ? 4e-4 : 4e-5) * expected)
            << own.spec << " " << own.away;
    }
}

// Box and triangle as wide as the wavelengths are apart, by hand.
TEST(Slits, SharesAreThoseOfTheirIntegrals) {
    const Channels channels = Channels::spectral({400, 410, 420, 430});
    const auto box = slitMatrix(parseSlit("box:10"), channels),
               triangle = slitMatrix(parseSlit("triangle:10"), channels),
               none = slitMatrix({}, channels);
    EXPECT_NEAR(box[4 + 0], 1.0 / 8, 1e-14);
    EXPECT_NEAR(box[4 + 1], 6.0 / 8, 1e-14);
    EXPECT_NEAR(triangle[8 + 1], 1.0 / 6, 1e-14);
    EXPECT_NEAR(triangle[8 + 2], 4.0 / 6, 1e-14);
    // Beyond the last wavelength f stays.
    EXPECT_NEAR(box[0], 7.0 / 8, 1e-14);
    // A straight line keeps its middle; the Gaussian's second moment is given by its width.
    const auto gauss = slitMatrix(parseSlit("gauss:3"), channels);
    double middle = 0;
    for (std::size_t c = 0; c < 4; ++c) {
        middle += gauss[4 + c] * channels.wavelengths[c];
        EXPECT_EQ(none[c * 4 + c], 1);
    }
    EXPECT_NEAR(middle, 410, 1e-10);
    // Half of the mean distance from the middle goes to either neighbour: sigma sqrt(2 / pi) / 20.
    const double sigma = 3 / std::sqrt(8 * std::log(2.0));
    EXPECT_NEAR(gauss[4], sigma * std::sqrt(2 / pi) / 20, 1e-9);
    EXPECT_THROW(slitMatrix(parseSlit("triangle:20"), channels), NumericError);
    EXPECT_THROW(slitMatrix(parseSlit("box:5"), Channels::rgb()), UsageError);
    EXPECT_THROW(slitMatrix(parseSlit("box:5"), Channels::grey()), UsageError);
    EXPECT_THROW(slitMatrix(parseSlit("box:5"), Channels::spectral({500})), UsageError);
}

// The hemisphere's mean radiance is the directional albedo over pi.
TEST(StrayLight, IsTheDirectionalAlbedoOverPi) {
    std::vector<DirectionPair> pairs;
    for (const double theta : {0.0, 30.0, 60.0, 85.0})
        pairs.push_back({directionFromAngles(radians(theta), 0.4), {0, 0, 1}});
    const FitSamples samples = samplesAt(pairs);
    for (const char* spec :
         {"lambert:kd=.5", "ggx:ks=1,F0=.9,alpha=.05", "phong:kd=.1,ks=.4,exponent=40"}) {
        const auto brdf = open(spec);
        const Veil veil = veilOf(*brdf, samples, 1e-5);
        EXPECT_LE(veilChange(veil, *brdf, 1e-5), 1e-5);
        const std::vector<double> means = valuesOf(*brdf, veil.sums);
        for (std::size_t k = 0; k < pairs.size(); ++k) {
            const double albedo = directionalAlbedo(*brdf, pairs[k].wi).front();
            EXPECT_NEAR(means[veil.of[k]], albedo / pi, 3e-5 * albedo) << spec << " " << k;
        }
    }
}

/// Readings of three wavelengths with every term, from another material than the test's.
FitSamples everything(std::mt19937_64& random, std::size_t scans) {
    std::vector<DirectionPair> pairs;
    for (std::size_t s = 0; s < scans; ++s)
        for (int k = 0; k < 6; ++k)
            pairs.push_back(
                {directionFromAngles(0.1 + 0.1 * static_cast<double>(s), 0),
                 directionFromAngles(0.2 * k + 0.1, pi - 0.02 * static_cast<double>(s))});
    FitSamples samples = samplesAt(pairs);
    samples.channels = Channels::spectral({450, 500, 550});
    samples.values.clear();
    for (std::size_t v = 0; v < 3 * pairs.size(); ++v) {
        const double noise = static_cast<double>(random() >> 11) * 0x1p-53;
        samples.values.push_back(0.2 + 0.1 * noise);
        samples.sigmas.push_back(0.01 + 0.01 * noise);
    }
    for (std::size_t k = 0; k < pairs.size(); ++k) samples.scans.push_back(k / 6);
    return samples;
}

TEST(InstrumentProblem, DerivativesMatchDifferencesOfTheCost) {
    std::mt19937_64 random(5);
    const FitSamples samples = everything(random, 5);
    const ParametricSum sum("lambert + ggx", true);
    for (const char* scale : {"", "2%", "fit"}) {
        Readings readings{.samples = samples, .instrument = {}};
        readings.instrument = parseInstrument({.source = "cone:1",
                                               .detector = "rectangle:2x1",
                                               .bandwidth = "triangle:40",
                                               .offset = "fit",
                                               .dark = "fit:both",
                                               .stray = "fit",
                                               .scale = scale});
        readings.samples = averaged(samples, readings.instrument,
                                    std::vector<PatchLevels>(samples.size(), {1, 2}));
        readings.veil = veilOf(*open("ggx:ks=.3,F0=.5,alpha=.2"), samples, 1e-3);
        readings.mix = slitMatrix(readings.instrument.slit, samples.channels);
        const InstrumentProblem problem(readings, sum, Loss::Kind::l2);
        ASSERT_EQ(problem.count(), 2 + 6 + 3 + 3 + 1u);
        // alpha and F0, scales of both lobes, offset, dark signal and stray light.
        std::vector<double> x = {sum.shapes()[0].toScale(0.2),
                                 sum.shapes()[1].toScale(0.4),
                                 .3,
                                 .4,
                                 .5,
                                 .2,
                                 .25,
                                 .3,
                                 .01,
                                 .02,
                                 -.01,
                                 .003,
                                 .002,
                                 .001,
                                 .05};
        const Equations at = problem.equations(x, true);
        for (std::size_t i = 0; i < x.size(); ++i) {
            constexpr double step = 1e-5;
            std::vector<double> above = x, below = x;
            above[i] += step, below[i] -= step;
            const double slope =
                (problem.equations(above, false).cost - problem.equations(below, false).cost) /
                (2 * step);
            EXPECT_NEAR(at.gradient[i], slope, 1e-6 * (1 + std::abs(slope))) << i << scale;
        }
        // Gauss-Newton's matrix of the projected problem leaves no more than the cost.
        EXPECT_EQ(problem.rows(x, false).scales.size(), *scale ? 5u : 1u);
    }
}

// Without anything to fit, a fit of averages by the ordinary equations.
TEST(InstrumentFit, OfAperturesAloneIsThatOfAveragedSamples) {
    std::vector<DirectionPair> pairs;
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 9; ++k)
            pairs.push_back({directionFromAngles(0.25 * i, 0), directionFromAngles(0.15 * k, pi)});
    const Instrument instrument = parseInstrument({.source = "cone:1", .detector = "cone:2.5"});
    FitSamples samples = samplesAt(pairs);
    const auto truth = open("lambert:kd=.4 + ggx:ks=.3,F0=.9,alpha=.08");
    samples.values = averageOf(*truth, pairs, instrument);
    const FitOptions plain{.model = "lambert + ggx:F0=.9", .loss = Loss::Kind::l2, .starts = 4};
    FitOptions options = plain;
    options.instrument = instrument;
    const FitResult result = fit(samples, options), without = fit(samples, plain);
    ASSERT_EQ(result.parameters[0].name, "ggx.alpha");
    // The data were averaged by quadratures of the same tolerance.
    EXPECT_NEAR(result.parameters[0].value, 0.08, 1e-5);
    EXPECT_NEAR(result.parameters[1].value, 0.4, 1e-5);
    EXPECT_NEAR(result.parameters[2].value, 0.3, 1e-4);
    EXPECT_GT(without.parameters[0].value, 0.083);
    EXPECT_LE(result.instrument->averageChange, 1e-4);
    // The preset is the material.
    const Direction wi = directionFromAngles(0.5, 0), wo = directionFromAngles(0.5, pi);
    EXPECT_NEAR(evaluate(*openFit(result), wi, wo).front(), evaluate(*truth, wi, wo).front(), 1e-3);
    // Predictions are readings.
    const std::vector<double> predicted = predictedValues(result, samples);
    for (std::size_t k = 0; k < samples.size(); ++k)
        EXPECT_NEAR(predicted[k], samples.values[k], 2e-4 * samples.values[k]);
}

TEST(InstrumentFit, StatementsThatDoNotFitAreRefused) {
    for (const char* text :
         {"cone", "cone:0", "cone:-1", "cone:90", "cone:100", "cone:nan", "cone:1x2", "rectangle:1",
          "rectangle:1x0", "rectangle:1x90", "disc:1"})
        EXPECT_THROW(parseAperture(text), UsageError) << text;
    for (const char* text : {"box", "box:0", "box:-5", "box:inf", "sinc:5", "triangle:5nm"})
        EXPECT_THROW(parseSlit(text), UsageError) << text;
    for (const InstrumentText& text :
         {InstrumentText{.offset = "x"}, InstrumentText{.dark = "fit:up"},
          InstrumentText{.dark = ":in"}, InstrumentText{.stray = "-0.1"},
          InstrumentText{.stray = "1"}, InstrumentText{.scale = "-2%"},
          InstrumentText{.scale = "0"}, InstrumentText{.scale = "200%"},
          InstrumentText{.offset = "inf"}, InstrumentText{.source = "cone:1", .tolerance = 0}})
        EXPECT_THROW(parseInstrument(text), UsageError);
    std::mt19937_64 random(1);
    FitSamples samples = everything(random, 9);
    FitOptions options{.model = "lambert", .loss = Loss::Kind::l2};
    const auto refused = [&](const InstrumentText& text) {
        options.instrument = parseInstrument(text);
        EXPECT_THROW(fit(samples, options), UsageError);
    };
    options.robust = Robust::huber;
    refused({.offset = "fit"});
    options.robust = Robust::none;
    options.loss = Loss::Kind::log;
    samples.sigmas.clear();
    refused({.offset = "fit"});
    options.loss = Loss::Kind::l2;
    refused({.scale = "2%"});  // without stated uncertainties
    samples.scans.clear();
    refused({.scale = "fit"});
    samples.origin = SampleOrigin::nodes;
    refused({.offset = "0.1"});
}

}  // namespace
}  // namespace hshfit::brdfs
