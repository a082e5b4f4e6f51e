#pragma once

#include <hshfit/transport/surface_scene.h>

#include <optional>

namespace hshfit::inline transport::inline radiance_cache {

/// A place for a record: the middle of the part of a small disc about a hit that is seen from in
/// front of it. It keeps away from edges, on which rays would start on another surface. The hit
/// itself where all of the disc is seen; none where the disc's middle does not show the same
/// material at a similar normal. `radius` is the disc's.
std::optional<SurfaceHit> placeOfRecord(const SurfaceScene& scene, const SurfaceHit& hit,
                                        double radius);

}  // namespace hshfit::inline transport::inline radiance_cache
