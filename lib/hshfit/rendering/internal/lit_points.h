#pragma once

#include <hshfit/rendering/lit_picture.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <functional>

namespace hshfit::inline rendering {

/// Radiance below this share of the mean has the errors of that share.
inline constexpr double darkest = 0.05;
/// Share of the tolerance that interpolation in the middle of a cell may take.
inline constexpr double interpolationShare = 0.125;

/// A point of a surface in the frame of its lit side.
struct LitPoint {
    Frame frame;
    Direction wo;
};

/// The side that is seen, for a reflection. A transmission is a thin pane: light comes from behind
/// it, and the viewer's direction, below the lit side, is mirrored at the surface.
LitPoint litPoint(const Direction& normal, const Direction& viewer, bool through);

/// Steps done, from any thread.
class Steps {
public:
    Steps(const RenderProgress& progress, std::size_t total) : progress_(progress), total_(total) {}
    void done() {
        const std::size_t now = ++done_;
        if (progress_) progress_(now, total_);
    }
    /// Further steps that are to be done.
    void more(std::size_t steps) { total_ += steps; }

private:
    const RenderProgress& progress_;
    std::atomic<std::size_t> total_;
    std::atomic<std::size_t> done_ = 0;
};

/// Blocks of the points, a step each.
std::size_t blocksOf(const SurfacePoints& points);
/// Calls `work(first, last)` for the blocks, on all threads.
void forBlocks(const SurfacePoints& points, Steps& steps,
               const std::function<void(std::size_t, std::size_t)>& work);

inline double absoluteSum(const Rgb& value) {
    return std::abs(value[0]) + std::abs(value[1]) + std::abs(value[2]);
}

}  // namespace hshfit::inline rendering
