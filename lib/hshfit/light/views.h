#pragma once

#include <hshfit/light/lights.h>

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// Orientation of a surface in the world, where +z is up: its normal, and the turn of its tangent
/// about it. Without a turn the tangent is +x, carried along as +z goes to the normal on a great
/// circle.
struct Orientation {
    double theta = 0, phi = 0, turn = 0;  ///< radians
};

/// Directions to the viewer that occur, about the normal and from the tangent, radians.
struct ViewRange {
    double thetaMin = 0, thetaMax = 85 * (pi / 180);
    double phiMin = 0, phiMax = 2 * pi;
    /// Surfaces are turned about their normals in any way: every orientation is tried in 8 turns.
    bool anyTangent = false;
};

/// The allowed error of outgoing radiance, over views (by solid angle), orientations and channels.
///     relativeL2  root of the sum of (L' - L)^2 over the sum of L^2
///     log         mean |ln(max(L', 0) + e) - ln(L + e)|, e = 1/100 of the mean of L
struct Budget {
    enum class Metric { relativeL2, log };
    Metric metric = Metric::relativeL2;
    double error = 0.05;
    /// The mean FLIP of spheres in any light (PictureError) at most; none: pictures do not count.
    std::optional<double> flip = {};
};
std::string_view metricName(Budget::Metric metric);  ///< "relative_l2", "log"

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
/// The views at `indices`.
Views subset(const Views& views, std::span<const std::size_t> indices);

/// Outgoing radiance, [view][R, G, B], for one orientation.
using Radiance = std::vector<Rgb>;

/// The budget's measure of `approximation` against `truth`, one Radiance for each orientation.
/// Values that are not finite make it infinite.
double errorOf(const Budget& budget, const Views& views, std::span<const Radiance> truth,
               std::span<const Radiance> approximation);

/// The same for each elevation by itself, in the order of `views.thetas`. For the metric log, e is
/// the same for all elevations, from the mean over all of them.
std::vector<double> errorsByElevation(const Budget& budget, const Views& views,
                                      std::span<const Radiance> truth,
                                      std::span<const Radiance> approximation);

}  // namespace hshfit::inline light
