#pragma once

#include <hshfit/pictures/picture_error.h>

#include <optional>

namespace hshfit::jobs {

/// The picture error of `g` against `f`; none where either is known for one outgoing direction
/// alone, since a sphere shows many.
std::optional<PictureError> pictureErrorOf(const Brdf& f, const Brdf& g);

/// Whether a BRDF is known for one outgoing direction alone.
bool hasOneDirection(const Brdf& brdf);

}  // namespace hshfit::jobs
