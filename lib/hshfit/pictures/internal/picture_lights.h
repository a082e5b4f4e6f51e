#pragma once

#include <hshfit/pictures/sphere.h>

#include <string>
#include <vector>

namespace hshfit::inline pictures {

/// A light under which spheres are drawn to compare materials.
struct PictureLight {
    std::string name;  ///< "lamp at 30 degrees"
    SphereRig rig;
};

/// The lights of every picture error, always the same: a lamp at 4 (behind the camera), 30, 60 and
/// 80 degrees from the line of sight, from the upper left, each as a point and as a disc 20 degrees
/// wide (19 points of it); an even sky; and a room with a window of 40 by 30 degrees, a lamp under
/// the ceiling, a bright wall opposite, and a fifth of the window's light from all around.
const std::vector<PictureLight>& pictureLights();

}  // namespace hshfit::inline pictures
