// Fills of holes against functions that are known everywhere.
#include <brdfs/repair.h>

#include <brdfs/measured_files.h>
#include <gtest/gtest.h>
#include <lib/formula_brdf.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

namespace hshfit {
namespace {

using Formula = test::FormulaBrdf;

double cosineOfThetaDifference(const Direction& wi, const Direction& wo) {
    return std::sqrt((1 + dot(wi, wo)) / 2);
}

/// A lobe about the half vector that rises towards grazing angles, on a diffuse part.
double glossy(const Direction& wi, const Direction& wo) {
    const double cosine = cosineOfThetaDifference(wi, wo), h = (wi.z + wo.z) / (2 * cosine);
    return 0.1 + 3 * std::exp(40 * (h - 1)) * (0.1 + 0.9 * std::pow(1 - cosine, 5));
}

/// A number of standard normal distribution for each cell of two degrees of all angles.
double noiseAt(const Direction& wi, const Direction& wo) {
    std::uint64_t state = 7;
    for (const double angle : {polarAngle(wi), azimuth(wi), polarAngle(wo), azimuth(wo)}) {
        // The finaliser of SplitMix64.
        state += static_cast<std::uint64_t>(std::floor(angle / radians(2)) + 1000);
        state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9u;
        state = (state ^ (state >> 27)) * 0x94d049bb133111ebu;
        state ^= state >> 31;
    }
    const double u = (static_cast<double>(state >> 32) + 0.5) * 0x1p-32,
                 v = static_cast<double>(state & 0xffffffffu) * 0x1p-32;
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * v);
}

/// Around retroreflection, as a detector that stands in the light's way.
bool seesRetro(const Direction& wi, const Direction& wo) {
    return cosineOfThetaDifference(wi, wo) < std::cos(radians(3));
}
/// Up to 80 degrees, as the arm of a goniometer.
bool reaches(const Direction& wi, const Direction& wo) {
    return std::min(wi.z, wo.z) > std::cos(radians(80));
}

constexpr double unmeasured = -7;

struct Filled {
    std::vector<double> errors;  ///< relative, of pairs that were filled
    brdfs::RepairCount count;
};

Filled fillWith(const Formula::Function& truth, double noise, const Formula::Predicate& covers,
                int pairs) {
    const auto f = [=](const Direction& wi, const Direction& wo) {
        return truth(wi, wo) * (noise > 0 ? std::exp(noise * noiseAt(wi, wo)) : 1.0);
    };
    const auto holed = [=](const Direction& wi, const Direction& wo) {
        return covers(wi, wo) ? f(wi, wo) : unmeasured;
    };
    const auto brdf = brdfs::repaired(
        std::make_unique<Formula>(holed, covers, Laws{.isotropic = true}, Channels::grey()),
        "holes");
    std::mt19937 random(7);
    Filled filled;
    std::uint64_t holes = 0;
    for (int k = 0; k < pairs; ++k) {
        Direction wi = test::randomDirection(random, 0.01);
        Direction wo = test::randomDirection(random, 0.01);
        if (k % 2 == 0) wo = directionFromAngles(polarAngle(wi), azimuth(wi) + radians(3));
        const double value = evaluate(*brdf, wi, wo)[0];
        if (covers(wi, wo)) {
            EXPECT_EQ(value, f(wi, wo));  // bit for bit
            continue;
        }
        ++holes;
        if (value == unmeasured) continue;  // no covered pair has its half vector
        filled.errors.push_back(std::abs(value / truth(wi, wo) - 1));
    }
    filled.count = brdf->counts().at(0);
    EXPECT_EQ(filled.count.changed + filled.count.left, holes);
    std::uint64_t sum = 0;
    for (const std::uint64_t values : filled.count.byAngle) sum += values;
    EXPECT_EQ(sum, filled.count.changed);
    std::ranges::sort(filled.errors);
    return filled;
}

TEST(HoleFiller, blindSpotsAndGrazingAnglesOfASmoothFunctionComeBack) {
    const Filled retro = fillWith(glossy, 0, seesRetro, 4000);
    ASSERT_GT(retro.errors.size(), 500u);
    EXPECT_EQ(retro.count.left, 0u);
    EXPECT_LT(retro.errors.back(), 2e-3);
    const Filled grazing = fillWith(glossy, 0, reaches, 4000);
    ASSERT_GT(grazing.errors.size(), 500u);
    EXPECT_LT(grazing.errors[grazing.errors.size() / 2], 1e-3);
}

// A fill is a mean of neighbours, no farther from the truth than a measured value; what the check
// says of pairs that are known holds for those that are not, up to the noise that a known one has
// itself.
TEST(HoleFiller, fillsAreAsNearToTheTruthAsMeasuredValuesAndTheCheckSaysSo) {
    for (const double noise : {0.01, 0.05}) {
        for (const auto& covers : {Formula::Predicate(seesRetro), Formula::Predicate(reaches)}) {
            const Filled filled = fillWith(glossy, noise, covers, 4000);
            ASSERT_GT(filled.errors.size(), 500u);
            ASSERT_TRUE(filled.count.check);
            const brdfs::FillCheck& check = *filled.count.check;
            EXPECT_GT(check.pairs, 500u);
            EXPECT_GT(check.noise, noise / 2);
            EXPECT_LT(check.noise, noise * 1.5);
            // The median size of a normal error is 0.6745 of its deviation.
            const double median = filled.errors[filled.errors.size() / 2], own = 0.6745 * noise;
            EXPECT_LT(median, 1.1 * own);
            EXPECT_LT(std::hypot(median, own), 1.5 * check.median);
            EXPECT_GT(std::hypot(median, own), check.median / 1.5);
            EXPECT_LE(check.median, check.percentile95);
            EXPECT_LE(check.percentile95, check.largest);
        }
    }
}

TEST(HoleFiller, pairsWithoutNeighboursAreLeftAndCounted) {
    const auto brdf =
        brdfs::repaired(std::make_unique<Formula>([](auto&, auto&) { return 3.0; },
                                                  [](auto&, auto&) { return false; },
                                                  Laws{.isotropic = true}, Channels::grey()),
                        "holes");
    EXPECT_EQ(evaluate(*brdf, {0, 0.6, 0.8}, {0, 0, 1})[0], 3);
    EXPECT_EQ(brdf->counts()[0].changed, 0u);
    EXPECT_EQ(brdf->counts()[0].left, 1u);
    EXPECT_FALSE(brdf->counts()[0].check);
}

}  // namespace
}  // namespace hshfit
