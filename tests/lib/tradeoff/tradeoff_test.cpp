// The trade between size, time and error: pairs of directions, errors on them, fronts, and forms
// derived from projections that they share.

#include "lib/formula_brdf.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/named_arrays.h>
#include <hshfit/tradeoff/internal/front.h>
#include <hshfit/tradeoff/kept_projections.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <random>
#include <set>

namespace hshfit::tradeoff {
namespace {

using Kind = Representation::Kind;
using test::FormulaBrdf;

FormulaBrdf constant(double f) {
    const Laws laws{.nonNegative = true,
                    .reciprocal = true,
                    .isotropic = true,
                    .mirrorSymmetric = true,
                    .energyConserving = true};
    return FormulaBrdf([f](const Direction& wi, const Direction&) { return wi.z > 0 ? f : 0; }, {},
                       laws);
}

/// A reciprocal, isotropic lobe about the mirror direction over a diffuse term: a polynomial, of
/// degree 6 in either direction.
FormulaBrdf lobe() {
    const auto f = [](const Direction& wi, const Direction& wo) {
        if (!(wi.z > 0) || !(wo.z > 0)) return 0.0;
        const double cosine = wi.z * wo.z - wi.x * wo.x - wi.y * wo.y;
        return 0.05 + 0.4 * std::pow((1 + cosine) / 2, 6);
    };
    const Laws laws{
        .nonNegative = true, .reciprocal = true, .isotropic = true, .mirrorSymmetric = true};
    return FormulaBrdf(f, {}, laws);
}

std::unique_ptr<Brdf> openNothing(const std::string& spec) {
    throw UsageError("unexpected: " + spec);
}

std::size_t rowOf(const char* metric) {
    return static_cast<std::size_t>(selectMetrics(metric).front() - metricCatalog().data());
}

Sweep smallSweep() {
    Sweep sweep;
    sweep.kinds = {Kind::outgoing, Kind::basis};
    sweep.bases = {"hsh", "zernike"};
    sweep.orders = {2, 4};
    sweep.outgoing = {"6"};
    sweep.ranks = {0, 1};
    sweep.precisions = {Precision::float32, Precision::unorm8};
    sweep.splits = {""};
    return sweep;
}

TEST(Front, HoldsExactlyTheFormsThatNoOtherBeats) {
    std::mt19937 random(5);
    std::uniform_int_distribution<int> some(1, 12);
    for (int trial = 0; trial < 200; ++trial) {
        std::vector<double> costs(25), errors(25);
        for (double& cost : costs) cost = some(random);
        for (double& error : errors) error = some(random);
        const auto front = paretoFront(costs, errors);
        std::set<std::pair<double, double>> expected, found;
        for (std::size_t a = 0; a < costs.size(); ++a) {
            bool beaten = false;
            for (std::size_t b = 0; b < costs.size(); ++b) {
                beaten |= costs[b] <= costs[a] && errors[b] <= errors[a] &&
                          (costs[b] < costs[a] || errors[b] < errors[a]);
            }
            if (!beaten) expected.insert({costs[a], errors[a]});
        }
        for (const std::size_t k : front) found.insert({costs[k], errors[k]});
        EXPECT_EQ(found, expected);
        EXPECT_EQ(found.size(), front.size()) << "a point is there twice";
        for (std::size_t k = 1; k < front.size(); ++k) {
            EXPECT_LT(costs[front[k - 1]], costs[front[k]]);
            EXPECT_GT(errors[front[k - 1]], errors[front[k]]);
        }
    }
}

TEST(Front, IgnoresFormsWhoseErrorIsNoNumber) {
    const std::vector<double> costs{1, NAN, 2, INFINITY}, errors{NAN, 1, 3, 1};
    EXPECT_EQ(paretoFront(costs, errors), (std::vector<std::size_t>{2}));
    EXPECT_FALSE(kneeOf({}, costs, errors));
}

TEST(Front, KneeIsWhereTheSlopeChanges) {
    // Straight on logarithmic axes from (1, 1) to (8, 1e-3), and from there to (1000, 5e-4).
    std::vector<double> costs, errors;
    for (int k = 0; k <= 6; ++k) {
        costs.push_back(std::pow(8, k / 6.0));
        errors.push_back(std::pow(1e-3, k / 6.0));
    }
    for (int k = 1; k <= 6; ++k) {
        costs.push_back(8 * std::pow(125, k / 6.0));
        errors.push_back(1e-3 * std::pow(0.5, k / 6.0));
    }
    const auto front = paretoFront(costs, errors);
    ASSERT_EQ(front.size(), costs.size());
    EXPECT_EQ(kneeOf(front, costs, errors), std::size_t{6});
}

TEST(Front, KneeIsNoPointAboveTheLineBetweenTheEnds) {
    // Errors hardly fall at first, and steeply at the end: the cheapest forms are far from the
    // best.
    const std::vector<double> costs{18, 100, 427, 600}, errors{0.0608, 0.0405, 1.6e-4, 7.5e-5};
    const auto front = paretoFront(costs, errors);
    ASSERT_EQ(front.size(), costs.size());
    EXPECT_EQ(kneeOf(front, costs, errors), std::size_t{3});
    const std::vector<std::size_t> two{0, 3};
    EXPECT_EQ(kneeOf(two, costs, errors), std::size_t{3});
    const std::vector<std::size_t> one{1};
    EXPECT_EQ(kneeOf(one, costs, errors), std::size_t{1});
}

TEST(Pairs, AreUnitVectorsAboveTheHorizonWhoseWeightsAddUp) {
    const PairSample pairs = spreadPairs();
    ASSERT_EQ(pairs.first.size(), pairs.wo.size() + 1);
    ASSERT_EQ(pairs.first.back(), pairs.size());
    double sum = 0;
    std::vector<double> byReplicate(8);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        ASSERT_NEAR(std::hypot(pairs.x[k], pairs.y[k], pairs.z[k]), 1, 1e-12);
        ASSERT_GT(pairs.z[k], 0);
        ASSERT_GT(pairs.weights[k], 0);
        sum += pairs.weights[k];
        byReplicate[pairs.replicate[k]] += pairs.weights[k];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    for (const double share : byReplicate) EXPECT_NEAR(share, 1.0 / 8, 0.005);
    for (std::size_t g = 0; g < pairs.wo.size(); ++g) {
        ASSERT_NEAR(dot(pairs.wo[g], pairs.wo[g]), 1, 1e-12);
        ASSERT_GT(pairs.wo[g].z, 0);
    }
}

/// Means whose values are known: over both hemispheres, of powers of the cosines and of lobes of
/// the half vector, of which a fixed wo at the pole has closed forms.
TEST(Pairs, IntegrateProductsOfCosines) {
    const PairSample pairs = spreadPairs();
    const auto mean = [&](auto f) {
        double sum = 0;
        for (std::size_t g = 0; g < pairs.wo.size(); ++g) {
            for (std::size_t k = pairs.first[g]; k < pairs.first[g + 1]; ++k) {
                sum += pairs.weights[k] *
                       f(Direction{pairs.x[k], pairs.y[k], pairs.z[k]}, pairs.wo[g]);
            }
        }
        return sum;
    };
    EXPECT_NEAR(mean([](auto wi, auto) { return wi.z; }), 0.5, 2e-3);
    EXPECT_NEAR(mean([](auto wi, auto wo) { return wi.z * wo.z; }), 0.25, 2e-3);
    EXPECT_NEAR(mean([](auto wi, auto) { return wi.z * wi.z; }), 1.0 / 3, 2e-3);
    // Azimuths of wi and wo are independent: the mean of sin sin cos(phi_i - phi_o) is 0, and the
    // mean of its square (2/3)(2/3)/2.
    const auto plane = [](auto wi, auto wo) { return wi.x * wo.x + wi.y * wo.y; };
    EXPECT_NEAR(mean(plane), 0, 2e-3);
    EXPECT_NEAR(mean([&](auto wi, auto wo) { return std::pow(plane(wi, wo), 2); }), 2.0 / 9, 2e-3);
}

/// Narrow lobes, against albedos by quadrature that knows where they are.
TEST(Pairs, SeeLobesOfEveryWidth) {
    const PairSample pairs = spreadPairs();
    for (const double alpha : {0.5, 0.1, 0.02, 0.005}) {
        // D(h) / (4 wo.h), GGX: its integral over all wi, those below the horizon included, is the
        // share of D(h) itself, so that with (n.h) it is at most 1, and 1 at the pole.
        const auto f = [alpha](const Direction& wi, const Direction& wo) {
            Direction h{wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
            const double length = std::sqrt(dot(h, h)), z = h.z / length;
            const double t = z * z * (alpha * alpha - 1) + 1;
            const double along = (wo.x * h.x + wo.y * h.y + wo.z * h.z) / length;
            return alpha * alpha / (pi * t * t) * z / (4 * along);
        };
        // The reference: for each wo the integral over h on a fine grid of its slope.
        double expected = 0, found = 0;
        constexpr int heights = 64, slopes = 500, turns = 32;
        for (int o = 0; o < heights; ++o) {
            const Direction wo = directionFromAngles(std::acos((o + 0.5) / heights), 0);
            for (int s = 0; s < slopes; ++s) {
                // The share of D(h) cos h below slope alpha tan is u = t^2 / (1 + t^2).
                const double u = (s + 0.5) / slopes, slope = alpha * std::sqrt(u / (1 - u));
                for (int j = 0; j < turns; ++j) {
                    const Direction h =
                        directionFromAngles(std::atan(slope), (j + 0.5) * 2 * pi / turns);
                    if (2 * dot(wo, h) * h.z - wo.z > 0) expected += 1.0;
                }
            }
        }
        expected /= double(heights) * slopes * turns * 2 * pi;
        std::array<double, 8> replicates{};
        for (std::size_t g = 0; g < pairs.wo.size(); ++g) {
            for (std::size_t k = pairs.first[g]; k < pairs.first[g + 1]; ++k) {
                const double term =
                    pairs.weights[k] * f({pairs.x[k], pairs.y[k], pairs.z[k]}, pairs.wo[g]);
                found += term;
                replicates[pairs.replicate[k]] += 8 * term;
            }
        }
        double variance = 0;
        for (const double each : replicates) variance += (each - found) * (each - found) / 56;
        const double error = std::sqrt(variance) / expected;
        EXPECT_NEAR(found / expected, 1, 4 * error + 2e-3) << "alpha " << alpha;
        EXPECT_LT(error, 0.03) << "alpha " << alpha;
    }
}

TEST(Pairs, BandsAreThoseOfTheEdges) {
    EXPECT_EQ(bandOf({0, 0, 1}), 0u);
    for (std::size_t b = 0; b < bandCount; ++b) {
        const double middle = (bandEdges[b] + bandEdges[b + 1]) / 2 * pi / 180;
        EXPECT_EQ(bandOf(directionFromAngles(middle, 1)), b);
    }
}

TEST(Pairs, GivenOnesKeepTheirWeights) {
    const std::vector<Direction> wi{{0, 0, 1}, {0.6, 0, 0.8}, {0, 0, -1}},
        wo{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    const PairSample pairs = pairsFrom(wi, wo, std::vector<double>{1, 3, 5});
    ASSERT_EQ(pairs.size(), 2u);
    EXPECT_EQ(pairs.wo.size(), 1u);
    EXPECT_DOUBLE_EQ(pairs.weights[1], 0.75);
    EXPECT_THROW(pairsFrom(wi, wo, std::vector<double>{1, 0, 1}), UsageError);
}

/// f = a and g = b everywhere: every metric has a closed form.
TEST(Errors, OfConstantsAreTheirClosedForms) {
    const double a = 0.5 / pi, b = 0.6 / pi;
    const PairReference reference(constant(a), spreadPairs());
    const auto errors = reference.errorsOf(constant(b));
    const auto value = [&](const PairErrors& e, const char* name) {
        return e.values[rowOf(name)].value();
    };
    // Mean of ln(1 + k c) over the hemisphere: the integral over c from 0 to 1.
    const auto meanLog = [](double k) { return ((1 + k) * std::log1p(k) - k) / k; };
    const double uncertainty = errors.all.uncertainty[rowOf("nbrdf")].value();
    EXPECT_NEAR(value(errors.all, "nbrdf"), meanLog(b) - meanLog(a), 4 * uncertainty);
    EXPECT_LT(uncertainty, 1e-2 * value(errors.all, "nbrdf"));
    EXPECT_NEAR(value(errors.all, "relative-l2"), 0.2, 1e-12);
    EXPECT_NEAR(value(errors.all, "captured-energy"), 0.96, 1e-12);
    EXPECT_NEAR(value(errors.all, "albedo"), 0.1, 2e-3);
    EXPECT_NEAR(value(errors.all, "maximum"), b - a, 1e-2 * (b - a));
    EXPECT_EQ(value(errors.all, "reciprocity"), 0);
    EXPECT_EQ(value(errors.all, "negativity"), 0);
    ASSERT_EQ(errors.bands.size(), bandCount);
    for (const PairErrors& band : errors.bands) {
        EXPECT_NEAR(value(band, "relative-l2-cosine"), 0.2, 1e-12);
        EXPECT_NEAR(value(band, "albedo"), 0.1, 6e-3);
    }
}

TEST(Errors, AgreeWithQuadrature) {
    const FormulaBrdf f = lobe();
    const auto form = [] {
        Form made;
        made.outgoing = OutgoingSet::elevations(24).spec();
        made.order = 6;
        return made;
    }();
    const auto g = reconstruct(represent(f, form, openNothing), openNothing);
    const PairReference reference(f, spreadPairs());
    const PairErrors errors = reference.errorsOf(*g).all;
    // Finely over wo: `compare` takes the coefficients' own directions otherwise.
    OutgoingSet set = OutgoingSet::elevations(200);
    const auto names = selectMetrics("relative-l2,relative-l2-cosine,log,low,fores,nbrdf");
    for (const MetricValue& value : compare(f, *g, set, names)) {
        const std::size_t row = rowOf(std::string(value.metric->name).c_str());
        const double uncertainty = errors.uncertainty[row].value();
        EXPECT_NEAR(*errors.values[row], *value.value, 4 * uncertainty + 0.01 * *value.value)
            << value.metric->name;
        EXPECT_LT(uncertainty, 0.05 * *value.value) << value.metric->name;
    }
}

TEST(Errors, ReciprocityIsThatOfTheApproximation) {
    // g = 1 + s (wi.z - wo.z): g(wi,wo) - g(wo,wi) = 2 s (wi.z - wo.z), and the mean of
    // (wi.z - wo.z)^2 over both hemispheres is 1/6.
    const double s = 0.25;
    const FormulaBrdf g(
        [s](const Direction& wi, const Direction& wo) { return 1 + s * (wi.z - wo.z); });
    const double expected = std::sqrt(4 * s * s / 6 / (1 + s * s / 6));
    EXPECT_NEAR(reciprocityError(g), expected, 0.03 * expected);
    EXPECT_EQ(reciprocityError(lobe()), 0);
}

TEST(Errors, RefuseAReferenceThatIsNotFinite) {
    const FormulaBrdf f([](const Direction&, const Direction&) { return NAN; });
    EXPECT_THROW(PairReference(f, spreadPairs()), NumericError);
}

TEST(Cache, DerivedFormsEqualDirectProjections) {
    const FormulaBrdf f = lobe();
    std::vector<Form> forms;
    for (const bases::Entry& entry : bases::catalog()) {
        for (const int order : {2, 3, 5}) {
            if (order > entry.maxOrder) continue;
            Form form;
            form.basis = std::string(entry.name);
            form.order = order;
            form.outgoing = std::string{"4"};
            forms.push_back(form);
            if (!entry.nested) continue;
            form.outgoing.clear();
            form.kind = Kind::basis;
            forms.push_back(form);
        }
    }
    KeptProjections cache(f, {});
    int projections = 0;
    cache.prepare(forms, [&] { ++projections; });
    EXPECT_EQ(static_cast<std::size_t>(projections), KeptProjections::projectionsFor(forms));
    EXPECT_LT(static_cast<std::size_t>(projections), forms.size());
    for (const Form& form : forms) {
        const Representation direct = represent(f, form, openNothing);
        const Representation derived = represent(cache, form);
        ASSERT_EQ(derived.content.index(), direct.content.index()) << optionsOf(form);
        const auto &a = namedArrays(direct)[0].array->values,
                   &b = namedArrays(derived)[0].array->values;
        ASSERT_EQ(a.size(), b.size()) << optionsOf(form);
        double change = 0, norm = 0;
        for (std::size_t k = 0; k < a.size(); ++k) {
            change += (a[k] - b[k]) * (a[k] - b[k]);
            norm += a[k] * a[k];
        }
        // Both quadratures were asked for 1e-6 (both directions: 1e-5).
        EXPECT_LT(std::sqrt(change / norm), form.kind == Kind::basis ? 3e-5 : 3e-6)
            << optionsOf(form);
    }
}

TEST(Sweep, HasEveryConsistentCombinationOnce) {
    const FormulaBrdf f = lobe();
    Sweep sweep;
    sweep.bases = {"hsh", "zernike", "makhotkin"};
    sweep.orders = {3, 4, 5, 6};
    sweep.outgoing = {"8", "16"};
    sweep.halfway = {{6, 3, 1}, {8, 4, 2}};
    sweep.ranks = {0, 1, 2};
    sweep.precisions = {Precision::float32, Precision::half, Precision::unorm8};
    sweep.splits = {"", "diffuse"};
    sweep.windows = {Window::none, Window::hann};
    const std::vector<Form> forms = formsOf(sweep, f);
    std::set<std::string> seen;
    for (const Form& form : forms) {
        EXPECT_NO_THROW(requireConsistent(form, f.laws())) << optionsOf(form);
        EXPECT_TRUE(seen.insert(optionsOf(form)).second) << optionsOf(form);
    }
    const auto count = [&](Kind kind) {
        return std::count_if(forms.begin(), forms.end(),
                             [&](const Form& form) { return form.kind == kind; });
    };
    // Per outgoing direction, everything multiplies: bases, orders, sets, splits, windows, ranks
    // (all are below order^2) and precisions. The other kinds lack some of them.
    EXPECT_EQ(count(Kind::outgoing), 3 * 4 * 2 * 2 * 2 * 3 * 3);
    EXPECT_EQ(count(Kind::basis), 2 * 3 * 4 * 2 * 2 * 3 * 3) << "whole and reciprocal half";
    EXPECT_EQ(count(Kind::halfway), 2 * 2 * 3) << "no window, no rank";
}

class Measured : public testing::Test {
protected:
    static Tradeoff trade(int threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        TradeoffOptions options;
        options.sweep = smallSweep();
        options.timing = false;
        return measure(lobe(), spreadPairs({.incoming = 64}), options, openNothing);
    }
};

TEST_F(Measured, IsTheSameOnAnyNumberOfThreads) {
    const Tradeoff one = trade(1), two = trade(2);
    const Tradeoff *a = &one, *b = &two;
    EXPECT_EQ(tradeoffJson({a, 1}), tradeoffJson({b, 1}));
    EXPECT_EQ(formsCsv({a, 1}), formsCsv({b, 1}));
    EXPECT_EQ(tradeoffPage({a, 1}, {}), tradeoffPage({b, 1}, {}));
}

/// Size and error of each form, from the form itself and nothing else.
TEST_F(Measured, BytesAndErrorsAreThoseOfTheFormMadeByItsOptions) {
    const FormulaBrdf f = lobe();
    const Tradeoff made = trade(2);
    const PairSample pairs = spreadPairs({.incoming = 64});
    ASSERT_TRUE(made.leftOut.empty()) << made.leftOut[0].reason;
    ASSERT_EQ(made.forms.size(), formsOf(smallSweep(), f).size());
    for (std::size_t k = 0; k < made.forms.size(); k += 5) {
        const Representation r = represent(f, made.forms[k].form, openNothing);
        EXPECT_EQ(made.forms[k].bytes, r.bytes()) << made.forms[k].options;
        const auto g = reconstruct(r, openNothing);
        double error = 0;
        for (std::size_t o = 0; o < pairs.wo.size(); ++o) {
            for (std::size_t at = pairs.first[o]; at < pairs.first[o + 1]; ++at) {
                const Direction wi{pairs.x[at], pairs.y[at], pairs.z[at]};
                const double there = evaluate(f, wi, pairs.wo[o])[0] * wi.z;
                const double here = std::max(evaluate(*g, wi, pairs.wo[o])[0], 0.0) * wi.z;
                error += pairs.weights[at] * std::abs(std::log1p(there) - std::log1p(here));
            }
        }
        EXPECT_NEAR(made.errorOf(k), error, 1e-3 * error + 1e-6) << made.forms[k].options;
    }
}

TEST_F(Measured, FrontNamesFormsThatNoOtherBeats) {
    const Tradeoff made = trade(2);
    ASSERT_FALSE(made.byteFront.empty());
    for (const std::size_t k : made.byteFront) {
        for (std::size_t other = 0; other < made.forms.size(); ++other) {
            const bool beats = made.forms[other].bytes <= made.forms[k].bytes &&
                               made.errorOf(other) < made.errorOf(k);
            EXPECT_FALSE(beats) << made.forms[other].options << " beats " << made.forms[k].options;
        }
    }
    EXPECT_TRUE(made.byteKnee);
}

TEST_F(Measured, LeavesOutFormsThatAreTooLarge) {
    TradeoffOptions options;
    options.sweep = smallSweep();
    options.timing = false;
    options.maxBytes = 100;
    const Tradeoff made = measure(lobe(), spreadPairs({.incoming = 16}), options, openNothing);
    for (const auto& form : made.forms) EXPECT_LE(form.bytes, 100u);
    EXPECT_EQ(made.forms.size() + made.beyondBytes, formsOf(options.sweep, lobe()).size());
    EXPECT_GT(made.beyondBytes, 0u);
    options.maxBytes = 1;
    EXPECT_THROW(measure(lobe(), spreadPairs({.incoming = 16}), options, openNothing),
                 NumericError);
}

TEST_F(Measured, LeavesOutFormsThatDoNotExistWithTheReason) {
    TradeoffOptions options;
    options.sweep = smallSweep();
    options.sweep.bases = {"hsh", "lsosh"};
    options.timing = false;
    const Tradeoff made = measure(lobe(), spreadPairs({.incoming = 16}), options, openNothing);
    ASSERT_EQ(made.leftOut.size(), 1u);
    EXPECT_NE(made.leftOut[0].reason.find("orthonormal"), std::string::npos);
    EXPECT_GT(made.leftOut[0].forms, 1u);
}

TEST_F(Measured, TimesEveryForm) {
    TradeoffOptions options;
    options.sweep = smallSweep();
    options.sweep.bases = {"hsh"};
    const Tradeoff made = measure(lobe(), spreadPairs({.incoming = 16}), options, openNothing);
    ASSERT_EQ(made.times.size(), made.forms.size());
    for (const MeasuredTime& time : made.times) {
        for (const PairTime& pair : {time.evaluation.batch, time.evaluation.single}) {
            EXPECT_GT(pair.low, 0);
            EXPECT_LE(pair.low, pair.median);
            EXPECT_LE(pair.median, pair.high);
        }
    }
    EXPECT_FALSE(made.timeFront.empty());
}

TEST_F(Measured, RefusesContradictoryOptions) {
    TradeoffOptions options;
    options.sweep = smallSweep();
    const auto refuses = [&] {
        EXPECT_THROW(measure(lobe(), spreadPairs({.incoming = 4}), options, openNothing),
                     UsageError);
    };
    options.metric = "nbrdf,low";
    refuses();
    options.metric = "nbrdf";
    options.maxNanoseconds = 10;
    refuses();
    options.byTime = true;
    options.timing = false;
    refuses();
    options = {};
    options.sweep.kinds = {};
    refuses();
}

}  // namespace
}  // namespace hshfit::tradeoff
