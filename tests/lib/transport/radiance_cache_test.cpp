#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>
#include <hshfit/light/catalog.h>
#include <hshfit/projection/albedo.h>
#include <hshfit/rendering/view.h>
#include <hshfit/sampling/make_sampler.h>
#include <hshfit/transport/radiance_cache/cached_picture.h>

#include <brdfs/catalog.h>
#include <lib/transport/law_scenes.h>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

namespace hshfit {
namespace {

using test::materialOf;

/// A parallelogram, its front along a x b.
Mesh patch(const Direction& corner, const Direction& a, const Direction& b) {
    Mesh mesh;
    for (const Direction& p : {corner, corner + a, corner + a + b, corner + b}) {
        mesh.positions.push_back(
            {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    completeNormals(mesh);
    return mesh;
}

/// The inside of a cube from -1 to 1, without its ceiling unless `closed`.
std::vector<SurfaceObject> room(const Rgb& emission, bool closed, std::size_t floor = 0) {
    std::vector<SurfaceObject> objects{
        {"floor", patch({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}), floor, emission},
        {"left", patch({-1, -1, -1}, {0, 2, 0}, {0, 0, 2}), 0, emission},
        {"right", patch({1, -1, -1}, {0, 0, 2}, {0, 2, 0}), 0, emission},
        {"near", patch({-1, -1, -1}, {0, 0, 2}, {2, 0, 0}), 0, emission},
        {"far", patch({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}), 0, emission}};
    if (closed)
        objects.push_back({"ceiling", patch({-1, -1, 1}, {0, 2, 0}, {2, 0, 0}), 0, emission});
    return objects;
}

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

/// Of all reflections in a sphere, those after the first: rho^2 / (1 - rho) times the share of the
/// lamp, wherever one looks.
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

/// A scene in which coefficients change along the floor: a square lamp above it and, if asked, a
/// black board between them.
std::unique_ptr<SurfaceScene> lampAbove(bool board) {
    std::vector<SurfaceObject> objects;
    objects.push_back({"floor", patch({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}), 0, {}});
    objects.push_back({"lamp", patch({-0.5, -0.4, 1.5}, {0, 1, 0}, {1, 0, 0}), 0, {1, 1, 1}});
    if (board) objects.push_back({"board", patch({-1, -1, 0.7}, {1.1, 0, 0}, {0, 3, 0}), 0, {}});
    return std::make_unique<SurfaceScene>(std::vector{materialOf("lambert:kd=0")},
                                          std::move(objects), std::vector<Light>{});
}

/// The record at (x, y) of the floor.
Record recordAt(const SurfaceScene& scene, double x, double y, const IncomingFunctions& functions,
                int rays, Gradient gradient) {
    const LightWalk walk(scene, DirectLight::gathered);
    const SurfaceIrradiance none({}, 0);
    const HemisphereStrata strata(functions, rays);
    std::size_t traced = 0;
    const auto hit = scene.firstHit({x, y, 0.1}, {0, 0, -1});
    return gather(*hit, 0, functions, strata, gradient, {&walk, &none}, RandomNumbers(7, 0),
                  traced);
}

/// The distance of a record's gradient from central differences of coefficients by many rays,
/// relative to the latter.
double gradientError(bool board, const IncomingFunctions& functions, Gradient gradient, int rays) {
    const auto scene = lampAbove(board);
    const double x = 0.35, y = -0.2, h = 0.02;
    const std::size_t size = functions.size();
    const Record found = recordAt(*scene, x, y, functions, rays, gradient);
    double error = 0, norm = 0;
    for (const std::size_t axis : {0U, 1U}) {
        const Direction along = axis == 0 ? found.frame.tangent : found.frame.bitangent;
        const auto beside = [&](double step) {
            return recordAt(*scene, x + step * along.x, y + step * along.y, functions, 400000,
                            Gradient::none);
        };
        const Record more = beside(h), less = beside(-h);
        for (std::size_t i = 0; i < size; ++i) {
            const double expected =
                static_cast<double>(more.part(0, size)[i] - less.part(0, size)[i]) / (2 * h);
            const double off = static_cast<double>(found.part(1 + axis, size)[i]) - expected;
            error += off * off;
            norm += expected * expected;
        }
    }
    return std::sqrt(error / norm);
}

TEST(RecordGradient, MatchesDifferencesOfConvergedCoefficients) {
    const IncomingFunctions hsh(bases::make("hsh", 5));
    for (const Gradient gradient : {Gradient::strata, Gradient::hitPoints}) {
        EXPECT_LT(gradientError(false, hsh, gradient, 4000), 0.1);
        EXPECT_LT(gradientError(false, hsh, gradient, 100000), 0.05);
    }
}

/// Irradiance at (x, y, 0) by a polygon of radiance 1: half the sum over edges of the angle times
/// the normal of the edge's plane (Lambert 1760).
double irradianceOfLamp(double x, double y) {
    const std::array<Direction, 4> corners{{{-0.5 - x, -0.4 - y, 1.5},
                                            {0.5 - x, -0.4 - y, 1.5},
                                            {0.5 - x, 0.6 - y, 1.5},
                                            {-0.5 - x, 0.6 - y, 1.5}}};
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Direction a = normalised(corners[k]), b = normalised(corners[(k + 1) % 4]);
        sum += std::acos(dot(a, b)) * normalised(cross(a, b)).z / 2;
    }
    return std::abs(sum);
}

TEST(RecordGradient, IsThatOfTheIrradianceOfAPolygon) {
    const auto scene = lampAbove(false);
    const double x = 0.35, y = -0.2, h = 1e-4;
    const double alongX = (irradianceOfLamp(x + h, y) - irradianceOfLamp(x - h, y)) / (2 * h);
    const double alongY = (irradianceOfLamp(x, y + h) - irradianceOfLamp(x, y - h)) / (2 * h);
    for (const Gradient gradient : {Gradient::strata, Gradient::hitPoints}) {
        const Record found = recordAt(*scene, x, y, {}, 100000, gradient);
        EXPECT_NEAR(found.part(0, 1)[0], irradianceOfLamp(x, y), 1e-3);
        const Direction& t = found.frame.tangent;
        const Direction& b = found.frame.bitangent;
        const double most = 0.03 * std::hypot(alongX, alongY);
        EXPECT_NEAR(found.part(1, 1)[0], t.x * alongX + t.y * alongY, most);
        EXPECT_NEAR(found.part(2, 1)[0], b.x * alongX + b.y * alongY, most);
    }
}

/// Points that stay where rays met them do not know what moves in front of them.
TEST(RecordGradient, SeesWhatComesIntoSightByStrataAlone) {
    const IncomingFunctions hsh(bases::make("hsh", 5));
    EXPECT_LT(gradientError(true, hsh, Gradient::strata, 100000), 0.05);
    EXPECT_GT(gradientError(true, hsh, Gradient::hitPoints, 100000), 0.3);
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

/// A room with a lamp, a glossy floor and a curved glossy thing.
std::unique_ptr<SurfaceScene> litRoom() {
    std::vector<SurfaceObject> objects = room({}, true, 1);
    objects.push_back({"lamp", patch({-0.3, -0.3, 0.95}, {0, 0.6, 0}, {0.6, 0, 0}), 0, {9, 8, 7}});
    Mesh ball = sphereMesh(3);
    for (MeshVector& p : ball.positions) p = {0.3F * p[0], 0.3F * p[1] + 0.3F, 0.3F * p[2] - 0.7F};
    objects.push_back({"ball", std::move(ball), 1, {}});
    return std::make_unique<SurfaceScene>(
        std::vector{materialOf("lambert:kd=.7/.5/.3"),
                    materialOf("phong:kd=.2,ks=.6,exponent=10,normalized=true")},
        std::move(objects), std::vector<Light>{});
}

TEST(RadianceCache, ComesToTheMeansOfPathTracing) {
    const auto scene = litRoom();
    const Camera small{.name = "eye",
                       .position = {0.1, -0.9, 0.5},
                       .target = {0.2, 0.4, -1},
                       .fieldOfView = 70 * (pi / 180),
                       .width = 8,
                       .height = 8};
    const PathPicture paths = tracePaths(*scene, small, {.samples = 3000, .fewestBounces = 2});
    RadianceCache cache(
        *scene, {.rays = 1000, .fewestBounces = 2, .leastReach = 0.01, .surfacePoints = 2000});
    const CachedPicture taken = takePicture(cache, small, {.samples = 400});
    double mean = 0, expected = 0, error = 0;
    for (std::size_t i = 0; i < paths.radiance.size(); ++i) {
        mean += static_cast<double>(taken.picture.radiance[i]);
        expected += static_cast<double>(paths.radiance[i]);
        error += static_cast<double>(paths.error[i]) * static_cast<double>(paths.error[i]);
    }
    EXPECT_NEAR(mean, expected, 4 * std::sqrt(error) + 0.01 * expected);
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
