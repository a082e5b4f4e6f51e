#include <hshfit/lighting/lit_surface.h>

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

namespace hshfit::lighting {

ShadedPicture render(const Shading& shading, const SurfacePoints& points, const View& view) {
    Radiance radiance(points.count());
    tbb::parallel_for(std::size_t{0}, points.count(), [&](std::size_t k) {
        radiance[k] = shading(points.normals[k], points.viewer(k, view));
    });
    // Some points again, alone: the time of a thread among others is no time.
    constexpr std::size_t timed = 2000;
    const std::size_t step = std::max<std::size_t>(1, points.count() / timed);
    std::size_t count = 0;
    double sum = 0;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < points.count(); k += step, ++count)
        sum += shading(points.normals[k], points.viewer(k, view))[0];
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
    ShadedPicture result{.picture = pictureOf(points, radiance)};
    // The sum is used, so that the loop is not left out.
    result.nanoseconds =
        time.count() / static_cast<double>(std::max<std::size_t>(1, count)) + 0 * sum;
    return result;
}

}  // namespace hshfit::lighting
