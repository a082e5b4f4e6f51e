// Every model, and every sum of models, keeps over the grid of its parameters the laws that it
// claims.

#include "models_grid.h"

#include <gtest/gtest.h>

#include <map>

namespace hshfit::brdfs {
namespace {

double relativeDifference(double a, double b) {
    return a == b ? 0 : std::abs(a - b) / std::max(std::abs(a), std::abs(b));
}

/// Largest relative difference over the channels; differences of vanishing values do not count.
double worstDifference(const std::vector<double>& a, const std::vector<double>& b,
                       double negligible = 0) {
    double worst = 0;
    for (std::size_t c = 0; c < a.size(); ++c)
        if (std::max(a[c], b[c]) > negligible)
            worst = std::max(worst, relativeDifference(a[c], b[c]));
    return worst;
}

Direction flippedX(const Direction& d) {
    return {-d.x, d.y, d.z};
}
Direction flippedY(const Direction& d) {
    return {d.x, -d.y, d.z};
}

/// `check(brdf)` for every case of the grid; a failure inside names the specification.
template <class Check>
void forEveryModel(Check check) {
    std::vector<Case> grid = modelGrid();
    for (const Case& c : sumGrid()) grid.push_back(c);
    for (const Case& c : grid) {
        SCOPED_TRACE(c.spec);
        check(*open(c.spec));
    }
}

TEST(ModelLaws, FiniteAndNonNegativeForEveryPairOfUnitDirections) {
    forEveryModel([](const Brdf& brdf) {
        ASSERT_TRUE(brdf.laws().nonNegative);
        std::vector<Pair> pairs = ordinaryPairs(1);
        const std::vector<Direction> extremes = extremeDirections();
        for (const Direction& wo : extremes) {
            pairs.push_back({mirrored(wo), wo});
            for (const Direction& wi : extremes) pairs.push_back({wi, wo});
        }
        for (const Pair& pair : pairs)
            for (const double f : evaluate(brdf, pair.wi, pair.wo)) {
                ASSERT_TRUE(std::isfinite(f))
                    << f << " at wi " << pair.wi.x << " " << pair.wi.y << " " << pair.wi.z
                    << ", wo " << pair.wo.x << " " << pair.wo.y << " " << pair.wo.z;
                ASSERT_GE(f, 0);
            }
    });
}

TEST(ModelLaws, ZeroBelowTheHorizon) {
    forEveryModel([](const Brdf& brdf) {
        for (const Pair& pair : ordinaryPairs(2)) {
            const Direction below{pair.wi.x, pair.wi.y, -pair.wi.z};
            const Direction level{1, 0, 0};
            for (const Direction& low : {below, level}) {
                for (const double f : evaluate(brdf, low, pair.wo)) ASSERT_EQ(f, 0);
                for (const double f : evaluate(brdf, pair.wo, low)) ASSERT_EQ(f, 0);
            }
        }
    });
}

TEST(ModelLaws, ReciprocalWhereClaimed) {
    forEveryModel([](const Brdf& brdf) {
        if (!brdf.laws().reciprocal) return;
        for (const Pair& pair : ordinaryPairs(3))
            ASSERT_LE(
                worstDifference(evaluate(brdf, pair.wi, pair.wo), evaluate(brdf, pair.wo, pair.wi)),
                1e-12);
    });
}

TEST(ModelLaws, MirrorSymmetricWhereClaimed) {
    forEveryModel([](const Brdf& brdf) {
        if (!brdf.laws().mirrorSymmetric) return;
        for (const Pair& p : ordinaryPairs(4)) {
            const std::vector<double> f = evaluate(brdf, p.wi, p.wo);
            ASSERT_LE(worstDifference(f, evaluate(brdf, flippedX(p.wi), flippedX(p.wo))), 1e-14);
            ASSERT_LE(worstDifference(f, evaluate(brdf, flippedY(p.wi), flippedY(p.wo))), 1e-14);
        }
    });
}

// The rotation rounds both directions to 1e-16, which a lobe of width 1e-4 enlarges; where it has
// fallen to 1e-30 the relative error says nothing.
TEST(ModelLaws, IsotropicWhereClaimedAndOnlyThere) {
    forEveryModel([](const Brdf& brdf) {
        Directions directions(5);
        double worst = 0;
        for (const Pair& p : ordinaryPairs(6)) {
            const double angle = directions.uniform(0, 2 * pi);
            worst = std::max(worst, worstDifference(evaluate(brdf, p.wi, p.wo),
                                                    evaluate(brdf, rotateAboutZ(p.wi, angle),
                                                             rotateAboutZ(p.wo, angle)),
                                                    1e-30));
        }
        if (brdf.laws().isotropic)
            EXPECT_LE(worst, 1e-8);
        else
            EXPECT_GE(worst, 1e-3) << "isotropic although it does not say so";
    });
}

TEST(ModelLaws, BatchEqualsSingle) {
    forEveryModel([](const Brdf& brdf) {
        Directions directions(7);
        const Direction wo = directions.next();
        const std::size_t count = 1000, channels = brdf.channels().count();
        std::vector<double> x, y, z, batch(channels * count);
        for (std::size_t k = 0; k < count; ++k) {
            const Direction wi = k % 3 == 0 ? directions.next()
                                            : directions.near(mirrored(wo), k % 3 == 1 ? .1 : 1e-3);
            x.push_back(wi.x), y.push_back(wi.y), z.push_back(k % 10 == 9 ? -wi.z : wi.z);
        }
        brdf.eval(wo, {x.data(), y.data(), z.data(), count}, batch.data());
        for (std::size_t k = 0; k < count; ++k) {
            const std::vector<double> single = evaluate(brdf, {x[k], y[k], z[k]}, wo);
            for (std::size_t c = 0; c < channels; ++c)
                ASSERT_DOUBLE_EQ(batch[c * count + k], single[c]) << "direction " << k;
        }
    });
}

TEST(ModelLaws, NameOpensTheSameBrdf) {
    forEveryModel([](const Brdf& brdf) {
        const std::unique_ptr<Brdf> again = open(brdf.name());
        EXPECT_EQ(again->name(), brdf.name());
        for (const Pair& pair : ordinaryPairs(8))
            ASSERT_EQ(evaluate(brdf, pair.wi, pair.wo), evaluate(*again, pair.wi, pair.wo));
    });
}

TEST(ModelLaws, ClaimsNoLessThanItsTableLine) {
    forEveryModel([](const Brdf& brdf) {
        if (brdf.name().find(" + ") != std::string::npos) return;  // of no single line
        const std::string name = brdf.name().substr(0, brdf.name().find(':'));
        for (const Model& model : models()) {
            if (model.name != name) continue;
            const Laws &row = model.laws, &own = brdf.laws();
            EXPECT_GE(own.nonNegative, row.nonNegative);
            EXPECT_GE(own.reciprocal, row.reciprocal);
            EXPECT_GE(own.isotropic, row.isotropic);
            EXPECT_GE(own.mirrorSymmetric, row.mirrorSymmetric);
            EXPECT_GE(own.energyConserving, row.energyConserving);
            return;
        }
        FAIL() << name << " is not in the table";
    });
}

TEST(ModelLaws, LobesPointUpAndHaveWidth) {
    forEveryModel([](const Brdf& brdf) {
        for (const Direction& wo : extremeDirections())
            for (const Lobe& lobe : brdf.lobes(wo)) {
                EXPECT_GT(lobe.width, 0);
                EXPECT_NEAR(dot(lobe.axis, lobe.axis), 1, 1e-12);
            }
    });
}

TEST(ModelGrid, HoldsEveryModel) {
    std::map<std::string, int> cases;
    for (const Case& c : modelGrid()) ++cases[c.spec.substr(0, c.spec.find(':'))];
    for (const Model& model : models()) EXPECT_GE(cases[std::string(model.name)], 3) << model.name;
    EXPECT_EQ(cases.size(), models().size());
}

// ks scales what is not diffuse, channel by channel.
TEST(ModelLaws, TheLobeIsProportionalToItsScale) {
    for (const char* model :
         {"ggx:alpha=.3,F0=.2/.4/.6", "beckmann:alpha=.3,F0=.3", "gtr:alpha=.3,gamma=1.5,F0=.1",
          "ggx:ax=.1,ay=.4,fresnel=conductor,ior=.2/.9/1.1,k=3.9/2.4/2.1",
          "beckmann:alpha=.2,fresnel=dielectric,ior=1.5"}) {
        SCOPED_TRACE(model);
        const auto whole = open(model), scaled = open(std::string(model) + ",kd=.4,ks=.5/2/.25");
        const double scales[] = {0.5, 2, 0.25};
        for (const Pair& pair : ordinaryPairs(9)) {
            const std::vector<double> one = evaluate(*whole, pair.wi, pair.wo),
                                      other = evaluate(*scaled, pair.wi, pair.wo);
            for (std::size_t c = 0; c < 3; ++c) {
                const double expected = 0.4 / pi + scales[c] * one[one.size() == 1 ? 0 : c];
                EXPECT_NEAR(other[c], expected, 1e-13 * expected);
            }
        }
    }
}

}  // namespace
}  // namespace hshfit::brdfs
