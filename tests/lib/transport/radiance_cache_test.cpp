#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/rendering/view.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/transport/radiance_cache/cached_picture.h>
#include <hshfit/transport/radiance_cache/cost_prediction.h>

#include <brdfs/catalog.h>
#include <lib/transport/cache_scenes.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

namespace hshfit {
namespace {

using test::litRoom;
using test::materialOf;
using test::patch;
using test::room;

const Camera eye{.name = "eye",
                 .position = {0.1, -0.2, 0.9},
                 .target = {0.2, 0.4, -1},
                 .fieldOfView = 70 * (pi / 180),
                 .width = 48,
                 .height = 40};

/// The largest distance of a picture's numbers from 1.
double distanceFromOne(const CachedPicture& taken) {
    double most = 0;
    for (const float value : taken.picture.radiance)
        most = std::max(most, std::abs(static_cast<double>(value) - 1));
    return most;
}

CacheOptions gatheredLight() {
    CacheOptions options{.rays = 400, .surfacePoints = 500, .surfaceRays = 64};
    options.direct = DirectLight::gathered;
    return options;
}

/// White walls under an even sky reflect what they get: each pixel is 1.
TEST(RadianceCache, HidesAnOpenWhiteRoomUnderAnEvenSky) {
    const SurfaceScene scene({materialOf("lambert")}, room({}, false),
                             parseLights("uniform").lights);
    RadianceCache cache(scene, gatheredLight());
    const CachedPicture taken = takePicture(cache, eye, {.samples = 1});
    EXPECT_GT(taken.made, 10U);
    EXPECT_LT(distanceFromOne(taken), 1e-3);
}

/// A closed room of emission 0.2 and albedo 0.8, in which radiance is 1 everywhere.
TEST(RadianceCache, HidesAClosedRoom) {
    const SurfaceScene scene({materialOf("lambert:kd=0.8")}, room({0.2, 0.2, 0.2}, true), {});
    RadianceCache cache(scene, gatheredLight());
    EXPECT_LT(distanceFromOne(takePicture(cache, eye, {.samples = 1})), 1e-3);
}

/// Radiance 1 from everywhere: a glossy floor shows its directional albedo, in every basis.
TEST(RadianceCache, ShowsTheAlbedoOfAGlossyFloorUnderEvenLight) {
    const std::string spec = "phong:kd=.2,ks=.6,exponent=8,normalized=true";
    const auto brdf = brdfs::open(spec);
    for (const char* basis : {"hsh", "makhotkin", "zernike"}) {
        std::vector<SurfaceObject> objects;
        objects.push_back({"floor", patch({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), 0, {}});
        const SurfaceScene scene({materialOf(spec)}, std::move(objects),
                                 parseLights("uniform").lights);
        CacheOptions options = gatheredLight();
        options.choice = {.basis = basis, .order = 12, .loss = 0.01};
        RadianceCache cache(scene, options);
        ASSERT_EQ(cache.materials().materials[0].way, LightWay::coefficients) << basis;
        for (const double theta : {0.1, 0.7, 1.2}) {
            const Direction along = directionFromAngles(theta, 0.6);
            const auto hit = scene.firstHit({along.x, along.y, along.z}, -along);
            ASSERT_TRUE(hit);
            cache.make({*hit}, {0.01});
            Rgb found{};
            ASSERT_TRUE(cache.radiance(*hit, found));
            EXPECT_NEAR(found[0], directionalAlbedo(*brdf, hit->wo)[0], 0.004)
                << basis << " " << theta;
        }
    }
}

/// Light of two and more reflections in a sphere is rho^2 / (1 - rho) times the share of the lamp
/// in every direction.
TEST(RadianceCache, FindsTheIndirectLightOfALampInASphere) {
    const double albedo = 0.7;
    Mesh lamp = sphereMesh(4);
    for (auto& t : lamp.triangles) std::swap(t[1], t[2]);
    lamp.normals.clear();
    Mesh wall = lamp;
    const auto lit = [&](const auto& t) { return lamp.positions[t[0]][2] > 0.8F; };
    const auto areaOf = [](const Mesh& mesh) {
        double area = 0;
        for (const auto& t : mesh.triangles) {
            const Direction a = directionOf(mesh.positions[t[0]]);
            const Direction n =
                cross(directionOf(mesh.positions[t[1]]) - a, directionOf(mesh.positions[t[2]]) - a);
            area += std::sqrt(dot(n, n)) / 2;
        }
        return area;
    };
    std::erase_if(wall.triangles, lit);
    std::erase_if(lamp.triangles, [&](const auto& t) { return !lit(t); });
    completeNormals(lamp), completeNormals(wall);
    const double share = areaOf(lamp) / (areaOf(lamp) + areaOf(wall));
    const SurfaceScene scene({materialOf("lambert:kd=" + std::to_string(albedo))},
                             {{"lamp", lamp, 0, {1, 1, 1}}, {"wall", wall, 0, {}}}, {});
    CacheOptions options{.rays = 1000, .fewestBounces = 2, .surfacePoints = 1000};
    RadianceCache cache(scene, options);
    const Camera inside{.name = "inside",
                        .position = {0, 0, 0},
                        .target = {0.5, 0, -1},
                        .fieldOfView = 80 * (pi / 180),
                        .width = 24,
                        .height = 24};
    const CachedPicture taken = takePicture(cache, inside, {.samples = 1});
    const double expected = albedo * albedo / (1 - albedo) * share;
    double mean = 0;
    for (const float value : taken.picture.radiance) {
        // The mesh is a sphere up to the depth of its triangles, and its normals are smooth.
        EXPECT_NEAR(value, expected, 0.06 * expected);
        mean += static_cast<double>(value) / static_cast<double>(taken.picture.radiance.size());
    }
    EXPECT_NEAR(mean, expected, 0.015 * expected);
}

/// Eq. 24: light kept in the frame of one normal serves another, as if it had been gathered there.
TEST(RadianceCache, TurnsLightIntoTheFrameOfAnotherNormal) {
    for (const char* spec : {"phong:kd=.1,ks=.8,exponent=12,normalized=true", "lambert:kd=.8"}) {
        std::vector<SurfaceObject> objects;
        objects.push_back({"floor", patch({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), 0, {}});
        objects.push_back({"lamp", patch({-0.5, -0.4, 1.5}, {0, 1, 0}, {1, 0, 0}), 1, {1, 1, 1}});
        const SurfaceScene scene({materialOf(spec), materialOf("lambert:kd=0")}, std::move(objects),
                                 {});
        const Direction away = normalised({0.5, 0.3, 0.8});
        const SurfaceHit flat = *scene.firstHit({0.7 + away.x, away.y, away.z}, -away);
        SurfaceHit tilted = flat;
        tilted.frame = frameAt(normalised({0.12, -0.05, 1}));
        tilted.wo = normalised(tilted.frame.toLocal(away));
        CacheOptions options = gatheredLight();
        options.rays = 4000;
        RadianceCache there(scene, options), here(scene, options);
        there.make({flat}, {1});
        here.make({tilted}, {1});
        Rgb turned{}, gathered{}, unturned{};
        ASSERT_TRUE(there.radiance(tilted, turned));
        ASSERT_TRUE(here.radiance(tilted, gathered));
        ASSERT_TRUE(there.radiance(flat, unturned));
        EXPECT_NEAR(turned[0], gathered[0], 0.02 * gathered[0]) << spec;
        EXPECT_GT(std::abs(unturned[0] - gathered[0]), 0.05 * gathered[0]) << spec;
    }
}

const Camera small{.name = "eye",
                   .position = {0.1, -0.9, 0.5},
                   .target = {0.2, 0.4, -1},
                   .fieldOfView = 70 * (pi / 180),
                   .width = 8,
                   .height = 8};

/// The mean of a picture against path tracing, with the glossy material sampled if `walks`.
void expectMeansOfPathTracing(int walks) {
    const auto scene = litRoom();
    const PathPicture paths = tracePaths(*scene, small, {.samples = 3000, .fewestBounces = 2});
    RadianceCache cache(
        *scene, {.rays = 1000, .fewestBounces = 2, .leastReach = 0.01, .surfacePoints = 2000});
    if (walks > 0) cache.sample(1, walks);
    const CachedPicture taken = takePicture(cache, small, {.samples = 400});
    double mean = 0, expected = 0, error = 0;
    for (std::size_t i = 0; i < paths.radiance.size(); ++i) {
        mean += static_cast<double>(taken.picture.radiance[i]);
        expected += static_cast<double>(paths.radiance[i]);
        error += static_cast<double>(paths.error[i]) * static_cast<double>(paths.error[i]);
    }
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(error) + 0.01 * expected) << walks;
}

TEST(RadianceCache, ComesToTheMeansOfPathTracing) {
    expectMeansOfPathTracing(0);
}
TEST(RadianceCache, ComesToTheMeansOfPathTracingWithAMaterialSampled) {
    expectMeansOfPathTracing(3);
}

/// Records cost the same for few pixels as for many.
TEST(CostPrediction, LeavesMaterialsInFewPixelsToSampling) {
    const auto scene = litRoom();
    const RadianceCache cache(*scene, {.rays = 1000, .surfacePoints = 200, .surfaceRays = 32});
    Camera large = small;
    large.width = large.height = 4000;
    const std::array<const Camera*, 1> few{&small}, many{&large};
    EXPECT_TRUE(predictCosts(cache, few, 4)[1].samplingIsCheaper());
    EXPECT_FALSE(predictCosts(cache, many, 4)[1].samplingIsCheaper());
    EXPECT_EQ(predictCosts(cache, many, 4)[0].pixels, 0);
}

/// The predicted number of records and error of sampling against what a picture has.
TEST(CostPrediction, IsThatOfThePicture) {
    const auto scene = litRoom();
    RadianceCache cache(*scene,
                        {.rays = 400, .fewestBounces = 2, .surfacePoints = 500, .surfaceRays = 64});
    const std::array<const Camera*, 1> cameras{&eye};
    const MaterialCost cost = predictCosts(cache, cameras, 16)[1];
    takePicture(cache, eye, {.samples = 1});
    double records = 0;
    for (const Record& record : cache.records()) records += record.kind > 0 ? 1 : 0;
    EXPECT_GT(cost.records, records / 3);
    EXPECT_LT(cost.records, records * 3);
    cache.sample(1, 1);
    const CachedPicture first = takePicture(cache, eye, {.samples = 4});
    double squares = 0, whole = 0, mean = 0, pixels = 0;
    const CameraRays rays(eye);
    std::vector<std::size_t> glossy;
    for (std::size_t pixel = 0; pixel < eye.pixels(); ++pixel) {
        const auto width = static_cast<std::size_t>(eye.width);
        const auto hit = scene->firstHit(rays.origin(),
                                         rays.direction(static_cast<double>(pixel % width) + 0.5,
                                                        static_cast<double>(pixel / width) + 0.5));
        if (hit && scene->objects()[hit->object].material == 1) glossy.push_back(pixel);
    }
    for (const std::size_t pixel : glossy) {
        for (std::size_t c = 0; c < 3; ++c) {
            const double value = first.picture.radiance[3 * pixel + c];
            const double error = first.picture.error[3 * pixel + c];
            squares += 4 * error * error;
            whole += value * value - error * error;
            mean += value / 3;
        }
        ++pixels;
    }
    whole += 3 * mean * mean / pixels / 100;
    EXPECT_NEAR(cost.pixels, pixels, 0.05 * pixels);
    EXPECT_GT(cost.variance, squares / whole / 2);
    EXPECT_LT(cost.variance, squares / whole * 2);
}

/// Records of a later camera shrink no reach that an earlier picture has used.
TEST(RadianceCache, NeedsNoRecordsForPicturesThatItHasTaken) {
    const auto scene = litRoom();
    Camera other = eye;
    other.position = {-0.6, -0.3, 0.7};
    const std::array<const Camera*, 2> cameras{&eye, &other};
    const CacheOptions options{.rays = 100, .surfacePoints = 200, .surfaceRays = 32};
    RadianceCache cache(*scene, options);
    std::size_t made = 0;
    for (const Camera* camera : cameras) made += takePicture(cache, *camera, {.samples = 1}).made;
    EXPECT_GT(made, 100U);
    RadianceCache again(*scene, options, cache.stored("here"));
    for (RadianceCache* one : {&cache, &again}) {
        for (const Camera* camera : cameras)
            EXPECT_EQ(takePicture(*one, *camera, {.samples = 1}).made, 0U);
    }
}

TEST(RadianceCache, DoesNotDependOnTheNumberOfThreads) {
    const auto scene = litRoom();
    std::vector<std::vector<float>> pictures;
    for (const std::size_t threads : {1U, 4U}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        RadianceCache cache(*scene, {.rays = 100, .surfacePoints = 200, .surfaceRays = 32});
        pictures.push_back(takePicture(cache, eye, {.samples = 2}).picture.radiance);
    }
    EXPECT_EQ(pictures[0], pictures[1]);
}

TEST(RadianceCache, KeepsToItsMemory) {
    const auto scene = litRoom();
    RadianceCache cache(*scene,
                        {.rays = 50, .surfacePoints = 100, .surfaceRays = 16, .mostBytes = 40000});
    const CachedPicture taken = takePicture(cache, eye, {.samples = 1});
    EXPECT_GT(taken.made, 5U);
    EXPECT_LE(cache.bytes(), 40000U);
    EXPECT_GT(taken.uncovered, 0U);
}

TEST(RadianceCache, RefusesSettingsOutsideOfTheirRange) {
    const auto scene = litRoom();
    const auto refuses = [&](CacheOptions options) {
        EXPECT_THROW(RadianceCache(*scene, options), UsageError);
    };
    refuses({.rays = 3});
    refuses({.accuracy = 0});
    refuses({.fewestBounces = 3});
    refuses({.fewestBounces = 2, .direct = DirectLight::gathered});
    refuses({.choice = {.basis = "lsosh"}});
    refuses({.choice = {.basis = "nothing"}});
}

}  // namespace
}  // namespace hshfit
