#include <hshfit/error.h>
#include <hshfit/wavelets/slices.h>

#include "lib/formula_brdf.h"

#include <numeric>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

namespace hshfit::wavelets {
namespace {

using Domain = Partition::Domain;

Direction randomDirection(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const Direction d{normal(random), normal(random), normal(random)};
    const double length = std::sqrt(dot(d, d));
    return {d.x / length, d.y / length, d.z / length};
}

double volume(const Direction& a, const Direction& b, const Direction& c) {
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
           a.z * (b.x * c.y - b.y * c.x);
}

/// The sum of the angles less pi, in long double, from tangent vectors at the corners.
double girard(const Triangle& triangle) {
    const auto at = [&](std::size_t i) {
        const Direction& d = triangle.corners[i % 3];
        return std::array<long double, 3>{d.x, d.y, d.z};
    };
    const auto product = [](const auto& a, const auto& b) {
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    };
    long double sum = -std::acos(-1.0L);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto tangent = [&](auto to) {
            const long double along = product(to, at(i));
            for (int k = 0; k < 3; ++k) to[k] -= along * at(i)[k];
            return to;
        };
        const auto u = tangent(at(i + 1)), w = tangent(at(i + 2));
        const long double x = u[1] * w[2] - u[2] * w[1], y = u[2] * w[0] - u[0] * w[2],
                          z = u[0] * w[1] - u[1] * w[0];
        sum += std::atan2(std::sqrt(x * x + y * y + z * z), product(u, w));
    }
    return static_cast<double>(sum);
}

TEST(Subdivision, OuterChildrenHaveEqualAreasAndFillTheParent) {
    const Partition partition(Domain::sphere, 6);
    for (int j = 0; j < 6; ++j) {
        double whole = 0;
        for (std::size_t k = 0; k < partition.level(j).size(); ++k) {
            const Triangle& parent = partition.level(j)[k];
            const Triangle* child = partition.level(j + 1).data() + 4 * k;
            whole += parent.area;
            // Rounding of corners weighs as 1e-16 over the length of a side.
            const double tolerance = 3e-14 * std::ldexp(1, j) * parent.area;
            for (int i = 0; i < 4; ++i) {
                EXPECT_NEAR(areaOf(child[i].corners), child[i].area, tolerance);
                EXPECT_NEAR(girard(child[i]), child[i].area, tolerance + 1e-17 * std::ldexp(1, j));
                EXPECT_GT(child[i].area, 0.15 * parent.area);
            }
            EXPECT_EQ(child[1].area, child[2].area);
            EXPECT_EQ(child[1].area, child[3].area);
            EXPECT_NEAR(child[0].area + 3 * child[1].area, parent.area, 1e-15 * parent.area);
            // New corners lie on the edges.
            for (std::size_t i = 0; i < 3; ++i) {
                const Direction& on = child[0].corners[(i + 2) % 3];
                EXPECT_NEAR(volume(parent.corners[i], parent.corners[(i + 1) % 3], on), 0, 3e-16);
            }
        }
        EXPECT_NEAR(whole, 4 * pi, 1e-12);
    }
    EXPECT_THROW(Partition(Domain::sphere, -1), UsageError);
    EXPECT_THROW(Partition(Domain::sphere, Partition::mostLevels + 1), UsageError);
}

TEST(Subdivision, OctantsAreHalvedOnTheirEdgesAndMirrorImagesAreDividedAlike) {
    const auto children = subdivided(octants()[0]);
    const double half = std::sqrt(0.5);
    for (const Direction& d : children[0].corners) {
        for (const double c : {d.x, d.y, d.z}) {
            EXPECT_LE(std::min(std::abs(c), std::abs(c - half)), 1e-15);
        }
    }
    // Central: three sides of 60 degrees, angles of arccos(1/3).
    EXPECT_NEAR(children[0].area, 3 * std::acos(1.0 / 3) - pi, 1e-14);
    std::mt19937_64 random(4);
    std::uniform_real_distribution<double> unit(0.1, 0.4);
    for (int trial = 0; trial < 100; ++trial) {
        Triangle triangle{
            {directionFromAngles(unit(random), 0), directionFromAngles(unit(random), 2),
             directionFromAngles(unit(random), 4)},
            0};
        triangle.area = areaOf(triangle.corners);
        Triangle mirror = triangle;
        for (Direction& d : mirror.corners) d.y = -d.y;
        std::swap(mirror.corners[1], mirror.corners[2]);
        const auto one = subdivided(triangle), other = subdivided(mirror);
        EXPECT_NEAR(one[1].area, other[1].area, 1e-14 * triangle.area);
        for (int i = 0; i < 3; ++i) {
            // Edge 0-1 of the one is edge 2-0 of the other.
            const Direction& a = one[0].corners[(i + 2) % 3];
            const Direction& b = other[0].corners[(2 - i + 2) % 3];
            EXPECT_NEAR(a.x, b.x, 1e-12);
            EXPECT_NEAR(a.y, -b.y, 1e-12);
        }
    }
}

TEST(Soho, FunctionsAreOrthonormal) {
    for (const Domain domain : {Domain::sphere, Domain::hemisphere}) {
        const Partition partition(domain, 3);
        const std::size_t count = partition.leaves();
        std::vector<std::vector<double>> functions;
        std::vector<double> unit(count);
        for (std::size_t i = 0; i < count; ++i) {
            unit.assign(count, 0.0);
            unit[i] = 1;
            functions.emplace_back(count);
            synthesise(partition, unit.data(), functions.back().data());
        }
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t j = i; j < count; ++j) {
                double sum = 0;
                for (std::size_t k = 0; k < count; ++k) {
                    sum += functions[i][k] * functions[j][k] * partition.level(3)[k].area;
                }
                ASSERT_NEAR(sum, i == j ? 1 : 0, 1e-12) << i << " " << j;
            }
        }
    }
}

TEST(Soho, SynthesisInvertsAnalysisAndEnergiesAgree) {
    const Partition partition(Domain::sphere, 6);
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal;
    std::vector<double> values(partition.leaves()), c(values.size()), back(values.size());
    double energy = 0, own = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        values[k] = normal(random);
        energy += values[k] * values[k] * partition.level(6)[k].area;
    }
    analyse(partition, values.data(), c.data());
    synthesise(partition, c.data(), back.data());
    for (std::size_t k = 0; k < values.size(); ++k) {
        EXPECT_NEAR(back[k], values[k], 1e-12);
        own += c[k] * c[k];
    }
    EXPECT_NEAR(own, energy, 1e-12 * energy);
}

TEST(Soho, WaveletsAreExchangedWithTheOuterTriangles) {
    const Partition partition(Domain::hemisphere, 1);
    std::vector<int> order{1, 2, 3};
    const double values[] = {0.3, -1.2, 2.5, 0.7};
    std::vector<double> averages(16, 0.0), c(16), permuted(16);
    std::copy(std::begin(values), std::end(values), averages.begin() + 8);
    analyse(partition, averages.data(), c.data());
    do {
        for (int i = 0; i < 3; ++i) averages[static_cast<std::size_t>(9 + i)] = values[order[i]];
        analyse(partition, averages.data(), permuted.data());
        EXPECT_NEAR(permuted[2], c[2], 1e-15);
        for (int i = 0; i < 3; ++i) {
            EXPECT_NEAR(permuted[static_cast<std::size_t>(10 + i)],
                        c[static_cast<std::size_t>(10 + order[i] - 1)], 1e-15);
        }
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST(Soho, DirectionsLieInTheLeavesThatAreFound) {
    std::mt19937_64 random(2);
    for (const Domain domain : {Domain::sphere, Domain::hemisphere}) {
        const Partition partition(domain, 5);
        std::vector<double> index(partition.leaves()), c(index.size());
        std::iota(index.begin(), index.end(), 0.0);
        analyse(partition, index.data(), c.data());
        const std::vector<Term> all = bestTerms(c, c.size());
        for (int trial = 0; trial < 3000; ++trial) {
            Direction d = randomDirection(random);
            if (domain == Domain::hemisphere) d.z = std::abs(d.z);
            const double found = valueOf(partition, all, d);
            const auto leaf = static_cast<std::size_t>(std::lround(found));
            ASSERT_LT(leaf, partition.leaves());
            EXPECT_NEAR(found, static_cast<double>(leaf), 1e-8);
            const auto& v = partition.level(5)[leaf].corners;
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_GE(volume(v[i], v[(i + 1) % 3], d), -1e-15);
            }
        }
        // Corners, edges and the poles are in some leaf.
        for (const Direction& d : {Direction{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {-1, 0, 0}}) {
            EXPECT_LT(valueOf(partition, all, d), static_cast<double>(partition.leaves()));
        }
    }
}

TEST(Soho, BestTermsLeaveTheEnergyOfTheOthers) {
    const Partition partition(Domain::hemisphere, 4);
    const auto f = [](const Direction& d) { return std::exp(3 * d.x) + (d.y > 0.2 ? 2 : 0); };
    const std::vector<double> averages = averagesOf(partition, f);
    std::vector<double> c(averages.size()), kept(c.size()), back(c.size());
    analyse(partition, averages.data(), c.data());
    const double energy = std::inner_product(c.begin(), c.end(), c.begin(), 0.0);
    const std::vector<double> captured = capturedByTerms(c, 200);
    for (const std::size_t k : {0, 1, 10, 100, 200}) {
        std::fill(kept.begin(), kept.end(), 0.0);
        const std::vector<Term> terms = bestTerms(c, k);
        ASSERT_EQ(terms.size(), k);
        for (const Term& term : terms) kept[term.index] = term.value;
        synthesise(partition, kept.data(), back.data());
        double left = 0;
        for (std::size_t n = 0; n < back.size(); ++n) {
            const double rest = averages[n] - back[n];
            left += rest * rest * partition.level(4)[n].area;
        }
        EXPECT_NEAR(energy - captured[k], left, 1e-12 * energy);
        // No other choice of as many terms captures more.
        std::vector<double> squares;
        for (const double value : c) squares.push_back(value * value);
        std::sort(squares.rbegin(), squares.rend());
        EXPECT_NEAR(captured[k],
                    std::accumulate(squares.begin(), squares.begin() + static_cast<long>(k), 0.0),
                    1e-12 * energy);
    }
    EXPECT_EQ(bestTerms(c, c.size() + 5).size(), c.size());
    EXPECT_EQ(capturedByTerms(c, c.size() + 1).back(), capturedByTerms(c, c.size()).back());
}

TEST(Soho, ErrorOfSmoothFunctionsHalvesWithEachLevel) {
    // f = x + z^2 over the sphere: the integral of f^2 is 4 pi (1/3 + 1/5).
    const auto f = [](const Direction& d) { return d.x + d.z * d.z; };
    double before = 0;
    for (int levels = 3; levels <= 7; ++levels) {
        const Partition partition(Domain::sphere, levels);
        const std::vector<double> averages = averagesOf(partition, f);
        // Against the function at the corners and edges of leaves: a rule of order 3 (corners 1/20,
        // middles of edges 2/15, centre 9/20).
        double left = 0;
        for (std::size_t k = 0; k < averages.size(); ++k) {
            const Triangle& leaf = partition.level(levels)[k];
            const auto square = [&](const Direction& d) {
                const double rest = f(d) - averages[k];
                return rest * rest;
            };
            double sum = 9.0 / 20 * square(centreOf(leaf));
            for (std::size_t i = 0; i < 3; ++i) {
                const Direction &a = leaf.corners[i], &b = leaf.corners[(i + 1) % 3];
                const Direction middle{a.x + b.x, a.y + b.y, a.z + b.z};
                const double length = std::sqrt(dot(middle, middle));
                sum += square(a) / 20 +
                       2.0 / 15 * square({middle.x / length, middle.y / length, middle.z / length});
            }
            left += sum * leaf.area;
        }
        const double error = std::sqrt(left / (4 * pi * (1.0 / 3 + 1.0 / 5)));
        if (levels > 3) {
            EXPECT_NEAR(before / error, 2, 0.02);
        }
        before = error;
    }
}

TEST(Slices, ALambertianSliceIsFourTermsAndALobeHasItsEnergy) {
    const test::FormulaBrdf lambert([](const Direction&, const Direction&) { return 1 / pi; });
    const SliceCurve flat = sliceCurve(lambert, OutgoingSet::direction(0.5, 0), 6);
    EXPECT_NEAR(flat.energy, 2 / pi, 1e-12);
    for (int k = 0; k <= 6; ++k) EXPECT_NEAR(flat.captured[k], std::min(k, 4) / (2 * pi), 1e-12);
    EXPECT_LE(flat.error, 1e-12);
    // (wi . a)^20 about the normal: the integral of its square is 2 pi / 41; with the cosine,
    // 2 pi / 43.
    const test::FormulaBrdf lobe(
        [](const Direction& wi, const Direction&) { return std::pow(wi.z, 20); });
    for (const Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
        const SliceCurve curve = sliceCurve(lobe, OutgoingSet::direction(0, 0), 400,
                                            {.quantity = quantity, .tolerance = 1e-4});
        const double energy = 2 * pi / (quantity == Quantity::brdf ? 41 : 43);
        EXPECT_NEAR(curve.energy, energy, 3 * curve.error * energy + 1e-12);
        EXPECT_LT(curve.error, 1e-4);
        EXPECT_GT(curve.captured[400], 0.99 * energy);
    }
    const test::FormulaBrdf broken(
        [](const Direction& wi, const Direction&) { return wi.x > 0.9 ? std::nan("") : 1.0; });
    EXPECT_THROW(sliceCurve(broken, OutgoingSet::direction(0, 0), 4), NumericError);
}

TEST(Slices, StoredTermsGiveTheFunctionBackAndCountTheirBytes) {
    const test::FormulaBrdf brdf([](const Direction& wi, const Direction& wo) {
        return 0.1 + std::pow(std::max(0.0, dot(mirrored(wo), wi)), 10);
    });
    const OutgoingSet outgoing = OutgoingSet::elevations(16);
    for (const Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
        const auto source = TermsBrdf::project(brdf, outgoing, quantity, 2000);
        const TermsBrdf single(source, 2000, ValueBytes::single), few(source, 36, ValueBytes::half);
        EXPECT_EQ(single.bytes(), 16u * 2000 * 6);
        EXPECT_EQ(few.bytes(), 16u * 36 * 4);
        // At a stored elevation, turned: the error at the centres of the leaves is what the terms
        // left out carry.
        const Direction stored = outgoing.directions[5];
        const SliceCurve curve =
            sliceCurve(brdf, {.directions = {stored}, .solidAngles = {1}}, 2000,
                       {.quantity = quantity, .firstLevel = 7, .lastLevel = 7});
        const Partition partition(Domain::hemisphere, 7);
        const Direction wo = rotateAboutZ(stored, 0.7);
        for (const auto& [terms, form, rounding] :
             {std::tuple(2000, &single, 1e-6), {36, &few, 2e-3}}) {
            double left = 0;
            for (const Triangle& leaf : partition.level(7)) {
                const Direction wi = rotateAboutZ(centreOf(leaf), 0.7);
                const double scale = quantity == Quantity::brdfCosine ? wi.z : 1;
                const double rest = evaluate(*form, wi, wo)[0] - evaluate(brdf, wi, wo)[0];
                left += rest * rest * scale * scale * leaf.area;
            }
            const double expected = curve.energy - curve.captured[terms];
            EXPECT_NEAR(left, expected, rounding * curve.energy);
            EXPECT_LT(left, (terms == 36 ? 0.3 : 0.01) * curve.energy);
        }
    }
}

}  // namespace
}  // namespace hshfit::wavelets
