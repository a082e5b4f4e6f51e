// Nodes of a table of the parameters' own numbers, several at a time in a fit. Compiled once for
// each instruction set.

#if defined(BRDFS_ANALYTIC_TABLE_NODES_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_TABLE_NODES_H
#undef BRDFS_ANALYTIC_TABLE_NODES_H
#else
#define BRDFS_ANALYTIC_TABLE_NODES_H
#endif

#include <brdfs/lanes/lanes_slopes_math.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// The number type in which nodes of a table are computed; a fit computes several at a time.
template <class N>
struct Node {
    using Value = double;
    using Number = double;
};
template <int n>
struct Node<Slopes<double, n>> {
    using Value = Lanes;
    using Number = Slopes<Lanes, n>;
};

HWY_INLINE void storeNode(double value, std::size_t, double* to) {
    *to = value;
}
template <int n>
HWY_INLINE void storeNode(const Slopes<Lanes, n>& value, std::size_t size, Slopes<double, n>* to) {
    double buffer[HWY_MAX_BYTES / sizeof(double)];
    store(value.value, buffer);
    for (std::size_t k = 0; k < size; ++k) to[k].value = buffer[k];
    for (int i = 0; i < n; ++i) {
        store(value.by[i], buffer);
        for (std::size_t k = 0; k < size; ++k) to[k].by[i] = buffer[k];
    }
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
