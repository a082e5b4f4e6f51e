#pragma once

#include <hshfit/light/lights.h>

namespace hshfit::inline light {

/// The plane of a panel: the point (x, y) in units of half of its width and height, so that the
/// panel is [-1, 1]^2, at (x tan(width / 2), y tan(height / 2)) of the plane at distance 1, turned
/// about its centre.
class PanelPlane {
public:
    explicit PanelPlane(const PanelLight& light);

    struct Point {
        Direction direction;    ///< in the world
        double solidAngle = 0;  ///< per area of [-1, 1]^2
    };
    Point at(double x, double y) const;

private:
    Direction pole_, across_, down_;  ///< across and down of half the size
    double area_ = 0;                 ///< of a quarter of the panel
};

}  // namespace hshfit::inline light
