#include <brdfs/measured/merl_layout.h>

#include <cmath>

namespace hshfit::brdfs {

DirectionPair merlDirections(double h, double d, double p) {
    const double thetaHalf = merlHalfAngle(h);
    const Direction half = directionFromAngles(thetaHalf, 0);
    const Direction difference = directionFromAngles(radians(d), radians(p));
    // wi = R_y(theta_h) difference; wo has the opposite azimuth about the half vector.
    const double along = difference.z, across = difference.x;
    return {
        .wi = {half.z * across + half.x * along, difference.y, half.z * along - half.x * across},
        .wo = {half.x * along - half.z * across, -difference.y, half.z * along + half.x * across}};
}

bool merlBelowHorizon(double h, double d, double p) {
    const DirectionPair pair = merlDirections(h, d, p);
    constexpr double horizon = 1e-12;  // above the rounding errors of nodes at exactly 90 degrees
    return pair.wi.z < horizon || pair.wo.z < horizon;
}

}  // namespace hshfit::brdfs
