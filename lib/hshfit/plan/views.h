#pragma once

#include <hshfit/plan/scene.h>

#include <span>
#include <vector>

namespace hshfit::plan {

/// Directions to the viewer at which a choice is checked, ring by ring, in the surface's frame.
struct Views {
    std::vector<Direction> directions;
    std::vector<double> weights;     ///< solid angle each stands for, or 1 for a single elevation
    std::vector<std::size_t> rings;  ///< the elevation of each, an index of `thetas`
    std::vector<double> thetas;      ///< radians

    std::size_t size() const { return directions.size(); }
};

/// Midpoints of elevations about `degrees` apart and of azimuths four times as far, each ring
/// turned against the one before so that no azimuth is favoured; `shift` in [0, 1) turns all of
/// them.
Views viewsOf(const ViewRange& range, double degrees, double shift);
/// Those at `indices`.
Views subset(const Views& views, std::span<const std::size_t> indices);

/// Outgoing radiance, [view][R, G, B], for one orientation.
using Radiance = std::vector<Rgb>;

/// The budget's measure of `approximation` against `truth`, one Radiance for each orientation.
/// Values that are not finite make it infinite.
double errorOf(const Budget& budget, const Views& views, std::span<const Radiance> truth,
               std::span<const Radiance> approximation);

/// The same for each elevation by itself, in the order of `views.thetas`. For the metric log, e is
/// that of all elevations.
std::vector<double> errorsByElevation(const Budget& budget, const Views& views,
                                      std::span<const Radiance> truth,
                                      std::span<const Radiance> approximation);

}  // namespace hshfit::plan
