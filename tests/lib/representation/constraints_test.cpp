#include <hshfit/representation/constraints/constraints.h>

#include <hshfit/error.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/representation/constraints/constraints_cone.h>
#include <hshfit/representation/constraints/internal/constraints_albedo.h>
#include <hshfit/representation/constraints/internal/constraints_both.h>
#include <hshfit/representation/constraints/internal/constraints_least_change.h>
#include <hshfit/representation/split.h>
#include <lib/representation/representation_measures.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace hshfit {
namespace {

using namespace test;

const Window windows[] = {Window::hann, Window::lanczos, Window::bending};

TEST(Window, FactorsAreTheirFormulas) {
    for (int n = 1; n <= 30; ++n) {
        const auto hann = windowFactors(Window::hann, n), sigma = windowFactors(Window::lanczos, n);
        for (int l = 0; l < n; ++l) {
            EXPECT_NEAR(hann[l], std::pow(std::cos(pi * l / (2 * n)), 2), 1e-14);
            // Vieta: sin x / x is the product of cos(x / 2^k).
            double product = 1;
            for (int k = 1; k < 40; ++k) product *= std::cos(pi * l / n / std::pow(2, k));
            EXPECT_NEAR(sigma[l], product, 1e-14);
        }
    }
}

TEST(Window, LeavesBandZeroAndCostsWhatIsMeasured) {
    const FormulaBrdf brdf = glossy(40);
    for (const auto& entry : bases::catalog()) {
        const auto basis = basisOf(entry, 6);
        const Representation before = perOutgoing(brdf, *basis, OutgoingSet::elevations(5));
        for (const Window window : windows) {
            const Representation after = windowed(before, window);
            EXPECT_NEAR(after.steps.at(0).change, measuredChange(before, after),
                        1e-9 + 1e-6 * after.steps[0].change)
                << entry.name << " " << windowName(window);
            EXPECT_GT(after.steps[0].change, 0) << entry.name;
            const Coefficients a = decoded(before), b = decoded(after);
            for (std::size_t o = 0; o < a.outgoing.size(); ++o) {
                EXPECT_EQ(a.at(o, 0)[0], b.at(o, 0)[0]);
                for (std::size_t slot = 1; slot < a.slots(); ++slot) {
                    EXPECT_LE(std::abs(b.at(o, 0)[slot]), std::abs(a.at(o, 0)[slot]));
                }
            }
        }
    }
}

TEST(Window, OfBothDirectionsCostsWhatIsMeasured) {
    const FormulaBrdf round = glossy(10), along = brushed();
    for (const char* name : {"hsh", "sh", "zernike", "makhotkin-flux"}) {
        for (const Brdf* brdf :
             {static_cast<const Brdf*>(&round), static_cast<const Brdf*>(&along)}) {
            for (const bool reciprocal : {false, true}) {
                const auto basis = bases::make(name, brdf == &round ? 5 : 3);
                const Representation before = bothIn(*brdf, *basis, reciprocal);
                for (const Window window : windows) {
                    const Representation after = windowed(before, window);
                    EXPECT_NEAR(after.steps.at(0).change, measuredChange(before, after), 1e-7)
                        << name << " " << windowName(window);
                    EXPECT_EQ(matrixValues(after)[0], matrixValues(before)[0]);
                }
            }
        }
    }
}

TEST(Window, BendingHalvesTheSquaredLaplacian) {
    const auto basis = bases::make("hsh", 8);
    const Representation before = perOutgoing(glossy(60), *basis, OutgoingSet::elevations(6));
    const auto laplacian = [](const Representation& r) {
        const Coefficients c = decoded(r);
        double sum = 0;
        for (std::size_t o = 0; o < c.outgoing.size(); ++o) {
            for (int l = 0; l < c.order; ++l) {
                for (int m = -l; m <= l; ++m) {
                    sum += c.outgoing.solidAngles[o] *
                           std::pow(l * (l + 1) * c.at(o, 0)[slotOf(l, m)], 2);
                }
            }
        }
        return sum;
    };
    EXPECT_NEAR(laplacian(windowed(before, Window::bending)), laplacian(before) / 2,
                1e-9 * laplacian(before));
}

TEST(Window, RefusesWhatHasNoBands) {
    Representation halfway;
    halfway.content = HalfwayArray{};
    EXPECT_THROW(windowed(halfway, Window::hann), UsageError);
    EXPECT_THROW(madeNonNegative(halfway), UsageError);
}

/// Projected gradient (Hildreth) on the dual: slow, but nothing can go wrong.
std::vector<double> slowLeastChange(const std::vector<double>& start,
                                    const std::vector<std::vector<double>>& rows,
                                    const std::vector<double>& bounds) {
    std::vector<double> x = start, multipliers(rows.size(), 0.0);
    for (int sweep = 0; sweep < 200000; ++sweep) {
        double moved = 0;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double norm =
                std::inner_product(rows[k].begin(), rows[k].end(), rows[k].begin(), 0.0);
            const double slack =
                std::inner_product(rows[k].begin(), rows[k].end(), x.begin(), 0.0) - bounds[k];
            const double step = std::max(-multipliers[k], -slack / norm);
            multipliers[k] += step;
            moved = std::max(moved, std::abs(step));
            for (std::size_t i = 0; i < x.size(); ++i) x[i] += step * rows[k][i];
        }
        if (moved < 1e-14) break;
    }
    return x;
}

TEST(LeastChange, IsTheMinimumThatASlowMethodFinds) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (int run = 0; run < 30; ++run) {
        const std::size_t n = 3 + run % 6, count = 2 + run;
        std::vector<double> start(n), bounds(count), inside(n);
        for (double& each : start) each = 3 * normal(random);
        for (double& each : inside) each = normal(random);
        std::vector<std::vector<double>> rows(count, std::vector<double>(n));
        LeastChange program(start);
        for (std::size_t k = 0; k < count; ++k) {
            for (double& each : rows[k]) each = normal(random);
            if (k % 7 == 6) rows[k] = rows[k - 1];  // the same one twice
            bounds[k] = std::inner_product(rows[k].begin(), rows[k].end(), inside.begin(), 0.0) -
                        0.3 * std::abs(normal(random));
            program.add(rows[k], bounds[k]);
            if (k % 5 == 4) program.solve(1e-12);  // goes on from there
        }
        program.solve(1e-12);
        const std::vector<double> expected = slowLeastChange(start, rows, bounds);
        for (std::size_t i = 0; i < n; ++i) {
            EXPECT_NEAR(program.x()[i], expected[i], 1e-7) << run;
        }
    }
}

/// The smallest value of q + added at random pairs, in units of the root mean square of q.
double smallestAtRandom(const Representation& r, int count, const Brdf* added = nullptr) {
    std::mt19937 random(11);
    const auto brdf = reconstruct(r, opensNothing);
    double least = 1e300, squares = 0;
    constexpr int atOnce = 100;
    std::vector<double> x(atOnce), y(atOnce), z(atOnce), f(atOnce * brdf->channels().count());
    for (int k = 0; k < count; k += atOnce) {
        const Direction wo = randomDirection(random);
        for (int j = 0; j < atOnce; ++j) {
            const Direction wi = randomDirection(random);
            x[j] = wi.x, y[j] = wi.y, z[j] = wi.z;
        }
        brdf->eval(wo, {x.data(), y.data(), z.data(), atOnce}, f.data());
        for (std::size_t i = 0; i < f.size(); ++i) {
            const std::size_t j = i % atOnce;
            const double more = added ? evaluate(*added, {x[j], y[j], z[j]}, wo)[0] : 0;
            least = std::min(least, f[i] + more);
            squares += f[i] * f[i] / static_cast<double>(f.size()) * atOnce / count;
        }
    }
    return least / std::sqrt(squares);
}

TEST(NonNegative, HoldsEverywhereAndCostsWhatIsMeasured) {
    const FormulaBrdf round = glossy(60, 0.01), along = brushed();
    for (const auto& entry : bases::catalog()) {
        for (const bool isotropic : {true, false}) {
            const Brdf& brdf = isotropic ? static_cast<const Brdf&>(round) : along;
            const auto basis = basisOf(entry, isotropic ? 7 : 5);
            const auto set = isotropic ? OutgoingSet::elevations(6) : OutgoingSet::parabolic(4, 4);
            const Representation before = perOutgoing(brdf, *basis, set);
            const Representation after = madeNonNegative(before);
            const double tolerance = nonNegativeTolerance;
            EXPECT_GE(smallestAtRandom(after, 100000), -tolerance) << entry.name << isotropic;
            if (entry.maxOrder > 3) {
                EXPECT_LT(smallestAtRandom(before, 100000), -1e-3) << entry.name << isotropic;
            }
            EXPECT_NEAR(after.steps.at(0).change, measuredChange(before, after), 1e-7)
                << entry.name << isotropic;
            // Coefficients that are non-negative already stay as they are.
            EXPECT_LT(madeNonNegative(after).steps.at(1).change, 1e-5) << entry.name;
        }
    }
}

TEST(NonNegative, IsTheNearest) {
    // The projection p of c on a convex cone: (c - p) . p = 0, and (c - p) . y <= 0 for all y in
    // it.
    for (const char* name : {"hsh", "esh", "zernike", "makhotkin"}) {
        const auto basis = bases::make(name, 6);
        const Representation before =
            perOutgoing(glossy(60, 0.01), *basis, OutgoingSet::elevations(8));
        const Coefficients c = decoded(before), p = decoded(madeNonNegative(before));
        const std::size_t slots = c.slots();
        const auto product = [&](const double* a, const double* b) {
            return std::inner_product(a, a + slots, b, 0.0);
        };
        for (std::size_t o = 0; o < c.outgoing.size(); ++o) {
            std::vector<double> rest(slots);
            for (std::size_t i = 0; i < slots; ++i) rest[i] = c.at(o, 0)[i] - p.at(o, 0)[i];
            const double size = std::sqrt(product(rest.data(), rest.data()));
            for (std::size_t y = 0; y < c.outgoing.size(); ++y) {
                const double norm = std::sqrt(product(p.at(y, 0), p.at(y, 0)));
                EXPECT_LE(product(rest.data(), p.at(y, 0)), 1e-4 * size * norm) << name << o << y;
            }
            const double norm = std::sqrt(product(p.at(o, 0), p.at(o, 0)));
            EXPECT_GE(product(rest.data(), p.at(o, 0)), -1e-4 * size * norm) << name << o;
        }
    }
}

TEST(NonNegative, OfBothDirectionsHoldsEverywhere) {
    const FormulaBrdf round = glossy(30, 0.01), along = brushed();
    for (const char* name : {"hsh", "sh"}) {
        for (const bool isotropic : {true, false}) {
            const auto basis = bases::make(name, isotropic ? 5 : 3);
            const Brdf& brdf = isotropic ? static_cast<const Brdf&>(round) : along;
            for (const bool reciprocal : {false, true}) {
                const Representation before = bothIn(brdf, *basis, reciprocal);
                const Representation after = madeNonNegative(before);
                EXPECT_LT(smallestAtRandom(before, 20000), -1e-3) << name;
                EXPECT_GE(smallestAtRandom(after, 100000), -nonNegativeTolerance)
                    << name << isotropic << reciprocal;
                EXPECT_NEAR(after.steps.at(0).change, measuredChange(before, after), 1e-7) << name;
            }
        }
    }
}

TEST(NonNegative, SearchesThatDoNotSettleAreErrors) {
    const FormulaBrdf brdf = glossy(60, 0.01);
    const auto basis = bases::make("hsh", 6);
    const Coefficients c = decoded(perOutgoing(brdf, *basis, OutgoingSet::elevations(2)));
    EXPECT_THROW(NonNegativeCone(*basis, true, true, 1).nearest(c.at(0, 0)), NumericError);
    EXPECT_NO_THROW(NonNegativeCone(*basis, true).nearest(c.at(0, 0)));
    Representation both = bothIn(brdf, *basis, true);
    EXPECT_THROW(constrainBoth(both, {.nonNegative = true, .mostRounds = 1}), NumericError);
    EXPECT_NO_THROW(constrainBoth(both, {.nonNegative = true}));
}

TEST(Energy, TargetsThatDoNotSettleAreErrors) {
    // Two bounds on the same two albedos from either side: each sweep undoes part of the other.
    const std::vector<double> albedos{1, 1}, solidAngles{1, 1};
    const auto bound = [](double first, double second, double most) {
        return InterpolatedBound{{.index = {0, 1}, .weight = {first, second}, .count = 2}, most};
    };
    const std::vector<InterpolatedBound> bounds{bound(0.5, 0.5, 0.4), bound(0.9, 0.1, 0.2)};
    EXPECT_THROW(albedoTargets(albedos, solidAngles, bounds, 1), NumericError);
    const std::vector<double> targets = albedoTargets(albedos, solidAngles, bounds);
    for (const InterpolatedBound& each : bounds) {
        EXPECT_LE(each.lookup.weight[0] * targets[0] + each.lookup.weight[1] * targets[1],
                  each.most + 1e-9);
    }
}

TEST(NonNegative, IncludesTheAddedBrdf) {
    const FormulaBrdf brdf = glossy(60, 0.3);
    const auto open = [](const std::string&) {
        return std::make_unique<FormulaBrdf>(
            [](const Direction&, const Direction&) { return 0.28 / pi; }, FormulaBrdf::Predicate{},
            Laws{.nonNegative = true, .isotropic = true, .mirrorSymmetric = true});
    };
    const Split split = takeOut(brdf, "constant", open);
    const auto basis = bases::make("hsh", 6);
    const Representation before = perOutgoing(*split.remainder, *basis, OutgoingSet::elevations(6));
    const Representation with = madeNonNegative(before, addedTo(*split.remainder));
    const Representation without = madeNonNegative(before);
    EXPECT_GE(smallestAtRandom(with, 100000, addedTo(*split.remainder)), -nonNegativeTolerance);
    EXPECT_LT(with.steps.at(0).change, without.steps.at(0).change);
}

TEST(Energy, MomentsAreThoseOfQuadrature) {
    for (const auto& entry : bases::catalog()) {
        const auto basis = basisOf(entry, 6);
        const HemisphereNodes nodes(Basis::Inner::solidAngle);
        std::vector<double> values(nodes.size() * static_cast<std::size_t>(basis->slots()));
        basis->evaluate(nodes.batch(), values.data());
        for (const Quantity quantity : {Quantity::brdf, Quantity::brdfCosine}) {
            const std::vector<double> moments = albedoMoments(*basis, quantity);
            for (int slot = 0; slot < basis->slots(); ++slot) {
                double sum = 0;
                for (std::size_t k = 0; k < nodes.size(); ++k) {
                    sum += nodes.weights[k] * (quantity == Quantity::brdf ? nodes.z[k] : 1) *
                           values[k * static_cast<std::size_t>(basis->slots()) +
                                  static_cast<std::size_t>(slot)];
                }
                EXPECT_NEAR(moments[static_cast<std::size_t>(slot)], sum, 1e-12) << entry.name;
            }
        }
    }
}

/// The largest excess of the directional albedo over the source's.
double largestExcess(const Representation& r, const Brdf& source,
                     const std::vector<Direction>& directions) {
    const HemisphereNodes nodes(Basis::Inner::projectedSolidAngle);
    const auto brdf = reconstruct(r, opensNothing);
    std::vector<double> f(nodes.size());
    double excess = -1;
    for (const Direction& wo : directions) {
        brdf->eval(wo, nodes.batch(), f.data());
        const double albedo = std::inner_product(f.begin(), f.end(), nodes.weights.begin(), 0.0);
        excess = std::max(excess, albedo - directionalAlbedo(source, wo, 1e-7)[0]);
    }
    return excess;
}

TEST(Energy, StaysBelowTheSourceAtAndBetweenStoredDirections) {
    const FormulaBrdf round = glossy(25), along = brushed();
    double before = -1;
    for (const auto& entry : bases::catalog()) {
        for (const bool isotropic : {true, false}) {
            const Brdf& brdf = isotropic ? static_cast<const Brdf&>(round) : along;
            const auto basis = basisOf(entry, isotropic ? 6 : 3);
            const auto set = isotropic ? OutgoingSet::elevations(7) : OutgoingSet::parabolic(6, 6);
            const Representation plain = perOutgoing(brdf, *basis, set);
            std::vector<Direction> wo;
            std::vector<Direction> checks = albedoChecks(set);
            for (const Direction& d : checks) {
                // The corners of the square lie on the ring, which is in already.
                if (d.z > std::cos(radians(88.9)) || isotropic) wo.push_back(d);
            }
            before = std::max(before, largestExcess(plain, brdf, wo));
            const Representation after = madeEnergyPreserving(plain, brdf);
            EXPECT_LE(largestExcess(after, brdf, wo), 3e-6) << entry.name << isotropic;
            EXPECT_NEAR(after.steps.at(0).change, measuredChange(plain, after), 1e-7)
                << entry.name << isotropic;
            if (entry.maxOrder < 6 || !isotropic) continue;
            const Representation both = madeEnergyPreserving(madeNonNegative(plain), brdf);
            EXPECT_LE(largestExcess(both, brdf, wo), 3e-6) << entry.name;
            EXPECT_GE(smallestAtRandom(both, 20000), -nonNegativeTolerance) << entry.name;
        }
    }
    EXPECT_GT(before, 1e-3);  // so that there was something to do
}

TEST(Energy, OfBothDirectionsStaysBelowTheSource) {
    const FormulaBrdf brdf = glossy(25);
    std::vector<Direction> wo;
    for (int k = 0; k < 200; ++k) wo.push_back(directionFromAngles(radians(89) * k / 199, 0.4));
    double before = -1;
    for (const char* name : {"hsh", "zernike", "esh"}) {
        const auto basis = bases::make(name, 5);
        const Representation plain = bothIn(brdf, *basis, true);
        before = std::max(before, largestExcess(plain, brdf, wo));
        const Representation after = madeEnergyPreserving(plain, brdf);
        EXPECT_LE(largestExcess(after, brdf, wo), 1e-5) << name;
        EXPECT_NEAR(after.steps.at(0).change, measuredChange(plain, after), 1e-7) << name;
        const Representation both = madeEnergyPreserving(madeNonNegative(plain), brdf);
        EXPECT_LE(largestExcess(both, brdf, wo), 1e-5) << name;
        EXPECT_GE(smallestAtRandom(both, 20000), -nonNegativeTolerance) << name;
    }
    EXPECT_GT(before, 1e-4);
}

TEST(Energy, OfOneDirectionIsTheNearest) {
    // On a half-space: the change is along the moments, and the bound is met.
    const FormulaBrdf brdf = glossy(25);
    const auto basis = bases::make("makhotkin", 6);
    const std::vector<double> moments = albedoMoments(*basis, Quantity::brdf);
    for (const double theta : {0.0, 0.6, 1.2}) {
        const auto set = OutgoingSet::direction(theta, 0);
        const Representation plain = perOutgoing(brdf, *basis, set);
        const Coefficients a = decoded(plain), b = decoded(madeEnergyPreserving(plain, brdf));
        const double bound = directionalAlbedo(brdf, set.directions[0], 1e-7)[0];
        const auto albedo = [&](const Coefficients& c) {
            return std::inner_product(moments.begin(), moments.end(), c.at(0, 0), 0.0);
        };
        EXPECT_NEAR(albedo(b), std::min(albedo(a), bound), 2e-6);
        const double norm =
            std::inner_product(moments.begin(), moments.end(), moments.begin(), 0.0);
        const double step = (albedo(a) - albedo(b)) / norm;
        for (std::size_t i = 0; i < moments.size(); ++i) {
            EXPECT_NEAR(a.at(0, 0)[i] - b.at(0, 0)[i], step * moments[i], 1e-12);
        }
    }
}

}  // namespace
}  // namespace hshfit
