// The halfway form is bounded by what the BRDF itself reaches at the same elevations.
#include "lib/formula_brdf.h"

#include <hshfit/accuracy/pair_errors.h>
#include <hshfit/error.h>
#include <hshfit/representation/forms/form.h>
#include <hshfit/representation/forms/pair_evaluators.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway.h>
#include <hshfit/representation/halfway/halfway_rounding.h>
#include <hshfit/representation/halfway/internal/halfway_bounds.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace hshfit {
namespace {

using test::FormulaBrdf;

/// A BRDF that is symmetric and isotropic by its formula.
struct Case {
    std::string name;
    std::function<double(const Direction&, const Direction&)> f;
    bool reciprocal = true;
};

double slopeSquared(const Direction& wi, const Direction& wo) {
    const double x = wi.x + wo.x, y = wi.y + wo.y, z = wi.z + wo.z;
    return (x * x + y * y) / (z * z);
}

/// Microfacets with GGX's distribution and, by `power`, (cos_i + cos_o)^power in the denominator:
/// 1 grows towards the horizon as measured metals do.
double facets(const Direction& wi, const Direction& wo, double alpha, double power) {
    const double t = 1 + slopeSquared(wi, wo) / (alpha * alpha);
    return 1 / (pi * alpha * alpha * t * t) / (4 * std::pow(wi.z + wo.z, power));
}

const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {"lambert", [](auto&, auto&) { return 0.2; }},
        {"rough facets", [](auto& i, auto& o) { return 0.05 + facets(i, o, 0.4, 1); }},
        {"narrow facets", [](auto& i, auto& o) { return 0.02 + facets(i, o, 0.05, 1); }},
        {"without shadowing", [](auto& i, auto& o) { return facets(i, o, 0.2, 2); }},
        {"flat", [](auto& i, auto& o) { return 0.1 + facets(i, o, 0.2, 0); }},
        {"minnaert", [](auto& i, auto& o) { return 0.1 / std::sqrt(i.z * o.z); }},
        {"one-sided", [](auto& i, auto& o) { return (0.1 + facets(i, o, 0.2, 0)) / o.z; }, false},
    };
    return all;
}

FormulaBrdf brdfOf(const Case& each) {
    return FormulaBrdf(
        [&each](const Direction& wi, const Direction& wo) {
            return wi.z > 0 && wo.z > 0 ? each.f(wi, wo) : 0.0;
        },
        {},
        {.nonNegative = true,
         .reciprocal = each.reciprocal,
         .isotropic = true,
         .mirrorSymmetric = true});
}

/// From the normal to 89.99 degrees; equal pairs among them.
const std::vector<double>& elevations() {
    static const std::vector<double> all{0,  0.5, 3,  10, 20,   30,   40,    45,   52,
                                         60, 68,  75, 80, 84.5, 87.3, 88.88, 89.6, 89.99};
    return all;
}

/// The greatest f at two elevations over azimuths about wo, the mirror direction among them.
double greatest(const Brdf& brdf, double thetaIncoming, double thetaOutgoing) {
    std::vector<double> x, y, z;
    for (int k = 0; k <= 90; ++k) {
        const double from = pi * std::pow(k / 90.0, 3);
        for (const double phi : {pi - from, pi + from}) {
            const Direction wi = directionFromAngles(radians(thetaIncoming), phi);
            x.push_back(wi.x);
            y.push_back(wi.y);
            z.push_back(wi.z);
        }
    }
    std::vector<double> values(x.size() * brdf.channels().count());
    brdf.eval(directionFromAngles(radians(thetaOutgoing), 0),
              {x.data(), y.data(), z.data(), x.size()}, values.data());
    return *std::max_element(values.begin(), values.end());
}

std::unique_ptr<Brdf> opensNothing(const std::string&) {
    return nullptr;
}

/// The mean over both hemispheres of f cos(theta_i), times 2: albedo / pi.
double meanAlbedoByPi(const Brdf& brdf) {
    const PairSample pairs = spreadPairs();
    const std::vector<double> values = evaluateOn(brdf, pairs);
    double sum = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) sum += pairs.weights[k] * pairs.z[k] * values[k];
    return 2 * sum;
}

class HalfwayBound : public testing::TestWithParam<std::size_t> {};

TEST_P(HalfwayBound, HoldsAtEveryPairOfElevationsInEveryPrecision) {
    const Case& each = cases()[GetParam()];
    const FormulaBrdf brdf = brdfOf(each);
    // A thousandth of albedo / pi is what f counts as where it is darker.
    const double dark = 1.2e-3 * meanAlbedoByPi(brdf);
    for (const HalfwayOrders& orders : {HalfwayOrders{8, 4, 2}, HalfwayOrders{12, 6, 3}}) {
        const Representation fitted =
            projectHalfway(brdf, orders, {.maxEvaluations = 1 << 14}, each.reciprocal);
        for (const Precision precision :
             {Precision::float32, Precision::half, Precision::unorm16, Precision::unorm8}) {
            Representation stored = fitted;
            quantise(stored.as<HalfwayArray>()->halfway, precision);
            const auto made = reconstruct(stored, opensNothing);
            for (const double i : elevations()) {
                for (const double o : elevations()) {
                    double allowed = greatest(brdf, i, o);
                    if (each.reciprocal) allowed = std::max(allowed, greatest(brdf, o, i));
                    EXPECT_LE(greatest(*made, i, o), 1.5 * std::max(allowed, dark))
                        << each.name << " at " << i << ", " << o << " in "
                        << precisionName(precision);
                }
            }
        }
    }
}

/// The greatest f over all azimuths of the cases above, from below, over a cell of elevations: the
/// cosine of the lower one is at most high^4, and the other is apart from it by at most d1. All the
/// formulas fall with the slope of the half vector, least at the mirror azimuth: tan(d / 2); and
/// with the cosines.
double leastGreatest(const Case& each, double high, double d1, bool outgoingLower) {
    const double lower = std::pow(high, 4);
    const double lowest = std::acos(std::min(1.0, std::pow(high, 4)));
    const double upper = std::cos(std::max(0.0, lowest - d1));
    const double t2 = std::pow(std::tan(d1 / 2), 2);
    const double sum = lower + upper;
    const auto lobe = [&](double alpha, double power) {
        const double t = 1 + t2 / (alpha * alpha);
        return 1 / (pi * alpha * alpha * t * t) / (4 * std::pow(sum, power));
    };
    if (each.name == "lambert") return 0.2;
    if (each.name == "rough facets") return 0.05 + lobe(0.4, 1);
    if (each.name == "narrow facets") return 0.02 + lobe(0.05, 1);
    if (each.name == "without shadowing") return lobe(0.2, 2);
    if (each.name == "flat") return 0.1 + lobe(0.2, 0);
    if (each.name == "minnaert") return 0.1 / std::sqrt(lower * upper);
    return (0.1 + lobe(0.2, 0)) / (outgoingLower ? lower : upper);
}

/// ln E is bilinear over x and b: its greatest value over a rectangle is at a corner or where a
/// line of nodes meets an edge.
double greatestLog(const HalfwayEnvelope& envelope, double a0, double a1, double b0, double b1) {
    const double r = envelope.ridge();
    const auto xOf = [&](double a) { return a * (1 + r) / (std::abs(a) + r); };
    const auto aOf = [&](double x) { return x * r / (1 + r - std::abs(x)); };
    const auto cuts = [](double from, double to, double first, std::size_t nodes) {
        std::vector<double> at{from, to};
        for (std::size_t n = 0; n < nodes && nodes > 1; ++n) {
            const double node = first + (1 - first) * double(n) / double(nodes - 1);
            if (node > from && node < to) at.push_back(node);
        }
        return at;
    };
    double most = -1e300;
    for (const double x :
         cuts(xOf(a0), xOf(a1), envelope.reciprocal() ? 0 : -1, envelope.nodesAlongA())) {
        for (const double b : cuts(b0, b1, 0, envelope.nodesAlongB()))
            most = std::max(most, envelope.logAt(envelope.mixAt({aOf(x), b}), 0));
    }
    return most;
}

/// The largest E over the greatest f at the same elevations, bracketed from above over the whole
/// domain: a cell that is not within `allowed` is divided into four, down to 2^-deepest of the
/// axes.
struct Bracket {
    static constexpr int deepest = 11;
    const Case& each;
    const HalfwayEnvelope& envelope;
    double dark, allowed, worst = 0;
    std::size_t cells = 0, beyond = 0;
    double worstB = 0, worstD = 0;

    /// The coordinate b of the lower direction: t from 0 to 1 is its elevation, to 60 degrees; from
    /// there to 2 it is b, down to the horizon. Cells are small at either end.
    static double placeOf(double t) {
        const double edge = std::pow(0.5, 0.25);
        return t < 1 ? std::pow(std::cos(t * pi / 3), 0.25) : edge * (2 - t);
    }
    /// t in [t0, t1], distance of elevations in [d0, d1].
    void over(double t0, double t1, double d0, double d1, int depth) {
        const double b0 = placeOf(t1), b1 = placeOf(t0);
        // The other direction would be above the normal.
        if (d0 > std::acos(std::pow(b0, 4))) return;
        double ratio = 0;
        const double a0 = std::sqrt(1 - std::cos(d0)), a1 = std::sqrt(1 - std::cos(d1));
        for (const bool outgoingLower : {true, false}) {
            double source = leastGreatest(each, b1, d1, outgoingLower);
            if (envelope.reciprocal())
                source = std::max(source, leastGreatest(each, b1, d1, !outgoingLower));
            const bool negative = outgoingLower && !envelope.reciprocal();
            const double log = negative ? greatestLog(envelope, -a1, -a0, b0, b1)
                                        : greatestLog(envelope, a0, a1, b0, b1);
            ratio = std::max(ratio, std::exp(log) / std::max(source, dark));
        }
        if (ratio <= allowed || depth == deepest) {
            ++cells;
            beyond += ratio > allowed;
            if (ratio > worst) {
                worst = ratio;
                worstB = b0;
                worstD = d0;
            }
            return;
        }
        const double t = (t0 + t1) / 2, d = (d0 + d1) / 2;
        over(t0, t, d0, d, depth + 1);
        over(t, t1, d0, d, depth + 1);
        over(t0, t, d, d1, depth + 1);
        over(t, t1, d, d1, depth + 1);
    }
};

TEST_P(HalfwayBound, IsBracketedOverAllElevations) {
    const Case& each = cases()[GetParam()];
    const FormulaBrdf brdf = brdfOf(each);
    const double dark = 1.2e-3 * meanAlbedoByPi(brdf);
    for (const HalfwayOrders& orders : {HalfwayOrders{6, 3, 2}, HalfwayOrders{12, 6, 3}}) {
        const Representation fitted =
            projectHalfway(brdf, orders, {.maxEvaluations = 1 << 14}, each.reciprocal);
        const HalfwayExpansion expansion(fitted);
        Bracket bracket{
            .each = each, .envelope = expansion.envelope(), .dark = dark, .allowed = 1.5};
        bracket.over(0, 2, 0, pi / 2, 0);
        EXPECT_EQ(bracket.beyond, 0)
            << each.name << ": up to " << bracket.worst << " in " << bracket.cells
            << " cells, at b " << bracket.worstB << ", distance " << bracket.worstD;
    }
}

/// The share of uniform light that is reflected: the mean of f cos(theta_i) cos(theta_o), times 4
/// pi.
double reflectance(const Brdf& brdf) {
    const PairSample pairs = spreadPairs();
    const std::vector<double> values = evaluateOn(brdf, pairs);
    double sum = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        sum += pairs.weights[k] * pairs.z[k] * pairs.outgoing(k).z * values[k];
    }
    return 4 * pi * sum;
}

TEST_P(HalfwayBound, LeavesTheReflectanceInEveryPrecision) {
    const Case& each = cases()[GetParam()];
    const FormulaBrdf brdf = brdfOf(each);
    const Representation fitted =
        projectHalfway(brdf, {12, 6, 3}, {.maxEvaluations = 1 << 15}, each.reciprocal);
    const double expected = reflectance(brdf);
    for (const Precision precision :
         {Precision::float32, Precision::half, Precision::unorm16, Precision::unorm8}) {
        Representation stored = fitted;
        quantiseHalfway(stored, precision, brdf);
        EXPECT_NEAR(reflectance(*reconstruct(stored, opensNothing)), expected, 0.02 * expected)
            << each.name << " in " << precisionName(precision);
        // As many bytes as by itself, and no more of the loss but what albedo takes.
        Representation plain = fitted;
        quantise(plain.as<HalfwayArray>()->halfway, precision);
        EXPECT_EQ(stored.bytes(), plain.bytes());
        EXPECT_LE(halfwayError(brdf, stored), 1.1 * halfwayError(brdf, plain) + 1e-6)
            << each.name << " in " << precisionName(precision);
        // The bytes decode to the same numbers.
        StoredArray& array = stored.as<HalfwayArray>()->halfway;
        const std::vector<double> values = array.values;
        const std::vector<std::byte> bytes = packed(array);
        unpackInto(array, bytes, false, "packed");
        for (std::size_t k = 0; k < values.size(); ++k) {
            EXPECT_NEAR(array.values[k], values[k], 1e-12 * (1 + std::abs(values[k])));
        }
    }
}

/// No node of an envelope is lower than it has to be: where one lies below the greatest f of a
/// point, another point that it weighs in has reached its bound.
TEST_P(HalfwayBound, KeepsNoNodeLowerThanItsPointsAsk) {
    const Case& each = cases()[GetParam()];
    const HalfwayBounds bounds = boundsOf(brdfOf(each), each.reciprocal, 1e-6);
    constexpr std::size_t alongB = 6;
    const std::size_t alongA = each.reciprocal ? 7 : 13;
    const StoredArray logs = fitEnvelope(bounds, alongA, alongB, 0.1);
    const HalfwayEnvelope grid({logs, 0.1}, 1, each.reciprocal, "");
    std::vector<double> wanted(alongA * alongB), room(alongA * alongB, 1e9);
    for (std::size_t s = 0; s < bounds.points.size(); ++s) {
        const HalfwayEnvelope::Mix mix = grid.mixAt(bounds.points[s]);
        const double shortage = bounds.logs[s] - grid.logAt(mix, 0);
        for (std::size_t n = 0; n < 4; ++n) {
            if (!(mix.weight[n] > 1e-3)) continue;
            wanted[mix.node[n]] = std::max(wanted[mix.node[n]], mix.weight[n] * shortage);
            room[mix.node[n]] = std::min(room[mix.node[n]], std::log(boundFactor) + shortage);
        }
    }
    // The bound leaves a tenth to what lies between the points and to rounding to eight bits.
    for (std::size_t node = 0; node < wanted.size(); ++node)
        EXPECT_LE(std::min(wanted[node], room[node] - 0.1), 0.06) << each.name << ", " << node;
}

INSTANTIATE_TEST_SUITE_P(EveryCase, HalfwayBound, testing::Range(std::size_t{0}, cases().size()));

/// An expansion that is huge everywhere, cut off at an envelope of random nodes.
Representation unbounded(std::size_t alongX, std::size_t alongB, bool reciprocal) {
    Representation r;
    r.halfway = {2, 2, 1};
    r.head.isotropic = r.head.bilateral = true;
    r.head.reciprocal = reciprocal;
    r.head.channels = Channels::rgb();
    r.head.source = "huge";
    const HalfwayTerms terms(r.halfway, {true, true, reciprocal});
    StoredArray values{.shape = {3, terms.size()}, .values = std::vector<double>(3 * terms.size())};
    for (std::size_t c = 0; c < 3; ++c) values.values[c * terms.size()] = 60;
    StoredArray logs{.shape = {alongB, alongX, 3},
                     .values = std::vector<double>(alongB * alongX * 3)};
    std::mt19937_64 random(3);
    for (double& log : logs.values) log = std::uniform_real_distribution<double>(-3, 5)(random);
    r.content = HalfwayArray{values, EnvelopeArray{logs, 0.1}};
    return r;
}

Direction uniform(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double z = 1 - unit(random), turn = 2 * pi * unit(random), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
}

TEST(HalfwayEnvelope, IsBilinearInTheCoordinatesOfItsFormulaByEitherPath) {
    std::mt19937_64 random(5);
    for (const bool reciprocal : {true, false}) {
        for (const auto& size :
             {std::pair<std::size_t, std::size_t>{1, 1}, {5, 4}, {1, 3}, {13, 1}}) {
            const std::size_t alongX = size.first, alongB = size.second;  // clang 14 captures these
            const Representation r = unbounded(alongX, alongB, reciprocal);
            const std::vector<double>& logs = r.as<HalfwayArray>()->envelope->logs.values;
            const HalfwayExpansion slow(r);
            const auto fast = halfwayPairEvaluator(r);
            for (int n = 0; n < 200; ++n) {
                const Direction wi = uniform(random),
                                wo = n % 5 == 0 ? Direction{-wi.x, -wi.y, wi.z} : uniform(random);
                const double apart = polarAngle(wo) - polarAngle(wi);
                const double a = std::sqrt(1 - std::cos(apart)), x = a * 1.1 / (a + 0.1);
                const double b = std::pow(std::min(wi.z, wo.z), 0.25);
                const double signedX = apart > 0 ? -x : x;
                const double u = (reciprocal ? x : (signedX + 1) / 2) * double(alongX - 1);
                const double v = b * double(alongB - 1);
                const auto node = [&](std::size_t i, std::size_t j, std::size_t c) {
                    return logs[(std::min(j, alongB - 1) * alongX + std::min(i, alongX - 1)) * 3 +
                                c];
                };
                std::array<double, 3> out{};
                slow.evaluate(wo, {&wi.x, &wi.y, &wi.z, 1}, out.data());
                std::array<float, 3> quick{};
                fast->evaluate({&wi.x, &wi.y, &wi.z, 1}, {&wo.x, &wo.y, &wo.z, 1}, quick.data());
                const auto i = static_cast<std::size_t>(u), j = static_cast<std::size_t>(v);
                const double p = u - double(i), q = v - double(j);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double expected =
                        std::exp((1 - q) * ((1 - p) * node(i, j, c) + p * node(i + 1, j, c)) +
                                 q * ((1 - p) * node(i, j + 1, c) + p * node(i + 1, j + 1, c)));
                    EXPECT_NEAR(out[c], expected, 1e-6 * expected);
                    EXPECT_NEAR(quick[c], expected, 2e-2 * expected);
                }
            }
        }
    }
}

TEST(HalfwayEnvelope, IsNotRoundedWithTheRestAndCountsItsBytes) {
    const Case& each = cases()[1];
    const FormulaBrdf brdf = brdfOf(each);
    Form form;
    form.kind = Representation::Kind::halfway;
    form.halfway = {6, 3, 2};
    form.precision = Precision::half;
    const Representation r = represent(brdf, form, opensNothing, {.maxEvaluations = 1 << 14});
    const auto& arrays = *r.as<HalfwayArray>();
    EXPECT_EQ(arrays.halfway.precision, Precision::half);
    EXPECT_EQ(arrays.envelope->logs.precision, Precision::unorm8);
    EXPECT_EQ(r.bytes(), storedBytes(arrays.halfway) + storedBytes(arrays.envelope->logs) + 4);
}

TEST(HalfwayEnvelope, RefusesOtherShapesAndRidges) {
    const auto fails = [](const std::function<void(EnvelopeArray&)>& spoil) {
        Representation r = unbounded(5, 4, true);
        spoil(*r.as<HalfwayArray>()->envelope);
        EXPECT_THROW(HalfwayExpansion{r}, InputError);
        EXPECT_THROW(halfwayPairEvaluator(r), InputError);
    };
    fails([](EnvelopeArray& e) { e.logs.shape = {20, 3}; });
    fails([](EnvelopeArray& e) { e.logs.shape = {4, 5, 2}; });
    fails([](EnvelopeArray& e) { e.logs.shape = {0, 5, 3}; });
    fails([](EnvelopeArray& e) { e.logs.values.pop_back(); });
    fails([](EnvelopeArray& e) { e.ridge = 0; });
    fails([](EnvelopeArray& e) { e.ridge = std::nan(""); });
}

}  // namespace
}  // namespace hshfit
