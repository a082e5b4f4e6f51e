// The angles of angles.h for Lanes (brdfs/lanes/lanes.h), with the same polynomial and the same
// errors. Compiled once for each instruction set.

#if defined(BRDFS_MEASURED_ANGLE_LANES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_MEASURED_ANGLE_LANES_H
#undef BRDFS_MEASURED_ANGLE_LANES_H
#else
#define BRDFS_MEASURED_ANGLE_LANES_H
#endif

#include <brdfs/lanes/lanes.h>
#include <brdfs/measured/angles.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// atan2(y, x) for x, y >= 0; 0 at the origin.
HWY_INLINE Lanes quadrantAngle(Lanes y, Lanes x) {
    static constexpr std::array<double, atanTerms> c = atanPowers();
    static_assert(atanTerms == 14);
    const Lanes large = max(x, y), small = min(x, y);
    const Lanes t = small / max(large, 1e-300);
    const Lanes s = t * t, s2 = s * s, s4 = s2 * s2;
    const Lanes g0 = (c[0] + c[1] * s) + (c[2] + c[3] * s) * s2;
    const Lanes g1 = (c[4] + c[5] * s) + (c[6] + c[7] * s) * s2;
    const Lanes g2 = (c[8] + c[9] * s) + (c[10] + c[11] * s) * s2;
    const Lanes g3 = c[12] + c[13] * s;
    const Lanes angle = ((g0 + g1 * s4) + (g2 + g3 * s4) * (s4 * s4)) * t;
    return select(y > x, pi / 2 - angle, angle);
}

/// atan2(y, x) in [-pi, pi]; 0 at the origin.
HWY_INLINE Lanes rayAngle(Lanes y, Lanes x) {
    const Lanes zero = 0.0, angle = quadrantAngle(abs(y), abs(x));
    const Lanes half = select(x < zero, pi - angle, angle);
    return select(y < zero, -half, half);
}

/// atan2(y, x) folded to [0, pi]: a line through the origin, not a ray (period pi).
HWY_INLINE Lanes lineAngle(Lanes y, Lanes x) {
    const Lanes zero = 0.0, angle = quadrantAngle(abs(y), abs(x));
    // The folded angle is pi - angle if exactly one of the two is below 0.
    const Lanes turned = select(x < zero, pi - angle, angle);
    return select(y < zero, select(x < zero, angle, pi - angle), turned);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
