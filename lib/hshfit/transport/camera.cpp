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

std::optional<std::array<double, 2>> CameraRays::pixelOf(const Point& point) const {
    const Direction gap{point[0] - origin_[0], point[1] - origin_[1], point[2] - origin_[2]};
    const double depth = dot(gap, ahead_);
    if (!(depth > 0)) return {};
    const double scale = height_ / (slope_ * depth);
    const double column = (dot(gap, right_) * scale + width_) / 2;
    const double row = (dot(gap, down_) * scale + height_) / 2;
    if (!(column >= 0 && column < width_ && row >= 0 && row < height_)) return {};
    return std::array<double, 2>{column, row};
}

}  // namespace hshfit::inline transport
