// Tables of functions over three axes: their axes, and sums that are known without them.

#include <hshfit/error.h>
#include <hshfit/gpu/forms/library_table.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit::gpu {
namespace {

constexpr HalfwayLobe lobe{.along = 0.02, .across = 0.02, .turn = 0, .shelf = 1};

/// Pairs above the horizon: at random, mirrored, within a thousandth of that, with one direction or
/// both near the horizon, and at normal incidence.
std::vector<DirectionPair> pairs() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    const auto direction = [&](double z) {
        const double phi = 2 * pi * unit(random), s = std::sqrt(1 - z * z);
        return Direction{s * std::cos(phi), s * std::sin(phi), z};
    };
    std::vector<DirectionPair> all;
    for (int n = 0; n < 500; ++n) {
        const Direction wo = direction(1e-3 + 0.999 * unit(random));
        all.push_back({direction(1e-3 + 0.999 * unit(random)), wo});
        all.push_back({mirrored(wo), wo});
        const double turn = 1e-3 * unit(random);
        all.push_back({rotateAboutZ(mirrored(wo), turn), wo});
        all.push_back({direction(1e-3), wo});
        all.push_back({direction(1e-3), direction(2e-3)});
        all.push_back({{0, 0, 1}, wo});
    }
    return all;
}

/// Sums of terms of low orders; sum c has the coefficients `values[c]` by term.
Representation sumsOf(const std::vector<std::vector<std::pair<HalfwayTerm, double>>>& values) {
    Representation sums;
    sums.halfway = {6, 4, 3};
    std::vector<std::string> names;
    for (std::size_t c = 0; c < values.size(); ++c) names.push_back("sum " + std::to_string(c));
    sums.head.channels = Channels::named(names, {});
    sums.head.isotropic = sums.head.bilateral = sums.head.reciprocal = true;
    const HalfwayTerms terms(sums.halfway,
                             {.isotropic = true, .bilateral = true, .reciprocal = true});
    HalfwayArray content{.halfway = {.shape = {values.size(), terms.size()}, .values = {}},
                         .lobe = lobe,
                         .ceilings = std::vector<HalfwayCeiling>(values.size())};
    for (const auto& sum : values) {
        for (const HalfwayTerm& term : terms.list()) {
            double number = 0;
            for (const auto& [of, value] : sum) number += of == term ? value : 0;
            content.halfway.values.push_back(number);
        }
    }
    sums.content = std::move(content);
    return sums;
}

/// Three sums in closed form: a constant, v = cos(theta_d), and the cube roots of both cosines.
const Representation& known() {
    const double root = std::sqrt(3.0);
    static const Representation sums =
        sumsOf({{{{.lobe = true}, 2.5}},
                {{{.lobe = true}, 0.5}, {{.lobe = true, .j = 1}, 0.5 / root}},
                {{{.lobe = false}, 1}, {{.lobe = false, .i = 1}, 1 / root}}});
    return sums;
}

std::vector<double> knownAt(const DirectionPair& pair) {
    const double x = pair.wi.x + pair.wo.x, y = pair.wi.y + pair.wo.y, z = pair.wi.z + pair.wo.z;
    return {2.5, std::sqrt(x * x + y * y + z * z) / 2, std::cbrt(pair.wi.z) + std::cbrt(pair.wo.z)};
}

double largestError(const TableSize& size) {
    const FunctionTable table(known(), size);
    std::vector<double> found(4 * table.groups());
    double largest = 0;
    for (const DirectionPair& pair : pairs()) {
        table.evaluate(pair.wi, pair.wo, FunctionTable::Weights::exact, found.data());
        const std::vector<double> right = knownAt(pair);
        EXPECT_NEAR(found[0], 2.5, 1e-12);
        EXPECT_EQ(found[3], 0);
        for (std::size_t c = 0; c < right.size(); ++c)
            largest = std::max(largest, std::abs(found[c] - right[c]));
    }
    return largest;
}

TEST(FunctionTable, GivesSumsInClosedFormWithTheSquareOfTheDistanceOfNodes) {
    const double coarse = largestError({24, 15, 9}), fine = largestError({47, 29, 17});
    EXPECT_LT(coarse, 0.02);
    EXPECT_LT(fine, coarse / 3);  // a fourth, and the rounding to halves
    EXPECT_GT(fine, 0);
}

TEST(FunctionTable, PlacesFillTheCubeAndKeepTheSymmetries) {
    const HalfwayAxes axes(lobe);
    TablePlace least{1, 1, 1}, greatest{0, 0, 0};
    for (const DirectionPair& pair : pairs()) {
        const TablePlace at = tablePlace(axes, pair.wi, pair.wo);
        const TablePlace exchanged = tablePlace(axes, pair.wo, pair.wi);
        const TablePlace turned =
            tablePlace(axes, rotateAboutZ(pair.wi, 1), rotateAboutZ(pair.wo, 1));
        const auto mirroredY = [](const Direction& d) { return Direction{d.x, -d.y, d.z}; };
        const TablePlace image = tablePlace(axes, mirroredY(pair.wi), mirroredY(pair.wo));
        for (const auto member : {&TablePlace::half, &TablePlace::plane, &TablePlace::horizon}) {
            EXPECT_EQ(exchanged.*member, at.*member);
            EXPECT_EQ(image.*member, at.*member);
            EXPECT_NEAR(turned.*member, at.*member, 1e-6);
            least.*member = std::min(least.*member, at.*member);
            greatest.*member = std::max(greatest.*member, at.*member);
        }
    }
    for (const auto member : {&TablePlace::half, &TablePlace::plane, &TablePlace::horizon}) {
        EXPECT_GE(least.*member, 0);
        EXPECT_LE(greatest.*member, 1 + 1e-12);
        EXPECT_LT(least.*member, 0.15);
        EXPECT_GT(greatest.*member, 0.85);
    }
    const Direction low{1, 0, 0}, out{0.6, 0, 0.8};
    EXPECT_EQ(tablePlace(axes, low, out).horizon, 1);
    EXPECT_EQ(tablePlace(axes, mirrored(out), out).half, 0);
    EXPECT_EQ(tablePlace(axes, mirrored(out), out).horizon, 0);
}

/// Materials of the known sums: f + 1e-3 = exp(q . sums), grey for every colour.
SharedSums materials() {
    SharedSums sums;
    sums.functions = known();
    sums.offset = 1e-3;
    sums.parts = {{1, 1}, {2, 1}};
    sums.materials = {1, 2, 3, 0, 1, 0, 1, 0, 9, 9, 9, 0};
    return sums;
}

TEST(LibraryTable, StatesAnErrorThatHoldsAtPairsThatTookNoPart) {
    double bytes = 0;
    for (const double error : {0.02, 0.005}) {
        const TabledLibrary tabled = tabledWithin(materials(), error);
        EXPECT_LE(tabled.error.largest, error);
        EXPECT_LT(tabled.error.mean, tabled.error.largest / 2);
        EXPECT_GT(static_cast<double>(tabled.sums.table->texels().bytes.size()), 2 * bytes);
        bytes = static_cast<double>(tabled.sums.table->texels().bytes.size());
        const TabledBrdf brdf(tabled.sums, 0);
        for (const DirectionPair& pair : pairs()) {
            const std::vector<double> s = knownAt(pair), f = evaluate(brdf, pair.wi, pair.wo);
            for (std::size_t c = 0; c < 3; ++c) {
                const double sum = s[0] + static_cast<double>(c + 1) * s[1] + (c == 1 ? 0 : s[2]);
                EXPECT_NEAR(std::log(f[c] + 1e-3), std::min(sum, 9.0), error);
            }
        }
    }
}

// 88 x 50 x 39 nodes of eight bytes.
TEST(LibraryTable, SaysHowFarTheFinestTableIsOff) {
    try {
        tabledWithin(materials(), 1e-5);
        FAIL();
    } catch (const NumericError& error) {
        EXPECT_NE(std::string(error.what()).find("1372800 bytes"), std::string::npos)
            << error.what();
    }
}

}  // namespace
}  // namespace hshfit::gpu
