#pragma once

#include <hshfit/rendering/direct_integral.h>
#include <hshfit/rendering/internal/even_light.h>
#include <hshfit/rendering/internal/lit_points.h>
#include <hshfit/rendering/internal/normal_table.h>
#include <hshfit/rendering/view.h>
#include <hshfit/time_limit.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace hshfit::inline rendering {

/// Direct integrals at the points of a picture, and the tolerance that each has kept to.
///
/// Where lines of sight are parallel, radiance depends on the normal alone. Points share integrals
/// at the vertices of a grid of normals then, with cubic interpolation in between: grids of half
/// the step follow each other for the points of cells in whose middle, or in a middle beside it,
/// interpolation is off by more than an eighth of the tolerance. The last points, for which the
/// next grid would take more than a quarter of their own integrals, are integrated by themselves.
/// The part from even light, which depends on the viewer in the frame of the surface alone, is
/// interpolated before all that (even_light.h).
class PointIntegrals {
public:
    PointIntegrals(const Brdf& brdf, const SurfacePoints& points, const View& view,
                   const DirectIntegral& light, const IntegrationOptions& options);

    const std::vector<PointRadiance>& facts() const { return facts_; }
    std::size_t early() const;
    /// Evaluations of f, of vertices too.
    std::size_t evaluations() const { return evaluations_; }

    void run(const RenderProgress& progress);
    void runUntil(const TimeLimit& limit, const RenderProgress& progress);

private:
    using GoesOn = std::function<bool()>;

    void takeEvenLight(const GoesOn& goesOn);
    void pass(double tolerance, Steps& steps, const std::function<bool(std::size_t)>& wanted);
    PointRadiance integral(const Direction& normal, const Direction& viewer,
                           double tolerance) const;
    void integrate(std::size_t k, double tolerance);
    void keep(std::size_t k, double tolerance);
    void fillPixels();

    std::size_t coarsestGrid() const;
    void interpolate(double tolerance, Steps& steps, const GoesOn& goesOn);
    void fill(NormalTable& table, double tolerance, Steps& steps, const GoesOn& goesOn);
    std::vector<double> gapsOf(const NormalTable& table, const std::vector<std::size_t>& open,
                               double tolerance, Steps& steps, const GoesOn& goesOn);

    const Brdf& brdf_;
    const SurfacePoints& points_;
    const View& view_;
    const DirectIntegral& light_;
    const IntegrationOptions& options_;
    const bool through_;
    std::optional<EvenLight> even_;
    std::vector<PointRadiance> facts_;
    std::vector<double> kept_;  ///< the tolerance by point
    std::atomic<std::size_t> evaluations_ = 0;
};

}  // namespace hshfit::inline rendering
