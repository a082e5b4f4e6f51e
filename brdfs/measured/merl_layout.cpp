#include <brdfs/measured/merl_layout.h>

namespace hshfit::brdfs {

DirectionPair merlDirections(double h, double d, double p) {
    return fromHalfDifference(merlHalfAngle(h), 0, radians(d), radians(p));
}

bool merlBelowHorizon(double h, double d, double p) {
    const DirectionPair pair = merlDirections(h, d, p);
    constexpr double horizon = 1e-12;  // above the rounding errors of nodes at exactly 90 degrees
    return pair.wi.z < horizon || pair.wo.z < horizon;
}

}  // namespace hshfit::brdfs
