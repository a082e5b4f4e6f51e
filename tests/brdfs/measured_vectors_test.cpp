// The vectors by which RGL and MERL files are evaluated, for every instruction set of the machine:
// against RglBrdf::evalScalar, and against each other.

#include <brdfs/catalog.h>
#include <brdfs/measured/rgl.h>
#include <brdfs/measured_files.h>
#include <brdfs/tensor_writer.h>
#include <vector_targets.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace hshfit {
namespace {

using brdfs::RglBrdf;
using test::RglShape;

RglBrdf synthetic(const RglShape& shape) {
    const std::string bytes = test::tensorFile(test::rglFields(shape));
    return RglBrdf({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, "memory");
}

std::vector<float> azimuths(double first, double last, int count) {
    std::vector<float> all;
    for (int i = 0; i < count; ++i)
        all.push_back(static_cast<float>(radians(first + (last - first) * i / (count - 1))));
    return all;
}

struct Points {
    std::vector<double> x, y, z;

    void add(const Direction& d) { x.push_back(d.x), y.push_back(d.y), z.push_back(d.z); }
    DirectionBatch first(std::size_t count) const { return {x.data(), y.data(), z.data(), count}; }
};

/// Everywhere, also below the horizon; at it, at the normal and at the nodes of the tables.
Points pointsOf(std::size_t count) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    Points points;
    for (const double theta : {0., 1e-9, .5, 1., pi / 2 - 1e-12, pi / 2})
        for (const double phi : {0., pi / 2, pi, -2.}) points.add(directionFromAngles(theta, phi));
    while (points.x.size() < count)
        points.add(directionFromAngles(std::acos(1 - 1.2 * unit(random)), 2 * pi * unit(random)));
    return points;
}

// Both compute angles by the same polynomial; what is rounded differently, 1e-15 of them, is
// enlarged by the slope of f between two vertices, at most 1000 times its largest value. Behind the
// values nothing is written.
TEST(RglVectors, AgreeWithScalarEvaluation) {
    const Points points = pointsOf(301);
    for (const RglShape& shape :
         {RglShape{}, RglShape{.theta = {.3F}}, RglShape{.phi = {-1, 2}},
          RglShape{.phi = azimuths(-180, 180, 9)}, RglShape{.phi = azimuths(-180, 0, 5)},
          RglShape{.phi = azimuths(-180, -90, 4)},
          RglShape{.phi = azimuths(-180, -90, 4), .theta = {.3F}},
          RglShape{.normalRows = 2, .normalColumns = 2, .colourRows = 2, .colourColumns = 2},
          RglShape{.jacobian = false}}) {
        const RglBrdf brdf = synthetic(shape);
        test::forEveryTarget([&] {
            for (const std::size_t count : {0, 1, 3, 63, 64, 65, 301})
                for (const double theta : {0., .7, 1.5}) {
                    const Direction wo = directionFromAngles(theta, 1.1);
                    constexpr double untouched = -7;
                    std::vector<double> vectors(3 * count + 8, untouched), scalar(3 * count);
                    brdf.eval(wo, points.first(count), vectors.data());
                    brdf.evalScalar(wo, points.first(count), scalar.data());
                    const double largest =
                        count == 0 ? 0 : *std::max_element(scalar.begin(), scalar.end());
                    for (std::size_t k = 0; k < 3 * count; ++k)
                        ASSERT_NEAR(vectors[k], scalar[k], 1e-12 * largest)
                            << k << " of " << 3 * count << ", wo at " << theta;
                    for (std::size_t k = 3 * count; k < vectors.size(); ++k)
                        ASSERT_EQ(vectors[k], untouched);
                }
        });
    }
}

// A MERL table of a narrow lobe, one cell in 97 without a value, and a NaN: every instruction set
// reads the same from it. Angles differ by 1e-15, which is 1e-13 of a cell, and cells beside each
// other by as much as the lobe is high.
TEST(MerlVectors, AgreeAmongInstructionSets) {
    const Points points = pointsOf(2000);
    const std::size_t count = points.x.size();
    for (const int azimuths : {180, 360}) {
        const test::TemporaryFile file(test::merlFile(
            [&](int c, int h, int d, int p) {
                if (c == 1 && h == 40 && d == 40 && p == 40) return std::nan("");
                if ((c + 31 * (h + 37 * (d + 41 * p))) % 97 == 0) return -1.0;
                return 1 + 1000 * std::exp(-0.1 * h * h) + d + c + std::cos(radians(2. * p));
            },
            azimuths));
        const auto brdf = brdfs::open(file.path());
        for (const double theta : {0., .7, 1.5}) {
            const Direction wo = directionFromAngles(theta, 1.1);
            std::vector<double> first, values(3 * count);
            test::forEveryTarget([&] {
                brdf->eval(wo, points.first(count), values.data());
                if (first.empty()) first = values;
                const double largest = *std::max_element(first.begin(), first.end());
                EXPECT_GT(largest, 0);
                for (std::size_t k = 0; k < 3 * count; ++k)
                    ASSERT_NEAR(values[k], first[k], 1e-12 * largest) << k << ", wo at " << theta;
            });
        }
    }
}

}  // namespace
}  // namespace hshfit
