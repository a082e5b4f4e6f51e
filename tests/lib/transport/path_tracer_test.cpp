#include <hshfit/light/catalog.h>
#include <hshfit/light/light_samples.h>
#include <hshfit/quadrature/quadrature.h>
#include <hshfit/rendering/view.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/transport/path_tracer.h>

#include <brdfs/catalog.h>
#include <lib/transport/law_scenes.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>

namespace hshfit {
namespace {

using test::materialOf;

/// A square of the given half width at a height, its front upwards.
Mesh squareMesh(float half, float height) {
    Mesh mesh;
    mesh.positions = {
        {-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    completeNormals(mesh);
    return mesh;
}

/// The inside of a sphere of radius 1 is its front, with flat triangles.
Mesh insideOfSphere(int levels) {
    Mesh mesh = sphereMesh(levels);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    mesh.normals.clear();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        std::array<double, 3> sum{};
        for (const std::uint32_t v : mesh.triangles[t])
            for (std::size_t k = 0; k < 3; ++k) sum[k] -= mesh.positions[v][k];
        const double length = std::hypot(sum[0], sum[1], sum[2]);
        const MeshVector normal{static_cast<float>(sum[0] / length),
                                static_cast<float>(sum[1] / length),
                                static_cast<float>(sum[2] / length)};
        mesh.normals.insert(mesh.normals.end(), 3, normal);
    }
    return mesh;
}

/// Within four standard errors of an expected value, and not by errors that hide everything.
void expectRadiance(const PathEstimate& found, double expected, double mostError,
                    const std::string& what = {}) {
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(found.radiance[c], expected, 4 * found.error[c] + 1e-6 * expected) << what;
        EXPECT_LE(found.error[c], mostError * expected) << what;
    }
}

/// A closed room of radiosity B = M + rho B: radiance E / (1 - rho) everywhere.
TEST(TracePaths, FindTheRadianceOfAClosedRoom) {
    for (const double albedo : {0.0, 0.5, 0.9}) {
        const SurfaceScene scene({materialOf("lambert:kd=" + std::to_string(albedo))},
                                 {{"room", insideOfSphere(3), 0, {1, 1, 1}}}, {});
        for (const Direction& along : {Direction{0, 0, 1}, Direction{0.6, 0, -0.8}}) {
            const PathEstimate found =
                tracePaths(scene, {0.1, -0.2, 0.3}, along, {.samples = 4000});
            expectRadiance(found, 1 / (1 - albedo), 0.03);
        }
    }
}

/// A white object under even light from everywhere cannot be seen, whatever its shape: every ray
/// that leaves it meets 1, now or later.
TEST(TracePaths, HideAWhiteObjectInAFurnace) {
    Mesh bowl = insideOfSphere(3);
    std::erase_if(bowl.triangles, [&](const auto& t) { return bowl.positions[t[0]][2] > 0.2F; });
    bowl.normals.clear();
    completeNormals(bowl);
    const SurfaceScene scene({materialOf("lambert")}, {{"bowl", bowl, 0, {}}},
                             parseLights("uniform").lights);
    for (const Direction& along : {Direction{0, 0, -1}, Direction{0.6, 0, -0.8}})
        expectRadiance(tracePaths(scene, {0, 0, 1.5}, along, {.samples = 4000}), 1, 0.01);
}

/// In a sphere every part sees every other alike, by its area: light that comes back is
/// rho / (1 - rho) times the mean of what is emitted.
TEST(TracePaths, FindTheLightOfALampInASphere) {
    const double albedo = 0.7;
    const Mesh whole = insideOfSphere(4);
    Mesh lamp = whole, wall = whole;
    lamp.normals.clear(), wall.normals.clear();
    lamp.triangles.clear(), wall.triangles.clear();
    double lampArea = 0, area = 0;
    for (std::size_t k = 0; k < whole.triangles.size(); ++k) {
        const auto& t = whole.triangles[k];
        std::array<std::array<double, 3>, 2> edges{};
        for (std::size_t e = 0; e < 2; ++e)
            for (std::size_t i = 0; i < 3; ++i)
                edges[e][i] = whole.positions[t[e + 1]][i] - whole.positions[t[0]][i];
        const double x = edges[0][1] * edges[1][2] - edges[0][2] * edges[1][1];
        const double y = edges[0][2] * edges[1][0] - edges[0][0] * edges[1][2];
        const double z = edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0];
        const double one = std::hypot(x, y, z) / 2;
        const bool lit = whole.positions[t[0]][2] > 0.8F;
        area += one;
        if (lit) lampArea += one;
        Mesh& to = lit ? lamp : wall;
        to.triangles.push_back(t);
        to.normals.insert(to.normals.end(), whole.normals.begin() + 3 * static_cast<long>(k),
                          whole.normals.begin() + 3 * static_cast<long>(k) + 3);
    }
    const SurfaceScene scene({materialOf("lambert:kd=" + std::to_string(albedo))},
                             {{"lamp", lamp, 0, {1, 1, 1}}, {"wall", wall, 0, {}}}, {});
    const double expected = albedo / (1 - albedo) * lampArea / area;
    for (const Direction& along : {Direction{0, 0, -1}, Direction{0.8, 0, -0.6}}) {
        // The mesh is a sphere up to the depth of its triangles, about 1 %.
        const PathEstimate found = tracePaths(scene, {0, 0, 0}, along, {.samples = 20000});
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(found.radiance[c], expected, 4 * found.error[c] + 0.01 * expected);
    }
}

/// Between two endless plates radiance is E / (1 - rho); these reach 1,000 times their distance.
TEST(TracePaths, FindTheRadianceBetweenTwoPlates) {
    Mesh lower = squareMesh(1000, 0), upper = squareMesh(1000, 1);
    for (auto& t : upper.triangles) std::swap(t[1], t[2]);
    const SurfaceScene scene({materialOf("lambert:kd=.5")},
                             {{"lower", lower, 0, {1, 1, 1}}, {"upper", upper, 0, {1, 1, 1}}}, {});
    expectRadiance(tracePaths(scene, {0, 0, 0.5}, {0.36, 0.48, -0.8}, {.samples = 20000}), 2, 0.01);
}

/// Every light of the catalog on a plane, against the nodes that follow its shape.
TEST(TracePaths, AgreeWithQuadratureUnderEveryLightOfTheCatalog) {
    const Direction normal{0, 0, 1};
    const Frame frame = frameAt(normal);
    for (const std::string spec : {"lambert", "ggx:alpha=.3"}) {
        for (const std::string& example : lightExamples()) {
            const std::vector<Light> lights = parseLights(example).lights;
            const SurfaceMaterial material = materialOf(spec);
            const SurfaceScene scene({material}, {{"plane", squareMesh(10, 0), 0, {}}}, lights);
            const Direction along = directionFromAngles(radians(150), radians(30));
            const Direction wo = frame.toLocal({-along.x, -along.y, -along.z});
            const LightSamples samples = sampleLights(lights, frame, 5);
            std::vector<double> f(samples.count() * material.brdf->channels().count());
            material.brdf->eval(wo, samples.directions(), f.data());
            Rgb expected{};
            for (std::size_t k = 0; k < samples.count(); ++k)
                for (std::size_t c = 0; c < 3; ++c)
                    expected[c] += samples.flux[c][k] * f[k] * samples.z[k];
            const PathEstimate found = tracePaths(scene, {0, 0, 1}, along, {.samples = 20000});
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_NEAR(found.radiance[c], expected[c], 4 * found.error[c] + 1e-3 * expected[c])
                    << spec << " under " << example;
                EXPECT_LE(found.error[c], 0.05 * expected[c] + 1e-12)
                    << spec << " under " << example;
            }
        }
    }
}

/// The mean of radiance over density is the integral of radiance, over a hemisphere.
TEST(EnvironmentSampler, FindsTheIntegralOfRadiance) {
    for (const std::string& example : lightExamples()) {
        const EnvironmentSampler sampler(parseLights(example).lights);
        ASSERT_TRUE(sampler.any()) << example;
        if (sampler.sample({.5, .5, .5}).delta) continue;
        const Direction pole = sampler.sample({.3, .6, .9}).world;
        double sum = 0, squares = 0;
        constexpr int count = 40000;
        double state = 0.5, other = 0.25, third = 0.75;
        for (int k = 0; k < count; ++k) {
            state = std::fmod(state + 0.819172513396164, 1);
            other = std::fmod(other + 0.671043606703789, 1);
            third = std::fmod(third + 0.549700477901970, 1);
            const EnvironmentSample sample = sampler.sample({state, other, third});
            ASSERT_GT(sample.pdf, 0) << example;
            ASSERT_NEAR(sample.pdf, sampler.pdf(sample.world), 1e-9 * sample.pdf);
            const double inside = dot(sample.world, pole) > 0 ? 1 : 0;
            sum += inside * (sample.radiance[1] / sample.pdf);
            squares += std::pow(inside * (sample.radiance[1] / sample.pdf), 2);
        }
        const double mean = sum / count;
        const double error = std::sqrt(std::max(0.0, squares / count - mean * mean) / count);
        // The integral of radiance over the hemisphere about the pole, by quadrature.
        const double theta = polarAngle(pole), phi = azimuth(pole);
        const LightSamples nodes =
            sampleLights(parseLights(example).lights, Frame({.theta = theta, .phi = phi}), 5);
        double expected = 0;
        for (std::size_t k = 0; k < nodes.count(); ++k) expected += nodes.flux[1][k];
        EXPECT_NEAR(mean, expected, 4 * error + 2e-3 * expected) << example;
    }
}

TEST(TracePaths, SplitIntoDirectAndIndirectLight) {
    const Mesh floor = squareMesh(1, 0);
    Mesh lamp = squareMesh(0.5F, 1);
    for (auto& t : lamp.triangles) std::swap(t[1], t[2]);
    const SurfaceScene scene({materialOf("lambert:kd=.8")},
                             {{"floor", floor, 0, {}}, {"lamp", lamp, 0, {1, 1, 1}}}, {});
    const Point eye{0.9, 0, 0.5};
    const Direction along = directionFromAngles(radians(160), radians(180));
    const PathEstimate all = tracePaths(scene, eye, along, {.samples = 20000});
    const PathEstimate indirect =
        tracePaths(scene, eye, along, {.samples = 20000, .fewestBounces = 2});
    const PathEstimate direct = tracePaths(scene, eye, along, {.samples = 20000, .mostBounces = 1});
    EXPECT_NEAR(all.radiance[0], direct.radiance[0] + indirect.radiance[0],
                4 * std::hypot(all.error[0], direct.error[0], indirect.error[0]));
    EXPECT_GT(indirect.radiance[0], 0.02 * all.radiance[0]);
}

TEST(TracePaths, GiveTheSamePictureOnAnyNumberOfThreads) {
    const SurfaceScene scene({materialOf("ggx:alpha=.4")}, {{"ball", sphereMesh(2), 0, {}}},
                             parseLights("sky:type=12,elevation=40").lights);
    const Camera camera{.name = "eye", .position = {3, 1, 1}, .width = 24, .height = 16};
    const PathPicture many = tracePaths(scene, camera, {.samples = 8});
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const PathPicture single = tracePaths(scene, camera, {.samples = 8});
    EXPECT_EQ(many.radiance, single.radiance);
    EXPECT_EQ(many.error, single.error);
    EXPECT_EQ(many.rays, single.rays);
}

/// A pixel's standard error agrees with the scatter of its mean over seeds.
TEST(TracePaths, StateTheErrorOfAPixel) {
    const SurfaceScene scene({materialOf("lambert:kd=.5")}, {{"ball", sphereMesh(3), 0, {}}},
                             parseLights("sky:type=12,elevation=40").lights);
    double sum = 0, squares = 0, stated = 0;
    constexpr int runs = 200;
    for (int seed = 1; seed <= runs; ++seed) {
        const PathEstimate found =
            tracePaths(scene, {3, 0, 0.5}, {-1, 0, 0},
                       {.samples = 16, .seed = static_cast<std::uint64_t>(seed)});
        sum += found.radiance[1];
        squares += found.radiance[1] * found.radiance[1];
        stated += found.error[1] / runs;
    }
    const double mean = sum / runs, scatter = std::sqrt(squares / runs - mean * mean);
    EXPECT_NEAR(stated / scatter, 1, 0.25);
}

}  // namespace
}  // namespace hshfit
