#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/lighting/transformed_cosines.h>

#include <cstddef>

namespace hshfit::jobs {

/// Transformed cosines by elevation and, with a tangent, azimuth: the even part of the lobe apart
/// (LobeSummary, with the one of evenShares that misplaces the least light), the rest fitted from
/// its own moments and from the row before, by brdfs::fitLtc where lobes are their own mirror image
/// (lobesInPlane), else by brdfs::fitAskewLtc.
lighting::CosineTable fitCosineTable(const Brdf& brdf, lighting::ElevationRows rows,
                                     std::size_t azimuthSteps);

}  // namespace hshfit::jobs
