#pragma once

#include <hshfit/rendering/lit_picture.h>

#include <functional>

namespace hshfit::lighting {

/// Radiance of a surface from its normal and the direction to the viewer, both in the world.
using Shading = std::function<Rgb(const Direction& normal, const Direction& viewer)>;

/// A picture by a model of lighting, and what it took.
struct ShadedPicture {
    SpherePicture picture;
    double nanoseconds = 0;  ///< of one thread for a point, on the processor
};

/// The model at every point of a surface, on all threads.
ShadedPicture render(const Shading& shading, const SurfacePoints& points, const View& view);

}  // namespace hshfit::lighting
