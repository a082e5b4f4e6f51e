#include <hshfit/rendering/internal/lit_points.h>

#include <hshfit/brdf/transmission.h>
#include <hshfit/brdf/vectors.h>

#include <tbb/parallel_for.h>

#include <algorithm>

namespace hshfit::inline rendering {
namespace {

/// Points of a task.
constexpr std::size_t blockSize = 64;

}  // namespace

LitPoint litPoint(const Direction& normal, const Direction& viewer, bool through) {
    if (!through) {
        const Frame frame = frameAt(normal);
        return {frame, frame.toLocal(viewer)};
    }
    const Frame frame = frameAt({-normal.x, -normal.y, -normal.z});
    return {frame, throughSurface(frame.toLocal(viewer))};
}

std::size_t blocksOf(const SurfacePoints& points) {
    return (points.count() + blockSize - 1) / blockSize;
}

void forBlocks(const SurfacePoints& points, Steps& steps,
               const std::function<void(std::size_t, std::size_t)>& work) {
    tbb::parallel_for(std::size_t{0}, blocksOf(points), [&](std::size_t block) {
        work(block * blockSize, std::min(points.count(), (block + 1) * blockSize));
        steps.done();
    });
}

}  // namespace hshfit::inline rendering
