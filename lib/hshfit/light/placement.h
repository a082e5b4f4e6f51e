#pragma once

#include <hshfit/light/lights.h>

namespace hshfit::inline light {

/// The light turned by `angle` radians about +z, from +x towards +y.
Light turned(Light light, double angle);

/// The light with its radiance multiplied by `factor`, at least 0.
Light scaled(Light light, double factor);

}  // namespace hshfit::inline light
