#include <brdfs/catalog.h>
#include <brdfs/measured/merl_layout.h>
#include <brdfs/repair.h>
#include <hshfit/projection/albedo.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>
#include <lib/formula_brdf.h>

#include <cmath>
#include <random>

namespace hshfit {
namespace {

using Formula = test::FormulaBrdf;

std::unique_ptr<brdfs::RepairedBrdf> repairedFormula(const char* repairs, Formula::Function f,
                                                     Formula::Predicate covers = {},
                                                     bool isotropic = true) {
    return brdfs::repaired(std::make_unique<Formula>(f, covers, Laws{.isotropic = isotropic},
                                                     Channels::spectral({500, 600})),
                           repairs);
}

double cosineOfThetaDifference(const Direction& wi, const Direction& wo) {
    return std::sqrt((1 + dot(wi, wo)) / 2);
}

template <class Check>
void forPairs(Check check) {
    std::mt19937 random(7);
    for (int i = 0; i < 500; ++i)
        check(test::randomDirection(random, 0.01), test::randomDirection(random, 0.01));
}

// f depends on theta_h alone, which the continuation holds: it is filled in exactly.
TEST(Repair, missingContinuesAlongThetaDifference) {
    const auto f = [](const Direction& wi, const Direction& wo) {
        const double length = std::sqrt(2 + 2 * dot(wi, wo));
        return std::pow((wi.z + wo.z) / length, 5);
    };
    const auto covered = [](const Direction& wi, const Direction& wo) {
        return cosineOfThetaDifference(wi, wo) > std::cos(radians(40));
    };
    const auto holed = [&](const Direction& wi, const Direction& wo) {
        return covered(wi, wo) ? f(wi, wo) : -7;
    };
    const auto brdf = repairedFormula("missing", holed, covered);
    std::uint64_t evaluated = 0, changed = 0;
    forPairs([&](const Direction& wi, const Direction& wo) {
        EXPECT_NEAR(evaluate(*brdf, wi, wo)[0], f(wi, wo), 1e-12);
        evaluated += 2;
        changed += covered(wi, wo) ? 0 : 2;
    });
    EXPECT_EQ(brdf->evaluated(), evaluated);
    ASSERT_EQ(brdf->counts().size(), 1u);
    EXPECT_EQ(brdf->counts()[0].changed, changed);
    EXPECT_EQ(brdf->counts()[0].left, 0u);
    EXPECT_GT(changed, 0u);
}

TEST(Repair, cellsThatCannotBeFilledAreCounted) {
    const auto brdf = repairedFormula(
        "missing", [](auto&, auto&) { return 3.0; }, [](auto&, auto&) { return false; });
    EXPECT_EQ(evaluate(*brdf, {0, 0.6, 0.8}, {0, 0, 1})[0], 3);
    EXPECT_EQ(brdf->counts()[0].changed, 0u);
    EXPECT_EQ(brdf->counts()[0].left, 2u);
}

TEST(Repair, negativeIsRaisedToZero) {
    const auto f = [](const Direction& wi, const Direction& wo) { return wi.x + wo.y; };
    const auto brdf = repairedFormula("negative", f);
    EXPECT_TRUE(brdf->laws().nonNegative);
    std::uint64_t changed = 0;
    forPairs([&](const Direction& wi, const Direction& wo) {
        EXPECT_EQ(evaluate(*brdf, wi, wo)[0], std::max(f(wi, wo), 0.0));
        changed += f(wi, wo) < 0 ? 2 : 0;
    });
    EXPECT_EQ(brdf->counts()[0].changed, changed);
}

TEST(Repair, reciprocityAverages) {
    const auto f = [](const Direction& wi, const Direction& wo) { return wi.z + wo.x * wo.x; };
    const auto brdf = repairedFormula("reciprocity", f);
    EXPECT_TRUE(brdf->laws().reciprocal);
    forPairs([&](const Direction& wi, const Direction& wo) {
        EXPECT_NEAR(evaluate(*brdf, wi, wo)[0], (f(wi, wo) + f(wo, wi)) / 2, 1e-15);
        EXPECT_EQ(evaluate(*brdf, wi, wo), evaluate(*brdf, wo, wi));
    });
    const auto oneSided = repairedFormula(
        "reciprocity", f, [](const Direction& wi, const Direction& wo) { return wi.z > wo.z; });
    forPairs([&](const Direction& wi, const Direction& wo) {
        const bool first = wi.z > wo.z;
        EXPECT_EQ(evaluate(*oneSided, wi, wo)[0], first ? f(wi, wo) : f(wo, wi));
    });
}

TEST(Repair, energyEndsBelowOneAndStaysReciprocal) {
    const Formula::Function laws[] = {
        [](auto&, auto&) { return 1.7 / pi; },
        [](const Direction& wi, const Direction& wo) { return 1 / (pi * (0.3 + wi.z * wo.z)); },
        [](const Direction& wi, const Direction& wo) {
            return (1.2 + 0.8 * wi.x * wo.x + 0.4 * (wi.y + wo.y)) / pi;
        }};
    for (std::size_t i = 0; i < std::size(laws); ++i) {
        const auto brdf = repairedFormula("energy", laws[i], {}, /*isotropic=*/i < 2);
        EXPECT_TRUE(brdf->laws().energyConserving);
        for (double theta : {0.0, 20.0, 51.0, 77.0, 86.0, 89.0}) {
            for (double phi : {0.0, 33.0, 95.0, 270.0}) {
                const auto wo = directionFromAngles(radians(theta), radians(phi));
                const auto albedo = directionalAlbedo(*brdf, wo);
                EXPECT_LT(albedo[0], 1 + (i < 2 ? 2e-3 : 4e-3)) << i << " " << theta << " " << phi;
                // The second channel is below 1 by itself, and nothing may change there.
                if (i == 0) {
                    EXPECT_NEAR(albedo[1], 0.85, 1e-4);
                }
            }
        }
        forPairs([&](const Direction& wi, const Direction& wo) {
            EXPECT_NEAR(evaluate(*brdf, wi, wo)[0], evaluate(*brdf, wo, wi)[0], 1e-12);
        });
        EXPECT_GT(brdf->counts()[0].changed, 0u);
    }
}

TEST(Repair, reasonsNameWhatIsWrong) {
    const Formula sick([](const Direction& wi, const Direction& wo) { return wi.z - wo.x * 3; },
                       [](const Direction& wi, const Direction&) { return wi.z > 0.3; });
    const Health health = examine(sick);
    for (const auto& repair : brdfs::repairs()) EXPECT_NE(repair.reason(sick, health), "");
    const auto lambert = brdfs::open("lambert:kd=0.9");
    const Health sound = examine(*lambert);
    for (const auto& repair : brdfs::repairs())
        EXPECT_EQ(repair.reason(*lambert, sound), "") << repair.name;
    // Exactly 1: the quadrature errs by its tolerance at most, which is no reason.
    const auto white = brdfs::open("lambert");
    EXPECT_EQ(brdfs::repairs()[3].reason(*white, examine(*white)), "");
}

TEST(Repair, unknownNamesNameTheKnown) {
    for (const char* names : {"energie", "", "missing,", "missing,energie", "MISSING"}) {
        try {
            brdfs::repaired(brdfs::open("lambert"), names);
            ADD_FAILURE() << names;
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find("reciprocity"), std::string::npos);
        }
    }
    EXPECT_EQ(brdfs::repaired(brdfs::open("lambert"), "all")->counts().size(), 5u);
}

// A cell that is no number is an error, unless it is what is to be repaired.
TEST(Repair, missingTakesCellsThatAreNoNumbers) {
    const test::TemporaryFile file(test::merlFile([](int, int h, int d, int) {
                                       return h > 30 && d > 20 ? std::nan("") : 300.0;
                                   }),
                                   ".binary");
    const auto pair = brdfs::merlDirections(40, 40, 90);
    const auto plain = brdfs::open(file.path());
    EXPECT_EQ(evaluate(*plain, pair.wi, pair.wo)[0], 0);
    EXPECT_THROW(plain->checkIntact(), InputError);
    const auto brdf = brdfs::repaired(brdfs::open(file.path()), "missing");
    EXPECT_NEAR(evaluate(*brdf, pair.wi, pair.wo)[0], 300.0 / 1500, 1e-9);
    EXPECT_NO_THROW(brdf->checkIntact());
}

}  // namespace
}  // namespace hshfit
