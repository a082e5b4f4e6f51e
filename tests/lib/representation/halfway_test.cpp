#include "lib/formula_brdf.h"

#include <hshfit/error.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <tuple>

namespace hshfit {
namespace {

using test::FormulaBrdf;

constexpr HalfwaySymmetry symmetries[] = {
    {.isotropic = true, .bilateral = true, .reciprocal = true},
    {.isotropic = true, .bilateral = true, .reciprocal = false},
    {.isotropic = true, .bilateral = false, .reciprocal = true},
    {.isotropic = true, .bilateral = false, .reciprocal = false},
    {.isotropic = false, .bilateral = true, .reciprocal = true},
    {.isotropic = false, .bilateral = true, .reciprocal = false},
    {.isotropic = false, .bilateral = false, .reciprocal = true},
    {.isotropic = false, .bilateral = false, .reciprocal = false},
};

Direction uniform(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double z = 1 - unit(random), turn = 2 * pi * unit(random), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
}

using Key = std::tuple<bool, int, int, int, int, bool, bool, bool>;
Key keyOf(const HalfwayTerm& t) {
    return {t.lobe, t.i, t.j, t.k, t.q, t.exchange, t.mirror, t.sine};
}
std::set<Key> keysOf(const HalfwayTerms& terms) {
    std::set<Key> keys;
    for (const HalfwayTerm& term : terms.list()) keys.insert(keyOf(term));
    return keys;
}

HalfwayLobe lobeFor(const HalfwaySymmetry& symmetry) {
    if (symmetry.isotropic) return {0.25, 0.25, 0};
    return {0.25, 0.125, symmetry.bilateral ? 0.0 : 0.5, 0.05, symmetry.bilateral};
}

/// Random coefficients; both exponents stay within 1.2 of -0.5.
Representation inSpan(const HalfwayOrders& orders, const HalfwaySymmetry& symmetry, int channels) {
    Representation r;
    r.halfway = orders;
    r.head.isotropic = symmetry.isotropic;
    r.head.bilateral = symmetry.bilateral;
    r.head.reciprocal = symmetry.reciprocal;
    r.head.source = "random";
    if (channels == 3) r.head.channels = Channels::rgb();
    if (channels != 3 && channels != 1) {
        std::vector<double> wavelengths;
        for (int c = 0; c < channels; ++c) wavelengths.push_back(400 + 50 * c);
        r.head.channels = Channels::spectral(wavelengths);
    }
    const HalfwayTerms terms(orders, symmetry);
    const auto count = static_cast<std::size_t>(channels);
    StoredArray array{.shape = {count, terms.size()}, .values = {}};
    std::mt19937_64 random(7);
    for (std::size_t c = 0; c < count; ++c) {
        double bounds[2] = {0, 0};
        std::vector<double> row;
        for (const HalfwayTerm& t : terms.list()) {
            const double third = t.lobe ? 1 : 2 * t.k + 1;
            const double largest =
                std::sqrt((2 * t.i + 1) * (2 * t.j + 1) * third * (t.q > 0 ? 2 : 1));
            row.push_back(std::uniform_real_distribution<double>(-1, 1)(random) / largest);
            bounds[t.lobe ? 1 : 0] += std::abs(row.back()) * largest;
        }
        for (std::size_t t = 0; t < row.size(); ++t)
            row[t] *= 1.2 / bounds[terms.list()[t].lobe ? 1 : 0];
        row[0] = row[terms.smooth()] = -0.5;
        array.values.insert(array.values.end(), row.begin(), row.end());
    }
    r.content =
        HalfwayArray{array, lobeFor(symmetry), std::vector<HalfwayCeiling>(count, {1, 1, 100})};
    return r;
}

std::vector<double> numbersOf(const Representation& r) {
    return std::get<HalfwayArray>(r.content).halfway.values;
}

std::unique_ptr<RepresentedBrdf> asBrdf(const Representation& r) {
    return reconstruct(r, [](const std::string&) { return std::unique_ptr<Brdf>(); });
}

TEST(HalfwayTerms, AreThoseOfTheTruncation) {
    const HalfwayOrders n{7, 5, 4};  // three functions of v in the smooth exponent
    for (const HalfwaySymmetry& s : symmetries) {
        std::set<Key> expected;
        for (int bits = 0; bits < 16; ++bits) {
            const bool a = bits & 1, b = bits & 2, sine = bits & 4, lobe = bits & 8;
            for (int q = 0; q <= 10; ++q) {
                if (s.isotropic ? (q > 0 || sine) : (q == 0 && sine)) continue;
                if (s.isotropic && s.bilateral && b) continue;
                if (!s.isotropic && s.bilateral && (q % 2 == 1 || b != sine)) continue;
                if (s.reciprocal && a != b) continue;
                const int turns = s.bilateral ? q / 2 : q;
                for (int i = 0; i < 20; ++i) {
                    for (int j = 0; j < n.difference; ++j) {
                        for (int k = 0; k < n.azimuth; ++k) {
                            const double smooth =
                                (i + 2 * k + 3 * a + 2 * b + 2 * turns) / 4.0 + j / 3.0;
                            const double about =
                                i / 7.0 + j / 5.0 + (k + a + b + turns) * 10 / 12.0;
                            const bool in = lobe ? i < 7 && about <= 1.15 + 1e-12
                                                 : j < 3 && smooth <= 1.2 + 1e-12;
                            if (in) expected.insert({lobe, i, j, k, q, a, b, sine});
                        }
                    }
                }
            }
        }
        const HalfwayTerms terms(n, s);
        EXPECT_EQ(keysOf(terms), expected);
        EXPECT_EQ(terms.size(), expected.size());
        for (std::size_t t = 0; t < terms.size(); ++t)
            EXPECT_EQ(terms.list()[t].lobe, t >= terms.smooth());
    }
}

TEST(HalfwayTerms, OfSmallerOrdersAreAmongThoseOfLargerOnes) {
    for (const HalfwaySymmetry& s : symmetries) {
        const std::set<Key> small = keysOf({{5, 3, 2}, s});
        for (const HalfwayOrders& more :
             {HalfwayOrders{6, 3, 2}, HalfwayOrders{5, 4, 2}, HalfwayOrders{9, 5, 4}}) {
            const std::set<Key> large = keysOf({more, s});
            EXPECT_TRUE(std::includes(large.begin(), large.end(), small.begin(), small.end()));
        }
    }
}

TEST(HalfwayTerms, HaveTheValuesOfTheFormulaInAngles) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    const HalfwayTerms terms({6, 4, 4}, {});
    const HalfwayLobe lobe{0.3, 0.15, 0.4};
    const HalfwayAxes axes(lobe);
    std::vector<double> values(terms.size());
    int tried = 0;
    while (tried < 200) {
        const double th = unit(random) * pi / 2, td = unit(random) * pi / 2;
        const double ph = 2 * pi * unit(random), pd = 2 * pi * unit(random);
        const DirectionPair pair = fromHalfDifference(th, ph, td, pd);
        const double mean = std::cos(th) * std::cos(td);
        const double half = std::sin(th) * std::sin(td) * std::cos(pd);
        if (mean - std::abs(half) < 0.01) continue;
        ++tried;
        const HalfwayPoint point = axes.at(pair.wi, pair.wo);
        terms.evaluate(point, values.data());
        const double handed = -std::sin(th) * std::sin(2 * td) * std::sin(pd);
        const double ei = std::pow(mean - half, 1 / 3.0), eo = std::pow(mean + half, 1 / 3.0);
        const double along = std::sin(th) * std::cos(ph - lobe.turn) / lobe.along;
        const double across = std::sin(th) * std::sin(ph - lobe.turn) / lobe.across;
        // GGX: cos^2 + (slopes over roughnesses)^2 = 1 + Q.
        const double square = std::pow(std::cos(th), 2) + along * along + across * across;
        const double x = std::log(square) / std::log(1 / (0.15 * 0.15));
        const double kappa = std::sin(td) * std::cos(pd);
        const double phi = std::atan2(std::sqrt(1 / (0.15 * 0.15) - 1) * std::sin(ph - lobe.turn),
                                      std::sqrt(1 / (0.3 * 0.3) - 1) * std::cos(ph - lobe.turn));
        const auto p = [](int n, double at) {
            return std::sqrt(2 * n + 1) * std::legendre(static_cast<unsigned>(n), 2 * at - 1);
        };
        for (std::size_t n = 0; n < terms.size(); ++n) {
            const HalfwayTerm& t = terms.list()[n];
            double expected = p(t.j, std::cos(td));
            if (t.lobe) {
                expected *= p(t.i, x);
                if (t.k > 0 || t.exchange) expected *= x * std::pow(kappa, 2 * t.k + t.exchange);
            } else {
                expected *= p(t.i, (ei + eo) / 2) * p(t.k, ei * eo);
                if (t.exchange) expected *= eo - ei;
            }
            if (t.mirror) expected *= handed;
            if (t.q > 0) {
                expected *=
                    std::sqrt(2.0) * x * (t.sine ? std::sin(t.q * phi) : std::cos(t.q * phi));
            }
            EXPECT_NEAR(values[n], expected, 1e-7) << t.lobe << t.i << t.j << t.k << t.q;
        }
        const double distribution = 1 / (pi * 0.3 * 0.15 * square * square);
        const double mi = mean - half, mo = mean + half;
        EXPECT_NEAR(point.weight, distribution * 0.5 / (mi * mo + (mi + mo) / 2 + lobe.shelf),
                    1e-9 * distribution);
    }
}

TEST(HalfwayTerms, RefuseWhatIsTooLarge) {
    EXPECT_THROW(HalfwayTerms({256, 256, 256}, {}), UsageError);
    EXPECT_THROW(HalfwayTerms({0, 2, 2}, {}), UsageError);
    EXPECT_THROW(HalfwayTerms({257, 1, 1}, {}), UsageError);
}

TEST(Halfway, KeepsTheLawsThatItsTermsHave) {
    std::mt19937_64 random(11);
    for (const HalfwaySymmetry& s : symmetries) {
        const auto brdf = asBrdf(inSpan({6, 3, 6}, s, 3));
        double exchanged = 0, turned = 0, mirrored = 0;
        for (int n = 0; n < 200; ++n) {
            const Direction wi = uniform(random), wo = uniform(random);
            const auto f = evaluate(*brdf, wi, wo), back = evaluate(*brdf, wo, wi);
            const auto around = evaluate(*brdf, rotateAboutZ(wi, 1), rotateAboutZ(wo, 1));
            const auto mirror = evaluate(*brdf, {wi.x, -wi.y, wi.z}, {wo.x, -wo.y, wo.z});
            for (int c = 0; c < 3; ++c) {
                EXPECT_GT(f[c], 0);
                exchanged = std::max(exchanged, std::abs(f[c] - back[c]));
                turned = std::max(turned, std::abs(f[c] - around[c]) / f[c]);
                mirrored = std::max(mirrored, std::abs(f[c] - mirror[c]) / f[c]);
            }
        }
        // Exactly where the law holds by the terms, and visibly broken where it does not.
        EXPECT_EQ(exchanged == 0, s.reciprocal) << exchanged;
        EXPECT_EQ(turned < 1e-12, s.isotropic) << turned;
        EXPECT_EQ(mirrored < 1e-12, s.bilateral) << mirrored;
        if (!s.reciprocal) {
            EXPECT_GT(exchanged, 1e-3);
        }
        if (!s.isotropic) {
            EXPECT_GT(turned, 1e-3);
        }
        if (!s.bilateral) {
            EXPECT_GT(mirrored, 1e-3);
        }
    }
}

TEST(Halfway, IsContinuousAtPolesAndHorizon) {
    for (const HalfwaySymmetry& s : symmetries) {
        const auto brdf = asBrdf(inSpan({6, 3, 4}, s, 1));
        const auto at = [&](const Direction& wi, const Direction& wo) {
            return evaluate(*brdf, wi, wo)[0];
        };
        const Direction normal{0, 0, 1};
        const double there = at(normal, normal);
        EXPECT_TRUE(std::isfinite(there));
        for (double turn : {0.1, 2.0, 4.0}) {
            // h at the normal, from all sides.
            for (double tilt : {0.0, 0.7, 1.5}) {
                const auto pole = fromHalfDifference(0, 0, tilt, 0.4);
                const auto near = fromHalfDifference(1e-12, turn, tilt, 0.4 - turn);
                EXPECT_NEAR(at(pole.wi, pole.wo), at(near.wi, near.wo), 1e-4);
            }
            const auto same = fromHalfDifference(0.5, 0.3, 0, 0);
            const auto close = fromHalfDifference(0.5, 0.3, 1e-9, turn);
            EXPECT_NEAR(at(same.wi, same.wo), at(close.wi, close.wo), 1e-7);
            const Direction grazing{std::cos(turn), std::sin(turn), 1e-300};
            EXPECT_TRUE(std::isfinite(at(grazing, normal)));
            EXPECT_TRUE(std::isfinite(at(grazing, grazing)));
            EXPECT_TRUE(std::isfinite(at(grazing, {-grazing.x, -grazing.y, 1e-300})));
            EXPECT_EQ(at({grazing.x, grazing.y, 0}, normal), 0);
            EXPECT_EQ(at(normal, {grazing.x * 0.8, grazing.y * 0.8, -0.6}), 0);
        }
    }
}

TEST(Halfway, FastPathHasTheValuesOfTheSlowOne) {
    std::mt19937_64 random(5);
    for (int channels : {1, 2, 3, 5}) {
        for (const HalfwaySymmetry& s : symmetries) {
            const Representation r = inSpan({9, 4, 4}, s, channels);
            const HalfwayExpansion slow(r);
            const auto fast = halfwayPairEvaluator(r);
            for (std::size_t count : {1, 7, 101}) {
                std::vector<double> d[6];
                for (std::size_t k = 0; k < count; ++k) {
                    Direction wi = uniform(random), wo = uniform(random);
                    if (k % 10 == 3) wi.z = -wi.z;
                    if (k % 10 == 5) wo = {-wi.x, -wi.y, wi.z};
                    if (k % 10 == 6) wi = wo = {0, 0, 1};
                    int axis = 0;
                    for (const double v : {wi.x, wi.y, wi.z, wo.x, wo.y, wo.z}) {
                        d[axis++].push_back(v);
                    }
                }
                std::vector<float> out(count * channels, -1.0F);
                fast->evaluate({d[0].data(), d[1].data(), d[2].data(), count},
                               {d[3].data(), d[4].data(), d[5].data(), count}, out.data());
                std::vector<double> expected(channels);
                for (std::size_t k = 0; k < count; ++k) {
                    slow.evaluate({d[3][k], d[4][k], d[5][k]}, {&d[0][k], &d[1][k], &d[2][k], 1},
                                  expected.data());
                    for (int c = 0; c < channels; ++c) {
                        const double value = out[c * count + k];
                        if (d[2][k] <= 0) {
                            EXPECT_EQ(value, 0);
                        }
                        EXPECT_NEAR(value, expected[c], 1e-5 * (1 + expected[c]));
                    }
                }
            }
        }
    }
}

TEST(Halfway, FitRecoversWhatItsFormHolds) {
    for (const HalfwaySymmetry& s : symmetries) {
        const HalfwayOrders orders = s.isotropic ? HalfwayOrders{6, 4, 4} : HalfwayOrders{5, 3, 3};
        const auto brdf = asBrdf(inSpan(orders, s, 1));
        // The lobe's width is one of a set, not the width of the source: near, not exact.
        const double error = halfwayError(*brdf, projectHalfway(*brdf, orders));
        const double fewer = halfwayError(*brdf, projectHalfway(*brdf, {2, 1, 1}));
        EXPECT_LT(error, s.isotropic ? 6e-3 : 8e-3);
        EXPECT_LT(error, 0.8 * fewer);
    }
}

TEST(Halfway, FitDoesNotDependOnThreads) {
    const auto brdf = asBrdf(inSpan({8, 4, 3}, symmetries[0], 3));
    const auto fit = [&] {
        return numbersOf(projectHalfway(*brdf, {5, 3, 2}, {.maxEvaluations = 1 << 14}));
    };
    const std::vector<double> many = fit();
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(many, fit());
}

TEST(Halfway, HeldOutErrorIsTheMetricOverUniformPairs) {
    // g = 0 for a constant f: the mean of ln(1 + f c) over c uniform in [0, 1] in closed form.
    const double f = 3;
    const FormulaBrdf constant(
        [=](const Direction& wi, const Direction& wo) { return wi.z > 0 && wo.z > 0 ? f : 0.0; });
    Representation none = inSpan({1, 1, 1}, {.isotropic = true}, 1);
    none.as<HalfwayArray>()->ceilings = {{-1e4, -1e4, 1}};
    const double mean = (1 + f) * std::log(1 + f) / f - 1;
    EXPECT_NEAR(halfwayError(constant, none), mean, 1e-4);
    const Representation fitted = projectHalfway(constant, {4, 2, 2});
    EXPECT_LT(fitted.steps.at(0).change, 1e-3);
}

TEST(Halfway, ZeroStaysZeroAndScaleIsCarriedOver) {
    const Laws laws{
        .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};
    const FormulaBrdf zero([](const Direction&, const Direction&) { return 0.0; }, {}, laws);
    EXPECT_EQ(evaluate(*asBrdf(projectHalfway(zero, {4, 3, 2})), {0, 0, 1}, {0, 0, 1})[0], 0);
    const auto lobe = [&](double scale) {
        return FormulaBrdf(
            [=](const Direction& wi, const Direction& wo) {
                if (!(wi.z > 0 && wo.z > 0)) return 0.0;
                const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
                return scale * (0.1 + 2 / std::pow(1 + (x * x + y * y) / (z * z * 0.04), 2));
            },
            {}, laws);
    };
    const Direction wi = directionFromAngles(0.5, 0), wo = directionFromAngles(0.6, 2.9);
    const double one = evaluate(*asBrdf(projectHalfway(lobe(1), {6, 5, 4})), wi, wo)[0];
    for (const double scale : {1e-6, 1e6}) {
        const double other = evaluate(*asBrdf(projectHalfway(lobe(scale), {6, 5, 4})), wi, wo)[0];
        EXPECT_NEAR(other / scale, one, 0.02 * one);
    }
}

TEST(Halfway, ErrorFallsWithBudget) {
    // A microfacet lobe of roughness 0.2 by its distribution alone, and a diffuse floor.
    const FormulaBrdf lobe(
        [](const Direction& wi, const Direction& wo) {
            if (!(wi.z > 0 && wo.z > 0)) return 0.0;
            const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
            return 0.1 + 2 / std::pow(1 + (x * x + y * y) / (z * z * 0.04), 2);
        },
        {}, {.nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true});
    const ProjectionOptions options{.maxEvaluations = 1 << 14};
    double before = 1;
    for (std::size_t bytes : {80, 240, 1000}) {
        const HalfwayOrders orders = chooseHalfwayOrders(lobe, bytes, Precision::float32, options);
        Representation r = projectHalfway(lobe, orders, options);
        quantise(r.as<HalfwayArray>()->halfway, Precision::float32);
        EXPECT_LE(r.bytes(), bytes);
        const double error = halfwayError(lobe, r);
        EXPECT_LT(error, before);
        before = error;
    }
    EXPECT_THROW(chooseHalfwayOrders(lobe, 3, Precision::float32, options), UsageError);
}

TEST(Halfway, TakesHugeValuesAndRefusesNone) {
    const FormulaBrdf huge([](const Direction& wi, const Direction& wo) {
        if (!(wi.z > 0 && wo.z > 0)) return 0.0;
        const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
        const double slope2 = (x * x + y * y) / (z * z);
        return 1e8 / std::pow(1 + slope2 / 1e-4, 2);
    });
    const Representation r = projectHalfway(huge, {9, 4, 3}, {.maxEvaluations = 1 << 14});
    const double peak = evaluate(*asBrdf(r), {0, 0, 1}, {0, 0, 1})[0];
    EXPECT_NEAR(peak / 1e8, 1, 0.05);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const FormulaBrdf broken(
            [=](const Direction& wi, const Direction&) { return wi.z < 0.2 ? bad : 1.0; });
        EXPECT_THROW(projectHalfway(broken, {4, 2, 1}), NumericError);
    }
}

TEST(Halfway, RefusesArraysOfOtherSizes) {
    Representation r = inSpan({4, 2, 2}, symmetries[0], 3);
    r.halfway.half = 5;
    EXPECT_THROW(HalfwayExpansion{r}, InputError);
    EXPECT_THROW(halfwayPairEvaluator(r), InputError);
    r.halfway = {256, 256, 256};
    EXPECT_THROW(HalfwayExpansion{r}, InputError);
    r = inSpan({4, 2, 2}, symmetries[0], 3);
    EXPECT_NO_THROW(HalfwayExpansion{r});
    for (const HalfwayLobe& lobe : {HalfwayLobe{0, 0, 0}, HalfwayLobe{1, 1, 0},
                                    HalfwayLobe{0.2, 0.1, 0}, HalfwayLobe{0.2, 0.2, 1}}) {
        r.as<HalfwayArray>()->lobe = lobe;
        EXPECT_THROW(HalfwayExpansion{r}, InputError);
    }
    r = inSpan({4, 2, 2}, symmetries[0], 3);
    r.as<HalfwayArray>()->ceilings.pop_back();
    EXPECT_THROW(HalfwayExpansion{r}, InputError);
    r.content = CoefficientArray{};
    EXPECT_THROW(HalfwayExpansion{r}, InputError);
    EXPECT_THROW(projectHalfway(*asBrdf(inSpan({2, 2, 2}, {}, 1)), {60, 40, 19}), UsageError);
}

}  // namespace
}  // namespace hshfit
