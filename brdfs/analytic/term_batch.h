// Values of f from the terms of a model, a formula in any number type T: TermBrdf's sums for
// double and for Lanes (lanes.h). Compiled once for each instruction set.
//
// `Terms<T>(shape, wo)` holds the factors that depend on wo alone. `operator()(Incoming<T>, T*
// term)` writes `count` terms, or the batch's number of terms if `count` is `someTerms`. Terms
// with wi.z <= 0 are ignored, +inf is cut to the largest double, and NaN never occurs above the
// horizon.

#if defined(BRDFS_ANALYTIC_TERM_BATCH_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BRDFS_ANALYTIC_TERM_BATCH_H
#undef BRDFS_ANALYTIC_TERM_BATCH_H
#else
#define BRDFS_ANALYTIC_TERM_BATCH_H
#endif

#include <brdfs/analytic/term_brdf.h>
#include <brdfs/lanes/lanes.h>
#include <brdfs/lanes/lanes_math.h>
#include <brdfs/lanes/lanes_slopes_math.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace hshfit::brdfs::HWY_NAMESPACE {

/// A number of terms that varies between members of the model and exceeds one.
constexpr std::size_t someTerms = TermBatch::maxTerms;

template <class T>
struct Incoming {
    T x, y, z;
};

/// The types that go with a formula's T: numbers of directions, numbers of parameters, and the
/// outgoing direction. An evaluation has one outgoing direction, a fit one in each lane.
template <class T>
struct Numbers {
    using Real = T;
    using Parameter = double;
    using Outgoing = Direction;
};
template <int n>
struct Numbers<Slopes<Lanes, n>> {
    using Real = Lanes;
    using Parameter = Slopes<double, n>;
    using Outgoing = Incoming<Lanes>;
};
template <class T>
using RealOf = typename Numbers<T>::Real;
template <class T>
using ParameterOf = typename Numbers<T>::Parameter;
template <class T>
using OutgoingOf = typename Numbers<T>::Outgoing;
template <class T>
using HeightOf = decltype(OutgoingOf<T>::z);

/// f of as many directions as a T holds, to values[channel * stride].
template <class T, class Terms>
HWY_INLINE void evalSome(const Terms& terms, const TermBatch& batch, const double* x,
                         const double* y, const double* z, double* values, std::size_t stride) {
    Incoming<T> wi;
    load(x, wi.x), load(y, wi.y), load(z, wi.z);
    const auto above = wi.z > T(0.0);
    const auto write = [&](T sum, std::size_t c) HWY_ATTR {
        store(select(above, bounded(max(sum, T(0.0))), T(0.0)), values + c * stride);
    };
    if constexpr (Terms::count == 0) {
        for (std::size_t c = 0; c < batch.channels; ++c) write(T(batch.constant[c]), c);
    } else if constexpr (Terms::count == 1) {
        T term;
        terms(wi, &term);
        term = bounded(term);
        for (std::size_t c = 0; c < batch.channels; ++c)
            write(T(batch.constant[c]) + T(batch.weights[c]) * term, c);
    } else {
        T term[TermBatch::maxTerms];
        terms(wi, term);
        const std::size_t count = Terms::count == someTerms ? batch.terms : Terms::count;
        for (std::size_t t = 0; t < count; ++t) term[t] = bounded(term[t]);
        for (std::size_t c = 0; c < batch.channels; ++c) {
            T sum = batch.constant[c];
            for (std::size_t t = 0; t < count; ++t)
                sum = sum + T(batch.weights[c * count + t]) * term[t];
            write(sum, c);
        }
    }
}

template <class T, template <class> class Terms, class Shape>
HWY_INLINE void evalAll(const Shape& shape, const TermBatch& batch) {
    const Terms<T> terms(shape, batch.wo);
    const DirectionBatch& wi = batch.wi;
    const std::size_t lanes = lanesIn<T>();
    std::size_t k = 0;
    for (; k + lanes <= wi.count; k += lanes)
        evalSome<T>(terms, batch, wi.x + k, wi.y + k, wi.z + k, batch.out + k, wi.count);
    const std::size_t rest = wi.count - k;
    if (rest == 0) return;
    constexpr std::size_t most = HWY_MAX_BYTES / sizeof(double);
    double x[most] = {}, y[most] = {}, z[most] = {}, values[TermBatch::maxChannels * most];
    std::copy_n(wi.x + k, rest, x);
    std::copy_n(wi.y + k, rest, y);
    std::copy_n(wi.z + k, rest, z);
    evalSome<T>(terms, batch, x, y, z, values, most);
    for (std::size_t c = 0; c < batch.channels; ++c)
        std::copy_n(values + c * most, rest, batch.out + c * wi.count + k);
}

/// The evaluation with all lanes, for the table of HWY_EXPORT.
template <template <class> class Terms, class Shape>
HWY_INLINE void evalLanes(const Shape& shape, const TermBatch& batch) {
    evalAll<Lanes, Terms>(shape, batch);
}

}  // namespace hshfit::brdfs::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
