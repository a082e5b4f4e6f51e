#pragma once

#include <brdfs/measured/scattered/samples.h>

#include <cstddef>
#include <limits>
#include <vector>

namespace hshfit::brdfs {

/// One table of a format that lists f over polar angle and azimuth for a direction of incidence.
/// Angles are in radians, and both lists ascend.
struct AngleTable {
    static constexpr std::size_t missing = std::numeric_limits<std::size_t>::max();

    double incidence = 0;  ///< polar angle of wi
    double azimuth = 0;    ///< of wi
    /// The pole of the angles: the mirror direction of wi, with azimuth 0 towards the normal and
    /// counterclockwise as seen against that direction; or else the normal, with azimuth 0 on the
    /// mirror side and counterclockwise from above.
    bool aboutMirror = false;
    std::vector<double> polars = {}, azimuths = {};
    std::vector<std::size_t> samples = {};  ///< [polar][azimuth]; `missing`: not measured
};

/// The tables that samples were read from, one for each direction of incidence; none if some of
/// them lie in no table. The directions of an isotropic sample are taken relative to the plane of
/// incidence; normal incidence on another one has no such plane and is left out.
std::vector<AngleTable> tablesOf(const Samples& samples, bool aboutMirror, bool isotropic);

}  // namespace hshfit::brdfs
