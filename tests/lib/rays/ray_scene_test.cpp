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

/// Many rays at once, of a number that no packet divides, meet what single rays meet, also about a
/// mesh that is not at the origin.
TEST(RayScene, PacketsMeetWhatSingleRaysMeet) {
    Mesh mesh = sphereMesh(4);
    for (MeshVector& p : mesh.positions) p = {p[0] + 100, p[1] - 7, p[2] + 3};
    const RayScene scene(mesh);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-1.5, 1.5);
    std::vector<Ray> rays;
    for (int k = 0; k < 1003; ++k) {
        rays.push_back({{100 + place(random), -7 + place(random), 3 + place(random)},
                        {static_cast<float>(place(random)), static_cast<float>(place(random)),
                         static_cast<float>(place(random))}});
    }
    std::vector<RayHit> hits(rays.size());
    scene.firstHits(rays, hits);
    std::size_t met = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const auto& d = rays[k].direction;
        const auto single = scene.firstHitOnce(rays[k].origin, {d[0], d[1], d[2]});
        ASSERT_EQ(single.has_value(), std::isfinite(hits[k].distance)) << k;
        if (!single) continue;
        ++met;
        EXPECT_NEAR(hits[k].distance, single->distance, 1e-5 * (1 + single->distance));
    }
    EXPECT_GT(met, 300U);
    EXPECT_LT(met, 900U);
}

/// Rays from places inside of closed meshes at their vertices, where Embree's own test leaks, and
/// everywhere else. The needle is turned and thin; the other mesh is far from the origin.
TEST(RayScene, MissesNothingOfAClosedMesh) {
    for (const double far : {0.0, 1000.0}) {
        Mesh mesh = sphereMesh(5);
        for (MeshVector& p : mesh.positions) {
            p = {static_cast<float>(far + 0.6 * p[0] - 0.08 * p[1]),
                 static_cast<float>(far + 0.8 * p[0] + 0.06 * p[1]),
                 static_cast<float>(far + 0.3 * p[2])};
        }
        const RayScene scene(mesh);
        std::mt19937 random(5);
        std::uniform_real_distribution<double> place(-0.02, 0.02), any(-1, 1);
        int leaks = 0;
        for (int k = 0; k < 200000; ++k) {
            const std::array<double, 3> origin{far + place(random), far + place(random),
                                               far + place(random)};
            const MeshVector& vertex = mesh.positions[random() % mesh.positions.size()];
            const Direction at{vertex[0] - origin[0], vertex[1] - origin[1], vertex[2] - origin[2]};
            leaks += scene.firstHitOnce(origin, at) ? 0 : 1;
            ASSERT_TRUE(scene.firstHit(origin, at)) << k;
            ASSERT_TRUE(scene.firstHit(origin, {any(random), any(random), any(random)})) << k;
        }
        // The second ray is needed.
        if (far == 0) {
            EXPECT_GT(leaks, 0);
        }
    }
}

}  // namespace
