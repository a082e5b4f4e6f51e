#pragma once

#include <brdfs/analytic/half_vector.h>

namespace hshfit::brdfs {

/// G / (cos_i cos_o) with the masking of V-shaped grooves,
///     G = min(1, 2 h.z cos_o / (h.wo), 2 h.z cos_i / (h.wo)),   h normalised,
/// the cosines divided out term by term. May be infinite where both directions graze. Torrance &
/// Sparrow 1967, 10.1364/JOSA.57.001105. Has kinks where the minimum changes sides.
inline double vGrooveVisibility(const HalfVector& h, double cosI, double cosO) {
    const double open = 1 / cosI / cosO;
    const double blocked =
        2 / std::sqrt(1 + h.squaredSlope()) / h.dotOutgoing() / std::max(cosI, cosO);
    return std::min(open, blocked);
}

}  // namespace hshfit::brdfs
