#pragma once

#include <hshfit/brdf/brdf.h>

#include <cstddef>
#include <memory>
#include <string>

namespace hshfit::jobs {

/// A texel of a map of filtered lobes as a BRDF in the frame of the surface: of level 0 its model,
/// turned to its normal and direction, times cos of the angle to that normal over cos(theta_i);
/// of other levels what their numbers say (FilteredTexel). Throws InputError and UsageError.
std::unique_ptr<Brdf> openFilteredTexel(const std::string& sidecar, std::size_t level,
                                        std::size_t column, std::size_t row);

}  // namespace hshfit::jobs
