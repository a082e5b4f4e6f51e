// The smooth reading of RGL files, on the measured car paint whose normals have a ripple and whose
// slice at the normal has azimuths.

#include <brdfs/catalog.h>
#include <brdfs/measured/rgl.h>
#include <hshfit/brdf/brdf.h>
#include <hshfit/projection/albedo.h>

#include <gtest/gtest.h>
#include <places.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::brdfs {
namespace {

class RglSmooth : public testing::Test {
protected:
    void SetUp() override {
        const std::string folder = test::sharedFolder() + "/data/rgl";
        if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
    }
};

std::unique_ptr<RglBrdf> ibiza(RglReading reading) {
    return RglBrdf::open(test::sharedFolder() + "/data/rgl/cc_ibiza_sunset_rgb.bsdf", reading);
}

Direction mirrored(const Direction& wi, const Direction& h) {
    const double twice = 2 * dot(wi, h);
    return {twice * h.x - wi.x, twice * h.y - wi.y, twice * h.z - wi.z};
}

TEST_F(RglSmooth, KeepsEveryVertexBesideThoseAtTheNormal) {
    const auto published = ibiza(RglReading::published), smooth = ibiza(RglReading::smooth);
    const RglTables& tables = published->tables();
    std::size_t compared = 0;
    for (std::size_t slice = 1; slice < tables.incident.theta.size(); ++slice) {
        for (std::size_t row = 0; row < tables.spectra.rows; ++row) {
            for (std::size_t column = 0; column < tables.spectra.columns; ++column) {
                const auto node = tables.node(slice, row, column);
                if (!(node.wo.z > 1e-3) || !(node.wi.z > 1e-3)) continue;
                const auto was = evaluate(*published, node.wi, node.wo);
                const auto is = evaluate(*smooth, node.wi, node.wo);
                for (std::size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(is[c], was[c], 2e-4 * was[c] + 1e-9)
                        << "slice " << slice << ", row " << row << ", column " << column;
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 4000U);
}

/// The largest over the smallest f of wi around the normal, a millionth of a radian from it.
double unevenness(const RglBrdf& brdf) {
    double least = 1e300, most = 0;
    for (int k = 0; k < 24; ++k) {
        const Direction wi = directionFromAngles(1e-6, k * pi / 12);
        const Direction wo = directionFromAngles(radians(20), 0);
        const double f = evaluate(brdf, wi, wo)[0];
        least = std::min(least, f), most = std::max(most, f);
    }
    return most / least;
}

TEST_F(RglSmooth, HasNoAzimuthAtTheNormal) {
    EXPECT_GT(unevenness(*ibiza(RglReading::published)), 2);
    EXPECT_LT(unevenness(*ibiza(RglReading::smooth)), 1.01);
}

/// The mean bend of ln f along half vectors across the plane of incidence, at 20 to 38 degrees.
double ripple(const RglBrdf& brdf) {
    const Direction wi = directionFromAngles(brdf.tables().incident.theta[2], 0);
    std::vector<double> logarithms;
    for (double theta = 20; theta <= 38; theta += 0.75) {
        const Direction h = directionFromAngles(radians(theta), pi / 2);
        logarithms.push_back(std::log(evaluate(brdf, wi, mirrored(wi, h))[1]));
    }
    double sum = 0;
    for (std::size_t i = 2; i < logarithms.size(); ++i)
        sum += std::fabs(logarithms[i] - 2 * logarithms[i - 1] + logarithms[i - 2]);
    return sum / static_cast<double>(logarithms.size() - 2);
}

TEST_F(RglSmooth, TakesOutTheRippleOfNormals) {
    EXPECT_LT(ripple(*ibiza(RglReading::smooth)), ripple(*ibiza(RglReading::published)) / 3);
}

/// Files of coefficients and advice name their source by it.
TEST_F(RglSmooth, NameOpensTheSameReading) {
    const auto smooth = ibiza(RglReading::smooth);
    const auto again = open(smooth->name());
    EXPECT_EQ(again->name(), smooth->name());
    for (const double theta : {0.0, 7.0, 23.0}) {
        const Direction wi = directionFromAngles(radians(theta), 0);
        const Direction wo = directionFromAngles(radians(20), 2);
        EXPECT_EQ(evaluate(*again, wi, wo), evaluate(*smooth, wi, wo)) << theta;
    }
}

/// The smooth reading differs from the published one between vertices alone: what all light
/// together gives stays, here within 3 % of the largest albedo.
TEST_F(RglSmooth, KeepsAlbedosOfEveryFile) {
    for (const char* name : {"cc_ibiza_sunset", "cg_sunflower", "paper_white", "satin_rosaline"}) {
        const std::string path = test::sharedFolder() + "/data/rgl/" + name + "_rgb.bsdf";
        const auto published = RglBrdf::open(path);
        const auto smooth = RglBrdf::open(path, RglReading::smooth);
        for (const double theta : {15.0, 45.0, 75.0}) {
            const Direction wo = directionFromAngles(radians(theta), 0);
            const auto was = estimateAlbedo(*published, wo, {.tolerance = 1e-3}).values;
            const auto is = estimateAlbedo(*smooth, wo, {.tolerance = 1e-3}).values;
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(is[c], was[c], 0.03 * *std::ranges::max_element(was))
                    << name << ", " << theta << " degrees, channel " << c;
        }
    }
}

}  // namespace
}  // namespace hshfit::brdfs
