#pragma once

#include <hshfit/light/lights.h>
#include <hshfit/light/picture_light.h>
#include <hshfit/specification/parameters.h>

#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// Keys of a picture: the facts that a file may not tell.
std::vector<Parameter> pictureParameters();
PictureOptions pictureOptions(const Parameters& parameters);
/// The treatment of invalid pixels that the keys ask for; `otherwise` where it is not refusal.
InvalidPixels invalidPixels(const Parameters& parameters, InvalidPixels otherwise);

/// Keys of lights that may be mirrored and tilted: pictures and coefficients.
std::vector<Parameter> tiltParameters();
/// The light mirrored at first, then tilted. `owner` starts messages.
PictureLight tilted(std::string_view owner, PictureLight light, const Parameters& parameters);
CoefficientLight tilted(std::string_view owner, CoefficientLight light,
                        const Parameters& parameters);

}  // namespace hshfit::inline light
