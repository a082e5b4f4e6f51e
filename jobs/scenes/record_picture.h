#pragma once

#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/transport/radiance_cache/cached_picture.h>

#include <cstddef>

namespace hshfit::jobs {

/// A picture at half its brightness with a dot at each record that the camera sees: orange for
/// those before `fresh`, which earlier pictures made, and blue for the others. `stops` is the
/// exposure at which the dots have these colours.
RgbPicture withRecords(const RgbPicture& picture, const RadianceCache& cache, const Camera& camera,
                       std::size_t fresh, double stops);

}  // namespace hshfit::jobs
