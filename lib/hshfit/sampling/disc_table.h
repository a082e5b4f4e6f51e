#pragma once

#include <hshfit/brdf/brdf.h>
#include <hshfit/sampling/sampler.h>

#include <cstddef>

namespace hshfit::inline sampling {

/// Resolution of a table. Bytes: elevations x azimuths x 93 rows x (columns + 1) x 4, near 0.6 MB
/// for an isotropic BRDF and 9 MB for others.
struct DiscTableOptions {
    std::size_t elevations = 32;  ///< bins of wo, elevation_bins.h
    std::size_t azimuths = 16;    ///< bins of wo for BRDFs that are not isotropic
    std::size_t columns = 48;     ///< of a table, even
};

/// A density tabulated from any BRDF, for each bin of outgoing directions constant per projected
/// area, times cos(theta_i), on cells of the unit disc of (wi.x, wi.y): polar about the mirror
/// direction of the actual wo, with the radius as a share of the distance to the disc's edge.
/// Rows are geometric in the radius down to 2^-28, columns narrow towards the plane of incidence.
/// The map from cells to the hemisphere is a bijection for every wo, so that the density integrates
/// to 1 with no sample below the horizon.
///
/// The content of a cell is the mean of |f| over three outgoing elevations of the bin. Lobes that
/// are not at the mirror direction are resolved to the cells there, 1/12 of the distance or less,
/// and to the width of a bin. It takes the time of some 0.7 million values of f per azimuth bin.
std::shared_ptr<const Sampler> tabulate(const Brdf& brdf, const DiscTableOptions& options = {});

}  // namespace hshfit::inline sampling
