#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/light/lights.h>
#include <hshfit/rendering/direct_integral.h>
#include <hshfit/rendering/view.h>
#include <hshfit/time_limit.h>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace hshfit::inline rendering {

/// Receives the finished and the total amount of the work, from any thread.
using RenderProgress = std::function<void(std::size_t done, std::size_t total)>;

/// A picture and the accuracy of its radiance.
struct LitPicture {
    SpherePicture picture;
    /// Estimated relative error, the root of the mean square over the points. By integration an
    /// upper estimate of the quadrature; by coefficients the change from one level of light samples
    /// to the next, for the given coefficients, and the error of a table of normals.
    double error = 0;
    /// By integration, the largest estimated error of a pixel, over its radiance or, if that is
    /// more, a twentieth of the picture's mean; `picture.error` has the error of every pixel.
    struct Largest {
        double error = 0;
        std::size_t column = 0, row = 0;
    };
    Largest largest = {};
    std::size_t cut = 0;     ///< points at which integration was ended by its bound of evaluations
    std::size_t early = 0;   ///< points that the end of the time left above the tolerance
    double evaluations = 0;  ///< of f by integration, the mean over points
};

/// Radiance of a surface by direct integration (direct_integral.h) at every point; many points that
/// see the viewer in one direction share integrals by their normals, within an eighth of the
/// tolerance (internal/point_integrals.h). `brdf` is grey or RGB; a transmission is seen as a thin
/// pane with the lights behind it. The picture does not depend on the number of threads.
///
/// With an end of the time, `until`: a point of each pixel to an error of 50 % first, however long
/// that takes; then every point, and then every point to the tolerance, until the time is over.
/// Points that were not reached have the mean of their pixel.
LitPicture renderByIntegration(const Brdf& brdf, const SurfacePoints& points, const View& view,
                               const DirectIntegral& light, const IntegrationOptions& options = {},
                               const RenderProgress& progress = {}, const TimeLimit& until = {});

struct CoefficientShading {
    /// The change of radiance, relative L2 over some points, at which no finer light samples are
    /// taken.
    double tolerance = 1e-3;
    RenderProgress progress = {};
};

/// Radiance from coefficients over wi, for each of `materials`:
///     L(wo) = sum over l, m of c_{l,m}(wo) E_{l,m},   E = integral of L_i B_{l,m} w d omega_i
/// over the hemisphere about each point's normal, with w = cos(theta_i) for coefficients of f and 1
/// for coefficients of f cos(theta_i). E is made of samples of the lights above each normal, not of
/// rotated coefficients; where there are many points, E of pictures is interpolated between normals
/// a few degrees apart, but for cells where that changes radiance by more than a quarter of the
/// tolerance. c is interpolated in the materials' outgoing sets. All materials share
/// basis, order, sign and quantity, are grey or RGB, and are all reflections or all transmissions.
/// Values below 0 are kept. The pictures do not depend on the number of threads.
std::vector<LitPicture> renderByCoefficients(std::span<const Coefficients* const> materials,
                                             const SurfacePoints& points, const View& view,
                                             std::span<const Light> lights,
                                             const CoefficientShading& options = {});

/// The distance of an approximation from a reference picture of the same surface.
struct PictureDifference {
    double relativeL2 = 0;  ///< root mean square of the difference over the reference's
    double maximum = 0;     ///< the largest difference of a pixel and colour / meanRadiance
    std::size_t column = 0, row = 0;  ///< of the maximum
    double meanRadiance = 0;          ///< of the reference, over the surface and R, G, B
};
PictureDifference differenceOf(const SpherePicture& reference, const SpherePicture& approximation);

}  // namespace hshfit::inline rendering
