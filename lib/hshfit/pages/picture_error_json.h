#pragma once

#include <hshfit/pictures/picture_error.h>

#include <nlohmann/json_fwd.hpp>

namespace hshfit::inline pages {

/// The object "picture" of several answers (docs/schemas/picture.schema.json): shares, not percent;
/// directions in degrees.
nlohmann::ordered_json pictureErrorJson(const PictureError& error);

nlohmann::ordered_json overLightsJson(const OverLights& all);  ///< its "flip" and "ciede2000"

/// The picture error of such an object.
PictureError pictureErrorFrom(const nlohmann::ordered_json& json);

}  // namespace hshfit::inline pages
