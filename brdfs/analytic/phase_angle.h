// Half the phase angle g between wi and wo. Compiled once for each instruction set.

#if defined(BRDFS_ANALYTIC_PHASE_ANGLE_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_PHASE_ANGLE_H
#undef BRDFS_ANALYTIC_PHASE_ANGLE_H
#else
#define BRDFS_ANALYTIC_PHASE_ANGLE_H
#endif

#include <brdfs/analytic/half_vector.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// sin(g/2) from the distance of both directions and cos(g/2) from the length of their sum: each
/// has all its digits where it is small.
template <class T>
struct PhaseAngle {
    T halfSine, halfCosine;

    template <class Outgoing>
    HWY_INLINE PhaseAngle(const Outgoing& wo, const Incoming<T>& wi)
        : halfCosine(HalfVector<T>(wo, wi).dotOutgoing()) {
        const T x = wi.x - T(wo.x), y = wi.y - T(wo.y), z = wi.z - T(wo.z);
        halfSine = min(0.5 * sqrt(x * x + y * y + z * z), T(1.0));
    }
};

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
