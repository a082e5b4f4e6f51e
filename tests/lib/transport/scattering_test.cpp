#include <hshfit/brdf/vectors.h>
#include <hshfit/transport/random_numbers.h>
#include <hshfit/transport/scattering.h>

#include <lib/transport/law_scenes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace hshfit {
namespace {

using test::materialOf;

/// One triangle whose normals lean by `lean` against it.
SurfaceScene leaning(const std::string& material, double lean) {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const MeshVector normal{static_cast<float>(std::sin(lean)), 0,
                            static_cast<float>(std::cos(lean))};
    mesh.normals = {normal, normal, normal};
    return {{materialOf(material)}, {{"triangle", mesh, 0, {}}}, {}};
}

/// A hit seen from 30 degrees above the horizon, on the side to which the normals do not lean.
SurfaceHit hitOf(const SurfaceScene& scene) {
    const Direction down = normalised({0.5, 0.3, -0.6});
    const auto hit = scene.firstHit({-down.x, -down.y, -down.z}, down);
    if (!hit) throw std::logic_error("no triangle is met");
    return *hit;
}

/// Integrals over the upper hemisphere of the world by the midpoint rule in cos(theta) and phi.
template <typename Function>
double integral(const Function& f) {
    constexpr int rows = 200, columns = 400;
    double sum = 0;
    for (int i = 0; i < rows; ++i) {
        const double z = (i + 0.5) / rows, r = std::sqrt(1 - z * z);
        for (int j = 0; j < columns; ++j) {
            const double phi = 2 * pi * (j + 0.5) / columns;
            sum += f(Direction{r * std::cos(phi), r * std::sin(phi), z});
        }
    }
    return sum * 2 * pi / (rows * columns);
}

class Scattering : public testing::TestWithParam<const char*> {};

/// The albedo of the BRDF in its own frame, by the same rule, whatever the normals lean by.
TEST_P(Scattering, KeepsTheAlbedoUnderLeaningNormals) {
    for (const double lean : {0.0, 0.2, 0.7}) {
        const SurfaceScene scene = leaning(GetParam(), lean);
        const SurfaceHit hit = hitOf(scene);
        const double albedo =
            integral([&](const Direction& wi) { return scene.reflectance(hit, wi)[0] * wi.z; });
        const double found =
            integral([&](const Direction& world) { return reflectedShare(scene, hit, world)[0]; });
        EXPECT_NEAR(found, albedo, 2e-3 * albedo) << lean;
        EXPECT_NEAR(
            integral([&](const Direction& world) { return scatteringPdf(scene, hit, world); }), 1,
            2e-3)
            << lean;
        EXPECT_EQ(reflectedShare(scene, hit, -1.0 * hit.flat), Rgb{});
    }
}

/// Samples leave above the triangle, and their weights have the albedo as their mean.
TEST_P(Scattering, SamplesWhatItStates) {
    const SurfaceScene scene = leaning(GetParam(), 0.7);
    const SurfaceHit hit = hitOf(scene);
    const double albedo =
        integral([&](const Direction& wi) { return scene.reflectance(hit, wi)[0] * wi.z; });
    RandomNumbers random(3, 0);
    constexpr int count = 40000;
    double mean = 0, squares = 0;
    int below = 0;
    for (int k = 0; k < count; ++k) {
        const double a = random.next(), b = random.next();
        const std::array<double, 3> u{a, b, random.next()};
        const Sample own = scene.material(hit).sampler->sample(hit.wo, u);
        if (dot(hit.frame.toWorld(own.wi), hit.flat) < 0) ++below;
        const auto sample = scatter(scene, hit, u);
        if (!sample) continue;
        EXPECT_GT(dot(sample->world, hit.flat), 0);
        mean += sample->weight[0] / count;
        squares += sample->weight[0] * sample->weight[0] / count;
    }
    const double error = std::sqrt(std::max(0.0, squares - mean * mean) / count);
    EXPECT_NEAR(mean, albedo, 4 * error + 2e-3 * albedo);
    EXPECT_LT(error, 0.01);
    // Some of the material's own samples go into the triangle.
    EXPECT_GT(below, count / 100);
}

INSTANTIATE_TEST_SUITE_P(Materials, Scattering,
                         testing::Values("lambert", "oren-nayar:sigma=.5", "ggx:alpha=.5",
                                         "phong:exponent=22"));

}  // namespace
}  // namespace hshfit
