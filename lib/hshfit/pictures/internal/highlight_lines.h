#pragma once

#include <hshfit/brdf/directions.h>

#include <span>
#include <vector>

namespace hshfit::inline pictures {

/// Pairs of directions along a line through the highlight, and an angle for each, in degrees,
/// ascending.
struct HighlightLine {
    std::vector<double> angles = {};
    std::vector<DirectionPair> pairs = {};
};

/// The lines along which a highlight is looked at, all with both directions at elevations of at
/// most 85 degrees:
/// - the angle from lamp to camera fixed at 4, 30, 60, 90, 120, 140 or 160 degrees, the half vector
///   moving through the normal, in the plane of incidence and across it (angle: theta_h);
/// - theta_i fixed at 0, 15, 30, 45, 60 or 75 degrees, wo moving through the mirror direction in
///   the plane of incidence (angle: theta_o less theta_i);
/// - the mirror ridge, as below.
/// Angles are dense about the middle of the highlight, at distances from 0.001 degrees.
/// Isotropic: at azimuth 0; else at azimuths 0, 45 and 90 degrees. Made once.
std::span<const HighlightLine> highlightLines(bool isotropic);

/// wi = (t, phi) and wo = (t, phi + 180 degrees) for t = 0, 1, … 80 degrees (angle: t), at the same
/// azimuths.
std::span<const HighlightLine> mirrorRidges(bool isotropic);

}  // namespace hshfit::inline pictures
