#include <hshfit/light/internal/picture_reduction.h>
#include <hshfit/light/picture_layout.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace hshfit {
namespace {

using enum PictureLayout;

/// Every layout in every arrangement.
const std::vector<PictureGeometry> geometries = {
    {latlong, 48, 24}, {angular, 40, 40},   {mirrorBall, 40, 40}, {cross, 64, 48},
    {cross, 48, 64},   {faces, 96, 16},     {faces, 16, 96},      {angular, 41, 41},
    {dome, 40, 40},    {equalArea, 40, 40}, {equalArea, 31, 31}};

bool isDisc(PictureLayout layout) {
    return layout == angular || layout == mirrorBall || layout == dome;
}

std::string nameOf(const PictureGeometry& g) {
    return std::string(layoutName(g.layout)) + " " + std::to_string(g.width) + " x " +
           std::to_string(g.height);
}

Direction latticeDirection(std::size_t k, std::size_t count) {
    const double z = 1 - (2 * static_cast<double>(k) + 1) / static_cast<double>(count);
    const double s = std::sqrt((1 - z) * (1 + z)), phi = 2.399963229728653 * static_cast<double>(k);
    return {s * std::cos(phi), s * std::sin(phi), z};
}

TEST(PictureLayout, SolidAnglesAddUpToTheSphere) {
    for (const PictureGeometry& g : geometries) {
        double sum = 0;
        for (std::size_t row = 0; row < g.height; ++row) {
            for (std::size_t column = 0; column < g.width; ++column) {
                sum += g.solidAngle(column, row);
            }
        }
        const double tolerance = g.faceSize() > 0 || g.layout == latlong ? 1e-12
                                 : g.layout == equalArea                 ? 1e-12
                                 : g.layout == angular                   ? 1e-5
                                                                         : 1e-4;
        const double whole = g.layout == dome ? 2 * pi : 4 * pi;
        EXPECT_NEAR(sum, whole, whole * tolerance) << nameOf(g);
    }
}

TEST(PictureLayout, SolidAnglesAreTheSharesOfEvenlySpreadDirections) {
    constexpr std::size_t count = 2'000'000;
    for (const PictureGeometry& g : geometries) {
        std::vector<double> seen(g.width * g.height, 0);
        for (std::size_t k = 0; k < count; ++k) {
            if (!g.covers(latticeDirection(k, count))) continue;
            const auto [column, row] = g.position(latticeDirection(k, count));
            seen[static_cast<std::size_t>(row) * g.width + static_cast<std::size_t>(column)] +=
                4 * pi / count;
        }
        const double noise = 20 * 4 * pi / count;
        for (std::size_t row = 0; row < g.height; ++row) {
            for (std::size_t column = 0; column < g.width; ++column) {
                EXPECT_NEAR(seen[row * g.width + column], g.solidAngle(column, row),
                            noise + 0.01 * g.solidAngle(column, row))
                    << nameOf(g) << " column " << column << " row " << row;
            }
        }
    }
}

TEST(PictureLayout, PositionIsTheInverseOfDirection) {
    for (const PictureGeometry& g : geometries) {
        for (std::size_t row = 0; row < g.height; ++row) {
            for (std::size_t column = 0; column < g.width; ++column) {
                const double x = static_cast<double>(column) + 0.5,
                             y = static_cast<double>(row) + 0.5;
                const Direction d = g.direction(x, y);
                EXPECT_NEAR(dot(d, d), 1, 1e-12);
                const bool onDisc = isDisc(g.layout);
                const double w = static_cast<double>(g.width);
                if (g.solidAngle(column, row) == 0) continue;
                if (onDisc && std::hypot(2 * x / w - 1, 2 * y / w - 1) >= 1) continue;
                const auto [c, r] = g.position(d);
                EXPECT_NEAR(c, x, 1e-9) << nameOf(g);
                EXPECT_NEAR(r, y, 1e-9) << nameOf(g);
            }
        }
    }
}

TEST(PictureLayout, EveryDirectionHasAPlaceInTheUsedArea) {
    std::vector<Direction> directions;
    for (const double x : {-1.0, -1e-17, 0.0, 1.0}) {
        for (const double y : {-1.0, 0.0, 1e-17, 1.0}) {
            for (const double z : {-1.0, 0.0, 1.0}) {
                const double length = std::sqrt(x * x + y * y + z * z);
                if (length > 0.5) directions.push_back({x / length, y / length, z / length});
            }
        }
    }
    for (const PictureGeometry& g : geometries) {
        for (const Direction& d : directions) {
            if (!g.covers(d)) continue;
            const auto [column, row] = g.position(d);
            ASSERT_TRUE(column >= 0 && column < static_cast<double>(g.width)) << nameOf(g);
            ASSERT_TRUE(row >= 0 && row < static_cast<double>(g.height)) << nameOf(g);
            EXPECT_GT(g.solidAngle(static_cast<std::size_t>(column), static_cast<std::size_t>(row)),
                      0)
                << nameOf(g) << " " << d.x << " " << d.y << " " << d.z;
        }
    }
}

/// The table of cube maps in the OpenGL specification (4.6, section 8.13): major axis, s, t.
TEST(PictureLayout, FacesAreTurnedAsInOpenGl) {
    const PictureGeometry row{faces, 600, 100}, column{faces, 100, 600};
    for (std::size_t k = 0; k < 500; ++k) {
        const Direction d = latticeDirection(k, 500);
        const double r[3] = {-d.y, d.z, d.x};  // X to the right, Y up, Z forward
        const int axis = std::abs(r[0]) >= std::max(std::abs(r[1]), std::abs(r[2])) ? 0
                         : std::abs(r[1]) >= std::abs(r[2])                         ? 1
                                                                                    : 2;
        const bool positive = r[axis] > 0;
        const double sc = axis == 0   ? (positive ? -r[2] : r[2])
                          : axis == 1 ? r[0]
                                      : (positive ? r[0] : -r[0]);
        const double tc = axis == 1 ? (positive ? r[2] : -r[2]) : -r[1];
        const double s = (sc / std::abs(r[axis]) + 1) / 2, t = (tc / std::abs(r[axis]) + 1) / 2;
        const int face = 2 * axis + (positive ? 0 : 1);
        const auto inRow = row.position(d), inColumn = column.position(d);
        EXPECT_NEAR(inRow[0], 100 * (face + s), 1e-9);
        EXPECT_NEAR(inRow[1], 100 * t, 1e-9);
        EXPECT_NEAR(inColumn[0], 100 * s, 1e-9);
        EXPECT_NEAR(inColumn[1], 100 * (face + t), 1e-9);
    }
}

/// Steps over every joint of the unfolded cubes, in directions.
TEST(PictureLayout, CrossesFoldToACube) {
    const PictureGeometry across{cross, 400, 300}, down{cross, 300, 400};
    const double step = 1e-6;
    const auto near = [](const Direction& a, const Direction& b) {
        return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z) < 1e-6;
    };
    for (const double along : {10.0, 50.0, 90.0}) {
        for (const double joint : {100.0, 200.0, 300.0}) {
            EXPECT_TRUE(near(across.direction(joint - step, 100 + along),
                             across.direction(joint + step, 100 + along)));
            EXPECT_TRUE(near(down.direction(100 + along, joint - step),
                             down.direction(100 + along, joint + step)));
        }
        for (const double joint : {100.0, 200.0}) {
            EXPECT_TRUE(near(across.direction(100 + along, joint - step),
                             across.direction(100 + along, joint + step)));
            EXPECT_TRUE(near(down.direction(joint - step, 100 + along),
                             down.direction(joint + step, 100 + along)));
        }
    }
}

TEST(PictureLayout, TheMiddleIsForwardAndTheRightIsMinusY) {
    const auto expectAt = [](const PictureGeometry& g, double column, double row,
                             const Direction& expected) {
        const Direction d = g.direction(column, row);
        EXPECT_NEAR(dot(d, expected), 1, 1e-9) << nameOf(g) << " " << column << " " << row;
    };
    const double diagonal = std::sqrt(0.5);
    for (const PictureGeometry& g :
         {PictureGeometry{latlong, 200, 100}, PictureGeometry{angular, 200, 200},
          PictureGeometry{cross, 400, 300}}) {
        const double x = g.layout == cross ? 150 : 100, y = g.layout == latlong ? 50 : 0;
        const double middle = y > 0 ? y : g.layout == cross ? 150 : 100;
        expectAt(g, x, middle, {1, 0, 0});
        const double eighth = g.layout == cross ? 50 : 25;
        expectAt(g, x + eighth, middle, {diagonal, -diagonal, 0});
        expectAt(g, x, middle - eighth, {diagonal, 0, diagonal});
    }
    // Debevec: u, v = D r with r = acos(forward) / pi / sin; the rim is backwards.
    expectAt({angular, 200, 200}, 199.9999999, 100, {-1, 0, 0});
    // A ball that the camera sees in front of it shows what is behind the camera in its middle, and
    // at sin(45 degrees) of its radius what is at the camera's right.
    const PictureGeometry ball{mirrorBall, 200, 200};
    expectAt(ball, 100, 100, {-1, 0, 0});
    expectAt(ball, 100 + 100 * diagonal, 100, {0, -1, 0});
    expectAt(ball, 100, 100 - 100 * diagonal, {0, 0, 1});
    expectAt(ball, 0, 100, {1, 0, 0});
}

/// A fisheye that looks up has the angle from the zenith as its radius; somebody who leans back has
/// forward below and the right on the right.
TEST(PictureLayout, DomesLookUpWithForwardBelow) {
    const PictureGeometry g{dome, 200, 200};
    const auto expectAt = [&](double column, double row, double theta, double phi) {
        const Direction expected = directionFromAngles(radians(theta), radians(phi));
        EXPECT_NEAR(dot(g.direction(column, row), expected), 1, 1e-12) << column << " " << row;
    };
    expectAt(100, 100, 0, 0);
    expectAt(100, 150, 45, 0);
    expectAt(100, 199.9999999, 90, 0);
    expectAt(175, 100, 67.5, -90);
    expectAt(100, 50, 45, 180);
    EXPECT_TRUE(g.covers({0, 0.6, 0.8}));
    EXPECT_FALSE(g.covers({0, 0.6, -0.8}));
}

/// Clarberg 2008: the zenith in the middle, the horizon the square through the middles of the
/// sides, the nadir in the corners; on the line from the middle to a side 1 - z is the square of
/// the distance. pbrt-v4 has x to the right and y downwards, and its x is our -x.
TEST(PictureLayout, SquaresOfEqualAreaAreThoseOfPbrt) {
    const PictureGeometry g{equalArea, 200, 200};
    const auto expectAt = [&](double column, double row, const Direction& expected) {
        EXPECT_NEAR(dot(g.direction(column, row), expected), 1, 1e-12) << column << " " << row;
    };
    expectAt(100, 100, {0, 0, 1});
    expectAt(200, 100, {-1, 0, 0});
    expectAt(100, 200, {0, 1, 0});
    expectAt(0, 100, {1, 0, 0});
    expectAt(0, 0, {0, 0, -1});
    expectAt(200, 200, {0, 0, -1});
    const double diagonal = std::sqrt(0.5), s = std::sqrt(1 - 0.75 * 0.75);
    expectAt(150, 150, {-diagonal, diagonal, 0});
    expectAt(150, 100, {-s, 0, 0.75});
    expectAt(125, 125, {-s * diagonal, s * diagonal, 0.75});
    // The azimuth grows evenly on a line of equal distance: a quarter of the way is 22.5 degrees.
    expectAt(137.5, 112.5, {-s * std::cos(pi / 8), s * std::sin(pi / 8), 0.75});
    expectAt(175, 175, {-s * diagonal, s * diagonal, -0.75});
}

/// Neighbours are as far apart as pixels are wide, and the way back leads to where it began, but
/// for the corners of cubes and the stretched pixels at the rims of discs.
TEST(PictureLayout, NeighboursLieAcrossEdgesAlsoAtTheRimsOfPictures) {
    constexpr std::pair<int, int> steps[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (const PictureGeometry& g : geometries) {
        std::size_t found = 0;
        for (std::size_t row = 0; row < g.height; ++row) {
            for (std::size_t column = 0; column < g.width; ++column) {
                const auto middle = [&](std::size_t x, std::size_t y) {
                    return g.direction(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
                };
                for (const auto& [right, down] : steps) {
                    const auto next = g.neighbour(column, row, right, down);
                    if (!next || isDisc(g.layout)) continue;
                    ++found;
                    const double cosine = dot(middle(column, row), middle((*next)[0], (*next)[1]));
                    EXPECT_GT(cosine, std::cos(2.2 * g.pixelAngle()))
                        << nameOf(g) << " " << column << " " << row << " " << right << " " << down;
                }
                if (!(g.solidAngle(column, row) > 0)) {
                    EXPECT_FALSE(g.neighbour(column, row, 1, 0));
                }
            }
        }
        const std::size_t used =
            g.faceSize() > 0 ? 6 * g.faceSize() * g.faceSize() : g.width * g.height;
        if (!isDisc(g.layout)) {
            EXPECT_EQ(found, 4 * used) << nameOf(g);
        }
    }
}

TEST(PictureLayout, SizesTellLayoutsExceptForSquares) {
    EXPECT_EQ(layoutOfSize(64, 32), latlong);
    EXPECT_EQ(layoutOfSize(64, 48), cross);
    EXPECT_EQ(layoutOfSize(48, 64), cross);
    EXPECT_EQ(layoutOfSize(60, 10), faces);
    EXPECT_EQ(layoutOfSize(10, 60), faces);
    EXPECT_EQ(layoutOfSize(64, 64), std::nullopt);
    EXPECT_EQ(layoutOfSize(64, 16), dome);
    EXPECT_EQ(layoutOfSize(65, 32), std::nullopt);
    EXPECT_FALSE(layoutFits(cross, 4, 2));
    EXPECT_TRUE(layoutFits(angular, 7, 7));
}

/// The flux of a reduced picture and of its reduction, by the solid angles of each.
TEST(PictureReduction, KeepsConstantsAndFlux) {
    const std::vector<PictureGeometry> sizes = {
        {latlong, 64, 32},    {latlong, 70, 35}, {angular, 61, 61},
        {mirrorBall, 64, 64}, {cross, 68, 51},   {faces, 17, 102},
        {faces, 96, 16},      {dome, 61, 61},    {equalArea, 70, 70}};
    for (const PictureGeometry& file : sizes) {
        for (const std::size_t most : {5000U, 500U, 130U}) {
            PictureReduction constant(file, most), pattern(file, most);
            double flux = 0;
            for (std::size_t row = 0; row < file.height; ++row) {
                std::vector<float> rgb;
                for (std::size_t column = 0; column < file.width; ++column) {
                    const auto value =
                        static_cast<float>(1 + (column * 7 + row * 13) % 5 + (row == 9 ? 20 : 0));
                    rgb.insert(rgb.end(), {value, 2 * value, 0});
                    flux += value * file.solidAngle(column, row);
                }
                pattern.add(row, rgb);
                constant.add(row, std::vector<float>(3 * file.width, 3.F));
            }
            const PictureGeometry kept = pattern.geometry();
            EXPECT_TRUE(layoutFits(kept.layout, kept.width, kept.height));
            EXPECT_LE(kept.width * kept.height, std::max(most, file.width * file.height / 49));
            const std::vector<float> rgb = pattern.result(), same = constant.result();
            ASSERT_EQ(rgb.size(), 3 * kept.width * kept.height);
            double keptFlux = 0;
            for (std::size_t row = 0; row < kept.height; ++row) {
                for (std::size_t column = 0; column < kept.width; ++column) {
                    const std::size_t at = 3 * (row * kept.width + column);
                    const double omega = kept.solidAngle(column, row);
                    keptFlux += rgb[at] * omega;
                    EXPECT_FLOAT_EQ(rgb[at + 1], 2 * rgb[at]);
                    const bool rim = isDisc(kept.layout);
                    if (omega > 0 && !rim) {
                        EXPECT_FLOAT_EQ(same[at], 3.F) << nameOf(file);
                    }
                }
            }
            const bool disc = isDisc(file.layout);
            EXPECT_NEAR(keptFlux, flux, (disc ? 2e-2 : 2e-3) * flux) << nameOf(file);
        }
    }
}

}  // namespace
}  // namespace hshfit
