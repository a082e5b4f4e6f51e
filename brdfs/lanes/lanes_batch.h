// A batch of directions as many at a time as a register holds. Compiled once for each instruction
// set.

#if defined(BRDFS_LANES_LANES_BATCH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_LANES_LANES_BATCH_H
#undef BRDFS_LANES_LANES_BATCH_H
#else
#define BRDFS_LANES_LANES_BATCH_H
#endif

#include <brdfs/lanes/lanes.h>
#include <hshfit/brdf/directions.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// action(x, y, z, k) for directions k and on; lanes past the end are 0.
template <class Action>
HWY_INLINE void forEachLanes(const DirectionBatch& wi, Action action) {
    const std::size_t lanes = lanesIn<Lanes>();
    Lanes x, y, z;
    std::size_t k = 0;
    for (; k + lanes <= wi.count; k += lanes) {
        load(wi.x + k, x), load(wi.y + k, y), load(wi.z + k, z);
        action(x, y, z, k);
    }
    if (k == wi.count) return;
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
    double rest[3][most] = {};
    const double* const axes[] = {wi.x, wi.y, wi.z};
    for (int i = 0; i < 3; ++i) std::copy_n(axes[i] + k, wi.count - k, rest[i]);
    load(rest[0], x), load(rest[1], y), load(rest[2], z);
    action(x, y, z, k);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
