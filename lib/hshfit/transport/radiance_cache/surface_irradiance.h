#pragma once

#include <hshfit/transport/path_tracer.h>
#include <hshfit/transport/radiance_cache/light_walk.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace hshfit::inline transport::inline radiance_cache {

struct SurfaceIrradianceOptions {
    std::size_t points = 4096;  ///< over all diffuse surfaces, half of them by area
    int rays = 256;             ///< of each
    int bounces = 1000;         ///< times that light is passed on between the points, at most
    std::uint64_t seed = 1;
    TransportProgress progress = {};
};

/// A point of a diffuse surface and the light on it.
struct IrradiancePoint {
    std::array<float, 3> position, normal;
    std::array<float, 3> irradiance;
    std::uint32_t side = 0;  ///< of the scene: twice the object, and 1 more for its back
};

/// Irradiance on the diffuse surfaces of a scene, both sides, from all further bounces: the light
/// that the rays of records meet. Points spread over the surfaces trace their rays once, each up to
/// a diffuse surface, whose nearest point takes its part: E = b + M E, solved by repetition, of
/// which each passes on the light of one more bounce. With sampled light E is without direct
/// light, with gathered light it is all. A ray shorter than twice the distance of the points that
/// it meets sees more than they tell apart, and its walk goes on, unless bounces are limited.
/// Immutable; safe to use from many threads; independent of the number of threads and of cameras.
class SurfaceIrradiance {
public:
    SurfaceIrradiance(const LightWalk& walk, const SurfaceIrradianceOptions& options);
    SurfaceIrradiance(std::vector<IrradiancePoint> points, double spacing, int bounces);
    ~SurfaceIrradiance();
    SurfaceIrradiance(SurfaceIrradiance&&) noexcept;

    /// Between the nearest points of the side that was met; none where the ray is too short for
    /// them unless the walk's last, 0 without points.
    std::optional<Rgb> at(const SurfaceHit& hit, bool last) const;

    const std::vector<IrradiancePoint>& points() const { return points_; }
    /// The distance of neighbours on average.
    double spacing() const { return spacing_; }
    std::size_t rays() const { return rays_; }
    std::size_t bytes() const;

private:
    struct Tree;
    void plant();
    const Tree* treeAt(const SurfaceHit& hit) const;
    bool isClose(const SurfaceHit& hit, std::uint32_t nearest) const;
    void solve(const LightWalk& walk, const SurfaceIrradianceOptions& options,
               const std::vector<SurfaceHit>& hits);

    std::vector<IrradiancePoint> points_;
    double spacing_ = 0;
    std::size_t rays_ = 0;
    int bounces_ = 0;
    std::vector<std::unique_ptr<Tree>> trees_;  ///< of each side; null without points
    std::vector<float> reach_;                  ///< of each point: the distance of its neighbours
};

}  // namespace hshfit::inline transport::inline radiance_cache
