#pragma once

#include <hshfit/light/lights.h>

#include <string>

namespace hshfit::inline light {

/// The remark on a cube whose faces do not meet: neighbouring pixels over the edges of its faces
/// differ by more than 4 times as much as pixels beside the edges, and by more than 2 % of the mean
/// along them. It says an arrangement of the same faces in which they do, if there is one: another
/// order of a strip, or the back of a cross turned by 180 degrees. Empty for other layouts and for
/// cubes whose edges meet.
std::string seamRemark(const PictureLight& light);

}  // namespace hshfit::inline light
