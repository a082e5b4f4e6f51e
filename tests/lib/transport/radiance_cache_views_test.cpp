#include <hshfit/transport/radiance_cache/cached_picture.h>

#include <lib/transport/cache_views.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit {
namespace {

/// At length: docs/figures/cache_views.cpp.
TEST(RadianceCacheViews, HaveTheMeansOfPathTracing) {
    for (const test::CacheView& view : test::cacheViews(24)) {
        const PathPicture paths =
            tracePaths(*view.scene, view.camera, {.samples = 150, .fewestBounces = 2});
        RadianceCache cache(
            *view.scene,
            {.rays = 500, .fewestBounces = 2, .surfacePoints = 2000, .surfaceRays = 128});
        const CachedPicture taken = takePicture(cache, view.camera, {.samples = 16});
        double mean = 0, expected = 0, error = 0;
        for (std::size_t i = 0; i < paths.radiance.size(); ++i) {
            mean += static_cast<double>(taken.picture.radiance[i]);
            expected += static_cast<double>(paths.radiance[i]);
            error += static_cast<double>(paths.error[i]) * static_cast<double>(paths.error[i]);
        }
        EXPECT_NEAR(mean, expected, 0.02 * expected) << view.name;
        EXPECT_LT(std::ranges::max(taken.picture.radiance), 1.5F * std::ranges::max(paths.radiance))
            << view.name;
        EXPECT_LT(3 * std::sqrt(error), 0.02 * expected) << view.name;
    }
}

/// Pixels whose centres lie on edges of a room get records beside these, of which the rays start on
/// one surface alone.
TEST(RadianceCacheViews, HaveNoRecordsOnEdges) {
    const SurfaceScene room({test::materialOf("lambert:kd=.7")}, test::lamp(test::room({}, true)),
                            {});
    RadianceCache cache(room, {.rays = 100, .surfacePoints = 200, .surfaceRays = 32});
    EXPECT_EQ(takePicture(cache, test::onEdges(32), {.samples = 1}).uncovered, 0U);
    for (const Record& record : cache.records()) {
        std::array<double, 3> fromMiddle{};
        for (std::size_t k = 0; k < 3; ++k) fromMiddle[k] = std::abs(record.position[k]);
        std::ranges::sort(fromMiddle);
        EXPECT_LT(fromMiddle[1], 0.999);
        EXPECT_GT(record.distance, 0.01);
    }
}

/// Light is in proportion to the lamp, also where derivatives leave single precision.
TEST(RadianceCacheViews, AreRightWhereRecordsCannotBeKept) {
    std::array<double, 2> means{};
    for (const std::size_t k : {0U, 1U}) {
        std::vector<SurfaceObject> objects = test::lamp(test::room({}, true));
        const double scale = k == 0 ? 1 : 1e36;
        for (double& value : objects.back().emission) value *= scale;
        const SurfaceScene room({test::materialOf("lambert:kd=.7")}, std::move(objects), {});
        RadianceCache cache(room, {.rays = 100, .fewestBounces = 2, .surfacePoints = 500});
        const CachedPicture taken = takePicture(cache, test::onEdges(16), {.samples = 32});
        for (const float value : taken.picture.radiance)
            means[k] += static_cast<double>(value) / scale;
    }
    EXPECT_NEAR(means[1], means[0], 0.03 * means[0]);
}

/// Walks that go on from the wall beside a record are noisy; its gradient is not.
TEST(RadianceCacheViews, HaveSteadyGradientsBesideEdges) {
    const SurfaceScene room({test::materialOf("lambert:kd=.7")}, test::lamp(test::room({}, true)),
                            {});
    const auto hit = room.firstHit({0.985, 0.2, 0.5}, {0, 0, -1});
    constexpr int seeds = 32;
    double light = 0, slope = 0, squares = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        RadianceCache cache(room, {.rays = 500,
                                   .surfacePoints = 200,
                                   .surfaceRays = 64,
                                   .seed = static_cast<std::uint64_t>(seed)});
        cache.make({*hit}, {1});
        ASSERT_EQ(cache.records().size(), 1U);
        const Record& record = cache.records()[0];
        const double along = static_cast<double>(record.part(1, 1)[0]) * record.frame.tangent.x +
                             static_cast<double>(record.part(2, 1)[0]) * record.frame.bitangent.x;
        light += static_cast<double>(record.part(0, 1)[0]) / seeds;
        slope += along / seeds;
        squares += along * along / seeds;
    }
    const double reach = 0.02, spread = std::sqrt(squares - slope * slope);
    EXPECT_LT(spread * reach, 0.004 * light);
}

/// Between endless plates of emission E and albedo rho, light of two and more reflections is
/// E rho^2 / (1 - rho). Points on these lie many times their distance apart.
TEST(RadianceCacheViews, DoNotNeedPointsAsCloseAsSurfaces) {
    for (const std::uint64_t seed : {1U, 2U}) {
        std::vector<SurfaceObject> objects = test::plates();
        const SurfaceScene scene({test::materialOf("lambert:kd=.7")}, std::move(objects), {});
        RadianceCache cache(scene, {.fewestBounces = 2, .seed = seed});
        const Camera between = test::lookingFrom({0, 0, 0.5}, {0.36, 0.48, 0}, 0.5, 24);
        const CachedPicture taken = takePicture(cache, between, {.samples = 4});
        double mean = 0;
        for (const float value : taken.picture.radiance)
            mean += static_cast<double>(value) / static_cast<double>(taken.picture.radiance.size());
        const double expected = 0.2 * 0.49 / 0.3;
        EXPECT_NEAR(mean, expected, 0.02 * expected);
    }
}

}  // namespace
}  // namespace hshfit
