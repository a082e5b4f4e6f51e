#include <hshfit/transport/camera.h>

#include <hshfit/brdf/vectors.h>
#include <hshfit/error.h>

#include <fmt/format.h>

#include <cmath>

namespace hshfit::inline transport {

CameraRays::CameraRays(const Camera& camera)
    : origin_(camera.position),
      width_(camera.width),
      height_(camera.height),
      slope_(std::tan(camera.fieldOfView / 2)) {
    if (!(camera.fieldOfView > 0 && camera.fieldOfView < pi)) {
        throw UsageError(
            fmt::format("camera '{}': the field of view is {:g} degrees; it has to be "
                        "above 0 and below 180",
                        camera.name, degrees(camera.fieldOfView)));
    }
    const Direction gap{camera.target[0] - camera.position[0],
                        camera.target[1] - camera.position[1],
                        camera.target[2] - camera.position[2]};
    ahead_ = normalised(gap);
    const Direction across = cross(ahead_, normalised(camera.up));
    const double sine = std::sqrt(dot(across, across));
    if (!(sine > 1e-6)) {
        throw UsageError(fmt::format(
            "camera '{}': it stands on its target, or looks along 'up': give another 'up'",
            camera.name));
    }
    right_ = normalised(across);
    down_ = cross(ahead_, right_);
}

Direction CameraRays::direction(double column, double row) const {
    const double x = slope_ * (2 * column - width_) / height_;
    const double y = slope_ * (2 * row - height_) / height_;
    return normalised({ahead_.x + x * right_.x + y * down_.x, ahead_.y + x * right_.y + y * down_.y,
                       ahead_.z + x * right_.z + y * down_.z});
}

}  // namespace hshfit::inline transport
