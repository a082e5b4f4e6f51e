// Materials as cameras see them, where that is known.

#include <hshfit/brdf/vectors.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/plan/seen_surfaces.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit::plan {
namespace {

SurfaceScene sceneOf(std::vector<SurfaceObject> objects) {
    std::vector<SurfaceMaterial> materials(3);
    return {std::move(materials), std::move(objects), {}};
}

Mesh square(double half, double height) {
    Mesh mesh = squareMesh();
    for (MeshVector& p : mesh.positions) {
        for (float& x : p) x *= static_cast<float>(half);
        p[2] = static_cast<float>(height);
    }
    return mesh;
}

/// A plane from straight above: one orientation, and views up to the corner of the picture.
TEST(SeenMaterials, OfAPlaneFromAboveAreOneOrientation) {
    const SurfaceScene scene = sceneOf({{"floor", square(100, 0), 1, {}}});
    Camera camera{.name = "top", .position = {0, 0, 10}, .width = 200, .height = 100};
    camera.up = {0, 1, 0};
    camera.fieldOfView = radians(20);
    const auto seen = seenMaterials(scene, {&camera, 1});
    ASSERT_EQ(seen.size(), 3u);
    EXPECT_EQ(seen[0].hits, 0u);
    EXPECT_EQ(seen[1].hits, seen[1].rays);
    EXPECT_NEAR(static_cast<double>(seen[1].rays), 4096, 100);
    ASSERT_EQ(seen[1].orientations.size(), 1u);
    EXPECT_LT(seen[1].orientations[0].theta, 1e-6);
    EXPECT_EQ(seen[1].shares[0], 1);
    EXPECT_LT(seen[1].spread, 1e-6);
    // The half diagonal of a picture that is twice as wide as high.
    const double corner = std::atan(std::sqrt(5.0) * std::tan(radians(10)));
    EXPECT_LE(seen[1].views.thetaMax, corner);
    EXPECT_GT(seen[1].views.thetaMax, 0.9 * corner);
    EXPECT_LT(seen[1].views.thetaMin, 0.15 * corner);
    EXPECT_NEAR(seen[1].views.phiMax - seen[1].views.phiMin, 2 * pi, 1e-9);
}

/// Far away at 60 degrees, a wall facing +x has one view.
TEST(SeenMaterials, OfAFarWallHaveOneView) {
    Mesh wall = square(1, 0);
    for (MeshVector& p : wall.positions) p = {p[2], p[0], p[1]};
    wall.normals.clear();
    completeNormals(wall);
    const SurfaceScene scene = sceneOf({{"wall", wall, 0, {}}});
    const double theta = radians(60), far = 1e4;
    Camera camera{.name = "far",
                  .position = {far * std::cos(theta), far * std::sin(theta), 0},
                  .width = 64,
                  .height = 64};
    camera.fieldOfView = radians(0.01);
    const auto seen = seenMaterials(scene, {&camera, 1});
    ASSERT_EQ(seen[0].orientations.size(), 1u);
    const Orientation& orientation = seen[0].orientations[0];
    EXPECT_NEAR(orientation.theta, pi / 2, 1e-6);
    EXPECT_NEAR(std::sin(orientation.phi), 0, 1e-6);
    EXPECT_NEAR(std::cos(orientation.phi), 1, 1e-6);
    EXPECT_NEAR(seen[0].views.thetaMin, theta, 1e-3);
    EXPECT_NEAR(seen[0].views.thetaMax, theta, 1e-3);
    EXPECT_NEAR(seen[0].views.phiMin, seen[0].views.phiMax, 1e-3);
    // The view comes from the camera, with the frame that orientation and range describe.
    const Direction local = directionFromAngles(seen[0].views.thetaMin, seen[0].views.phiMin);
    const Direction world = Frame(orientation).toWorld(local);
    EXPECT_NEAR(world.x, std::cos(theta), 1e-3);
    EXPECT_NEAR(world.y, std::sin(theta), 1e-3);
    EXPECT_NEAR(world.z, 0, 1e-3);
}

/// A camera far away sees the half of a sphere that faces it, as a disc.
TEST(SeenMaterials, OfASphereAreHalfOfAllOrientations) {
    const SurfaceScene scene = sceneOf({{"ball", sphereMesh(6), 2, {}}});
    const double far = 1000;
    Camera camera{.name = "far", .position = {0, -far, 0}, .width = 300, .height = 300};
    // The picture is 4 x 4 at the sphere.
    camera.fieldOfView = 2 * std::atan(2 / far);
    const auto seen = seenMaterials(scene, {&camera, 1}, {.rays = 16384});
    EXPECT_NEAR(seen[2].share(), pi / 16, 0.005);
    ASSERT_EQ(seen[2].orientations.size(), 16u);
    // 16 caps of 25 degrees cover a half sphere of 16 x 25 degrees' area, and no smaller ones do.
    EXPECT_GT(seen[2].spread, std::acos(1 - 1.0 / 16));
    EXPECT_LT(seen[2].spread, radians(40));
    double shares = 0;
    for (std::size_t k = 0; k < 16; ++k) {
        const Orientation& each = seen[2].orientations[k];
        EXPECT_LT(directionFromAngles(each.theta, each.phi).y, 0);
        shares += seen[2].shares[k];
        if (k > 0) {
            EXPECT_LE(seen[2].shares[k], seen[2].shares[k - 1]);
        }
    }
    EXPECT_NEAR(shares, 1, 1e-12);
    // sin^2 of the view's angle is even over the disc: 1 % below asin 0.1, 1 % above asin 0.995.
    EXPECT_NEAR(seen[2].views.thetaMin, std::asin(std::sqrt(0.01)), 0.01);
    EXPECT_NEAR(seen[2].views.thetaMax, std::asin(std::sqrt(0.99)), 0.02);
}

TEST(SeenMaterials, TakeThePlaceOfUnstatedOrientationsAndViewsAlone) {
    const SurfaceScene surfaces =
        sceneOf({{"floor", square(1, 0), 0, {}}, {"ball", sphereMesh(2), 1, {}}});
    Camera camera{.name = "eye", .position = {0, -3, 3}, .width = 64, .height = 64};
    const auto seen = seenMaterials(surfaces, {&camera, 1}, {.rays = 400});
    const Orientation stated{.theta = 1};
    const auto fresh = [&] {
        Scene scene{.file = "scene.json"};
        scene.materials = {{.name = "a", .brdf = "x"},
                           {.name = "b", .brdf = "x", .orientations = {stated}},
                           {.name = "c", .brdf = "x"}};
        scene.materials[1].orientationsStated = true;
        return scene;
    };
    Scene scene = fresh();
    takeSeen(scene, seen);
    EXPECT_EQ(scene.materials[0].orientations.size(), 1u);
    EXPECT_TRUE(scene.materials[0].views);
    ASSERT_EQ(scene.materials[1].orientations.size(), 1u);
    EXPECT_EQ(scene.materials[1].orientations[0].theta, 1);
    EXPECT_TRUE(scene.materials[1].views);
    EXPECT_FALSE(scene.materials[2].views);
    EXPECT_NE(sentenceOf(seen[2], 1).find("no camera sees it"), std::string::npos);
    Scene viewed = fresh();
    viewed.viewsStated = true;
    takeSeen(viewed, seen);
    EXPECT_FALSE(viewed.materials[0].views);
}

}  // namespace
}  // namespace hshfit::plan
