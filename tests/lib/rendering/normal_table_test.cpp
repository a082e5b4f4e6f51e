// Values interpolated between normals, against the values at the normals themselves.

#include <hshfit/brdf/vectors.h>
#include <hshfit/rendering/internal/normal_table.h>
#include <hshfit/rendering/view.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace hshfit;

namespace {

std::vector<Direction> randomNormals(std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<Direction> normals;
    while (normals.size() < count) {
        const Direction d{unit(random), unit(random), unit(random)};
        if (dot(d, d) <= 1 && dot(d, d) > 0.01) normals.push_back(normalised(d));
    }
    // Poles, edges and corners of the cube.
    for (const double x : {-1.0, 0.0, 1.0}) {
        for (const double y : {-1.0, 0.0, 1.0}) {
            for (const double z : {-1.0, 0.0, 1.0}) {
                const Direction d{x, y, z};
                if (dot(d, d) > 0) normals.push_back(normalised(d));
            }
        }
    }
    return normals;
}

/// A direction of the world in the axes of a surface: its cosine and cos and sin of twice its
/// azimuth, times the squared sine.
void seenFrom(const Frame& frame, double* values) {
    const Direction d = frame.toLocal(directionFromAngles(1.1, 0.4));
    values[0] = d.z;
    values[1] = d.x * d.x - d.y * d.y;
    values[2] = 2 * d.x * d.y;
}

double largestError(int perEdge) {
    const std::vector<Direction> normals = randomNormals(2000);
    NormalTable table(normals, perEdge);
    table.fill(3, seenFrom);
    double largest = 0;
    for (const Direction& normal : normals) {
        double found[3], exact[3];
        const double turn = table.interpolate(normal, found);
        seenFrom(frameAt(normal), exact);
        const double c = std::cos(2 * turn), s = std::sin(2 * turn);
        // An azimuth in the table's axes less the turn is the one from frameAt's tangent.
        const double turned[] = {found[0], c * found[1] + s * found[2],
                                 c * found[2] - s * found[1]};
        for (std::size_t i = 0; i < 3; ++i)
            largest = std::max(largest, std::abs(turned[i] - exact[i]));
    }
    return largest;
}

TEST(NormalTable, ErrorsFallWithTheFourthPowerOfTheStep) {
    const double coarse = largestError(8), fine = largestError(32);
    EXPECT_LT(coarse, 0.02);
    EXPECT_LT(fine, coarse / 150);
    EXPECT_GT(fine, 0);
}

TEST(NormalTable, CellsOfAFullGridHaveEightAround) {
    const std::vector<Direction> normals = randomNormals(20000);
    const NormalTable table(normals, 8);
    ASSERT_EQ(table.middles().size(), 6u * 8 * 8);
    std::size_t found = 0;
    for (const std::size_t middle : table.middles()) {
        const std::vector<std::size_t> around = table.cellsAround(normals[middle]);
        EXPECT_LE(around.size(), 8u);
        found += around.size();
        EXPECT_EQ(std::ranges::count(around, table.cellOf(normals[middle])), 0);
        for (const std::size_t cell : around)
            EXPECT_GT(dot(normals[middle], normals[table.middles()[cell]]), std::cos(0.6));
    }
    EXPECT_EQ(found, 8u * 6 * 8 * 8);
}

TEST(NormalTable, KeepsVerticesAboutTheNormalsAlone) {
    const std::vector<Direction> one = {normalised({0.2, 0.3, 0.9})};
    const NormalTable table(one, 20);
    EXPECT_EQ(table.vertices(), 16u);
    ASSERT_EQ(table.middles().size(), 1u);
    EXPECT_EQ(table.cellOf(one[0]), 0u);
}

TEST(NormalTable, NamesTheNormalNearestTheMiddleOfACell) {
    // Cells of 90 degrees: the middle of one is an axis.
    const std::vector<Direction> normals = {normalised({0.5, 0, 1}), normalised({0.1, 0, 1}),
                                            normalised({0, 0.3, 1}), normalised({1, 0, 0.2})};
    const NormalTable table(normals, 1);
    ASSERT_EQ(table.middles().size(), 2u);
    EXPECT_EQ(table.middles()[table.cellOf(normals[0])], 1u);
    EXPECT_EQ(table.middles()[table.cellOf(normals[3])], 3u);
}

}  // namespace
