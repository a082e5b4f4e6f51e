#pragma once

#include <hshfit/time_limit.h>
#include <hshfit/transport/surface_scene.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace hshfit::inline transport {

/// Receives the finished and the total amount of the work, from any thread.
using TransportProgress = std::function<void(std::size_t done, std::size_t total)>;

struct PathOptions {
    int samples = 64;  ///< paths through a pixel, stratified over it as far as the number allows
    /// Reflections after which a path ends, which leaves light out; far more than matter below an
    /// albedo of 0.99.
    int mostBounces = 1000;
    /// Light that comes from an emitter or from far away on this many reflections is the first that
    /// counts: 0 all of it, 2 without what is seen directly and without direct light.
    int fewestBounces = 0;
    /// Reflections after which a path goes on with a probability, which is the largest component
    /// of its weight, at most 0.95.
    int sureBounces = 4;
    std::uint64_t seed = 1;
    TransportProgress progress = {};
};

/// A picture and the standard error of each of its numbers.
struct PathPicture {
    int width = 0, height = 0;
    std::vector<float> radiance = {};  ///< [row][column][R, G, B], row 0 at the top
    std::vector<float> error = {};     ///< likewise: the standard error of the mean over samples
    std::size_t rays = 0;              ///< traced
    std::size_t cut = 0;               ///< paths ended by mostBounces
};

/// One row of a picture, complete.
struct PathRow {
    std::vector<float> radiance = {}, error = {};  ///< [column][R, G, B]
    std::size_t rays = 0, cut = 0;
};

/// Rows of an earlier run with the same scene, camera and options, which are not traced again. Both
/// are called from any thread; either may be empty.
struct PathRows {
    std::function<std::optional<PathRow>(int row)> find = {};
    std::function<void(int row, const PathRow& done)> keep = {};  ///< of each row that is traced
};

/// Radiance towards a camera by path tracing (Kajiya 1986): at each meeting with a surface light is
/// sampled, and the path goes on by the material's sampler; the two are weighted by the power
/// heuristic (Veach 1997). Without bias but for mostBounces and f values that are not finite, which
/// count as 0. The picture does not depend on the number of threads.
PathPicture tracePaths(const SurfaceScene& scene, const Camera& camera,
                       const PathOptions& options = {}, const PathRows& rows = {});

/// As many paths through a pixel as fit into the time that is left, from 2 to `options.samples`, by
/// the time that two of them take in every eighth row. All of them where there is no limit.
int samplesWithin(const SurfaceScene& scene, const Camera& camera, const PathOptions& options,
                  const TimeLimit& limit);

/// Radiance along one ray: the mean of `samples` paths.
struct PathEstimate {
    Rgb radiance{}, error{};
};
PathEstimate tracePaths(const SurfaceScene& scene, const Point& origin, const Direction& direction,
                        const PathOptions& options = {});

}  // namespace hshfit::inline transport
