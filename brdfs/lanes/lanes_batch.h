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

/// action(x, y, z, k) for directions k and on; lanes past the end are 0. `action` is called at one
/// place and therefore inlined: GCC leaves the upper halves of registers in use after a function
/// that takes vectors, and scalar code runs at a fifth of its speed then.
template <class Action>
HWY_INLINE void forEachLanes(const DirectionBatch& wi, Action action) {
    const std::size_t lanes = lanesIn<Lanes>();
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
    double rest[3][most] = {};
    for (std::size_t k = 0; k < wi.count; k += lanes) {
        const double* axes[] = {wi.x + k, wi.y + k, wi.z + k};
        if (k + lanes > wi.count) {
            for (int i = 0; i < 3; ++i) {
                std::copy_n(axes[i], wi.count - k, rest[i]);
                axes[i] = rest[i];
            }
        }
        Lanes x, y, z;
        load(axes[0], x), load(axes[1], y), load(axes[2], z);
        action(x, y, z, k);
    }
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
