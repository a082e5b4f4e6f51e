#pragma once

#include <hshfit/light/lights.h>

namespace hshfit::inline light {

/// The light turned by `angle` radians about +z, from +x towards +y.
Light turned(Light light, double angle);

/// The light with its radiance multiplied by `factor`, at least 0.
Light scaled(Light light, double factor);

/// The light rotated in the world.
PictureLight rotated(PictureLight light, const Rotation& rotation);
CoefficientLight rotated(CoefficientLight light, const Rotation& rotation);

/// The light mirrored at the plane y = 0 of the world: left and right are exchanged for somebody
/// who looks along +x.
PictureLight mirrorImage(PictureLight light);
CoefficientLight mirrorImage(CoefficientLight light);

}  // namespace hshfit::inline light
