// Laws that path tracing is held to over whole scenes: light by bounce, lamps, furnaces, bias.

#include <hshfit/light/catalog.h>
#include <hshfit/rendering/view.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/transport/path_tracer.h>

#include "places.h"

#include <brdfs/catalog.h>
#include <lib/transport/box_radiosity.h>
#include <lib/transport/cornell_radiosity.h>
#include <lib/transport/law_scenes.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

namespace hshfit {
namespace {

using test::materialOf;

/// The rows of form factors of a closed box are 1; without the front, 1 less that to the front.
TEST(BoxRadiosity, FormFactorsAreThoseOfParallelAndPerpendicularSquares) {
    // Opposite and adjacent faces of a cube (Howell, A Catalog of Radiation Configuration Factors,
    // C-11 and C-14, at equal sides).
    const double opposite =
        2 / pi *
        (0.5 * std::log(4.0 / 3) + 2 * std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) -
         2 * std::atan(1.0));
    const auto light = test::radianceByBounce(8, 1);
    // The whole ceiling's plane is more than the lamp: adding up lamps of all cells would be the
    // factor. Two faces by quadrature of the same point factors:
    const test::Rectangle below{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        above{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}, beside{{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const GaussRule& gauss = gaussLegendre(40);
    double up = 0, aside = 0;
    for (std::size_t a = 0; a < gauss.nodes.size(); ++a) {
        for (std::size_t b = 0; b < gauss.nodes.size(); ++b) {
            const Direction p = below.at((1 + gauss.nodes[a]) / 2, (1 + gauss.nodes[b]) / 2);
            const double w = gauss.weights[a] * gauss.weights[b] / 4;
            up += w * test::pointFactor(p, {0, 0, 1}, above);
            aside += w * test::pointFactor(p, {0, 0, 1}, beside);
        }
    }
    EXPECT_NEAR(up, opposite, 1e-9);
    EXPECT_NEAR(aside, (1 - opposite) / 4, 1e-3);
    EXPECT_GT(light[1][test::floor][0], 0);
}

/// The Cornell box with its blocks, by bounce, in R, G and B: within four standard errors and what
/// patches of half the size change.
TEST(TracePaths, FollowRadiosityInTheCornellBox) {
    const std::string folder = test::sharedFolder() + "/data/mesh/cbox";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
    const test::CornellBox box(folder);
    const SurfaceScene scene = box.scene();
    constexpr int bounces = 3;
    const auto coarse = box.radianceByBounce(5, bounces), fine = box.radianceByBounce(10, bounces);
    for (int bounce = 1; bounce <= bounces; ++bounce) {
        for (std::size_t object = 0; object < test::CornellBox::lamp; ++object) {
            if (bounce == 1 && object == 1) continue;  // the ceiling is above the lamp
            const PathEstimate found = box.traced(scene, object, bounce, 4000);
            const auto k = static_cast<std::size_t>(bounce);
            for (std::size_t c = 0; c < 3; ++c) {
                const double expected = fine[k][object][c];
                EXPECT_NEAR(found.radiance[c], expected,
                            4 * found.error[c] + std::abs(expected - coarse[k][object][c]))
                    << test::CornellBox::names[object] << ", bounce " << bounce;
                EXPECT_LE(found.error[c], 0.1 * expected);
            }
        }
    }
}

/// Each bounce of light in the box, on every wall, in R, G and B.
TEST(TracePaths, FollowRadiosityBounceByBounce) {
    const SurfaceScene scene = test::boxScene();
    constexpr int bounces = 4;
    const auto coarse = test::radianceByBounce(4, bounces),
               fine = test::radianceByBounce(8, bounces);
    for (int bounce = 1; bounce <= bounces; ++bounce) {
        for (const std::size_t wall : {test::floor, test::ceiling, test::back, test::left}) {
            const PathEstimate found = test::tracedRadiance(scene, wall, bounce, 20000);
            for (std::size_t c = 0; c < 3; ++c) {
                const double expected = fine[static_cast<std::size_t>(bounce)][wall][c];
                const double step =
                    std::abs(expected - coarse[static_cast<std::size_t>(bounce)][wall][c]);
                EXPECT_NEAR(found.radiance[c], expected, 4 * found.error[c] + step)
                    << "bounce " << bounce << ", wall " << wall << ", channel " << c;
                EXPECT_LE(4 * found.error[c] + step, 0.12 * expected + 1e-12);
            }
        }
    }
}

/// A sphere of radiance L and radius r gives a plane the irradiance pi L (r / d)^2 cos(theta).
TEST(TracePaths, FindTheLightOfASmallSphere) {
    Mesh floor = squareMesh();
    for (MeshVector& p : floor.positions) p = {20 * p[0], 20 * p[1], 0};
    const double r = 0.05, height = 2;
    Mesh lamp = sphereMesh(5);
    for (MeshVector& p : lamp.positions)
        p = {static_cast<float>(r * p[0]), static_cast<float>(r * p[1]),
             static_cast<float>(height + r * p[2])};
    lamp.normals.clear();
    const SurfaceScene scene({materialOf("lambert:kd=.6"), materialOf("lambert:kd=0")},
                             {{"floor", floor, 0, {}}, {"lamp", lamp, 1, {100, 100, 100}}}, {});
    for (const double x : {0.0, 1.0, 3.0}) {
        const PathEstimate found = tracePaths(scene, {x, 0, 0.1}, {0, 0, -1}, {.samples = 8000});
        const double squared = x * x + height * height;
        const double expected = 0.6 * 100 * r * r / squared * height / std::sqrt(squared);
        // The mesh is inscribed: edges of e = 2.8 degrees cost e^2 / 6 of its outline's area.
        const double inscribed = std::pow(radians(90.0 / 32), 2) / 4;
        EXPECT_NEAR(found.radiance[0], expected, 4 * found.error[0] + inscribed * expected);
        EXPECT_LE(found.error[0], 0.02 * expected);
    }
}

class WhiteFurnace : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Normals, WhiteFurnace, testing::Bool(),
                         [](const auto& each) { return each.param ? "flat" : "interpolated"; });

/// White things in an even light of 1: every pixel is 1.
TEST_P(WhiteFurnace, SeesNothingOfAWhiteScene) {
    const auto scene = test::whiteFurnace(GetParam(), 1);
    Camera camera{.name = "eye", .position = {4, 2, 2}, .width = 12, .height = 12};
    const PathPicture found = tracePaths(*scene, camera, {.samples = 1024});
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < found.radiance.size(); ++k) {
        const double error = std::max(1e-6, double{found.error[k]});
        EXPECT_NEAR(found.radiance[k], 1, 5 * error);
        EXPECT_LT(error, 0.03);
        sum += found.radiance[k] / static_cast<double>(found.radiance.size());
        squares += error * error;
    }
    EXPECT_NEAR(sum, 1, 4 * std::sqrt(3 * squares) / static_cast<double>(found.radiance.size()));
    EXPECT_NEAR(sum, 1, 3e-3);
}

/// The mean of 1,000 runs of 4 paths, and one run of 4,000, in many directions, all by seeds of
/// their own: their differences scatter as their errors say, neither farther nor to one side.
TEST(TracePaths, AreWithoutBias) {
    const auto scene = test::glossyBall();
    constexpr int directions = 60;
    double sum = 0, squares = 0, largest = 0;
    for (int k = 0; k < directions; ++k) {
        const double z = test::biasTrial(
            *scene, normalised({-4, -1.2 + 0.04 * k, -1 + 0.3 * (k % 5 - 2)}), 1000, 4, k);
        sum += z;
        squares += z * z;
        largest = std::max(largest, std::abs(z));
    }
    EXPECT_LT(std::abs(sum) / std::sqrt(directions), 3.5);
    EXPECT_NEAR(squares / directions, 1, 4 * std::sqrt(2.0 / directions));
    EXPECT_LT(largest, 4.5);
}

/// Rays that are scattered by the inside of a closed mesh stay there, and never meet the triangle
/// that they leave: far from the origin, thin, and with an acute edge.
TEST(SurfaceScene, KeepsRaysInAClosedMesh) {
    Mesh far = sphereMesh(4), thin = sphereMesh(4);
    for (MeshVector& p : far.positions)
        for (float& x : p) x += 500;
    for (MeshVector& p : thin.positions) p = {p[0], 0.02F * p[1] + 0.01F * p[0], 0.1F * p[2]};
    const auto high = static_cast<float>(2 * std::tan(radians(2.5)));
    const Mesh wedge{.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 2, high}, {0, 2, -high}},
                     .triangles = {{0, 1, 2}, {1, 0, 3}, {0, 2, 3}, {1, 3, 2}},
                     .normals = {}};
    struct Case {
        Mesh mesh;
        Point middle;
    };
    for (const Case& one :
         {Case{far, {500, 500, 500}}, Case{thin, {0, 0, 0}}, Case{wedge, {0, 1.5, 0}}}) {
        Mesh mesh = one.mesh;
        mesh.normals.clear();
        const SurfaceScene scene({materialOf("lambert")}, {{"closed", mesh, 0, {}}}, {});
        std::mt19937 random(9);
        std::normal_distribution<double> normal;
        const auto even = [&] {
            return normalised({normal(random), normal(random), normal(random)});
        };
        auto hit = scene.firstHit(one.middle, even());
        for (int k = 0; k < 100000; ++k) {
            ASSERT_TRUE(hit) << k;
            const Direction d = even();
            const auto next = scene.firstHit(
                *hit, normalised({hit->flat.x + d.x, hit->flat.y + d.y, hit->flat.z + d.z}));
            ASSERT_TRUE(next) << k;
            EXPECT_NE(next->triangle, hit->triangle);
            hit = next;
        }
    }
}

}  // namespace
}  // namespace hshfit
