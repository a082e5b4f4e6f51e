#pragma once

#include <hshfit/brdf/directions.h>
#include <hshfit/rays/ray_scene.h>

#include <array>
#include <optional>
#include <string>

namespace hshfit::inline transport {

/// A place in the world.
using Point = std::array<double, 3>;

/// A pinhole camera in the world, where +z is up.
struct Camera {
    std::string name;
    Point position{}, target{0, 0, 0};
    Direction up{0, 0, 1};
    double fieldOfView = 40 * (pi / 180);  ///< from the upper to the lower edge, radians
    int width = 512, height = 512;         ///< pixels

    std::size_t pixels() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
};

/// Lines of sight of a camera.
class CameraRays {
public:
    /// Throws UsageError where the camera stands on its target or looks along `up`, and for angles
    /// outside of (0, 180) degrees.
    explicit CameraRays(const Camera& camera);

    const Point& origin() const { return origin_; }
    /// Through (column, row) in pixels, fractions allowed, (0, 0) being the upper left corner.
    Direction direction(double column, double row) const;
    /// The column and row of a point, fractions included; none for one behind the camera or beside
    /// the picture.
    std::optional<std::array<double, 2>> pixelOf(const Point& point) const;

private:
    Point origin_;
    Direction right_, down_, ahead_;  ///< to the edges of pixels at distance 1
    double width_, height_, slope_;
};

}  // namespace hshfit::inline transport
