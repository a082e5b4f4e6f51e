// Rays against a sphere's closed form.

#include <hshfit/rays/ray_scene.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace hshfit;

namespace {

TEST(RayScene, DistancesToASphereAreTheClosedForm) {
    const Mesh mesh = sphereMesh(6);
    const RayScene scene(mesh);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> place(-1.2, 1.2);
    int hits = 0;
    for (int k = 0; k < 2000; ++k) {
        const double x = place(random), y = place(random), squared = x * x + y * y;
        const auto hit = scene.firstHit({x, y, 5}, {0, 0, -1});
        // Edges of 2.5 degrees at most: the middle of a triangle is e^2 / 6 below the sphere.
        if (squared > 1) {
            EXPECT_FALSE(hit);
        }
        if (squared > 0.99) continue;
        ASSERT_TRUE(hit) << x << " " << y;
        const double z = std::sqrt(1 - squared);
        EXPECT_NEAR(hit->distance, 5 - z, 3.2e-4 / z);
        const auto& t = mesh.triangles[hit->triangle];
        const double w = 1 - hit->u - hit->v;
        EXPECT_NEAR(w * mesh.positions[t[0]][0] + hit->u * mesh.positions[t[1]][0] +
                        hit->v * mesh.positions[t[2]][0],
                    x, 1e-5);
        ++hits;
    }
    EXPECT_GT(hits, 500);
}

TEST(RayScene, BothSidesAreMetBeyondTheNearestDistance) {
    const RayScene scene(sphereMesh(4));
    const auto out = scene.firstHit({0.01, 0.02, 0}, {0, 0, 1});
    ASSERT_TRUE(out);
    EXPECT_NEAR(out->distance, 1, 0.01);
    const auto far = scene.firstHit({0.01, 0.02, 5}, {0, 0, -1}, 4.5);
    ASSERT_TRUE(far);
    EXPECT_NEAR(far->distance, 6, 0.01);
    EXPECT_FALSE(scene.firstHit({0.01, 0.02, 5}, {0, 0, 1}));
}

}  // namespace
