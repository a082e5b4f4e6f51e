#include <hshfit/bases/internal/long_orders.h>

#include <hshfit/vector_targets.h>

#include <algorithm>

#include <hwy/aligned_allocator.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/bases/internal/theta.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/internal/columns-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {
namespace {

/// One column for a block of elevations.
template <class D, int vectors>
struct Elevations {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    using Doubles = hn::CappedTag<double, lanesOf<D> == 1 ? 1 : 64 / sizeof(double)>;
    using W = hn::Vec<Doubles>;
    static constexpr std::size_t n = lanesOf<D>, width = n * vectors;

    HWY_ALIGN double mu[width], rest[width];
    HWY_ALIGN T distance[width], side[width], p[width], e[width];

    HWY_INLINE void load(const Elevation<T>* points, std::size_t valid) {
        for (std::size_t j = 0; j < width; ++j) {
            const Elevation<T>& point = points[std::min(j, valid - 1)];
            mu[j] = double{point.mu};
            rest[j] = double{point.oneMinusMu};
        }
    }

    /// Distance from the nearer end and c_m F^m W of the elevations from j on. In double for either
    /// type: F^m multiplies the rounding of F by m.
    HWY_INLINE void start(const Recurrences<T>& r, int m, std::size_t j) {
        const Doubles wide;
        const W zero = hn::Zero(wide), one = hn::Set(wide, 1);
        const W height = hn::Load(wide, mu + j), oneMinus = hn::Load(wide, rest + j);
        const auto below = hn::Lt(height, zero);
        W square, far, nearer, weight = one;
        if (r.domain == Domain::sphere) {
            far = hn::IfThenElse(below, one, zero);
            nearer = hn::IfThenElse(below, hn::Add(one, height), oneMinus);
            square = hn::Mul(oneMinus, hn::Add(one, height));
        } else {
            const bool chord = r.domain == Domain::chord;
            const auto nearPole = hn::Le(oneMinus, hn::Set(wide, 0.5));
            far = hn::IfThenElse(nearPole, chord ? one : zero, chord ? zero : one);
            nearer = hn::IfThenElse(nearPole, oneMinus, height);
            nearer = hn::Add(nearer, nearer);
            square = chord ? oneMinus : hn::Mul(hn::Mul(hn::Set(wide, 4), height), oneMinus);
            if (r.timesRootCosine) weight = hn::Sqrt(hn::Max(height, zero));
            weight = hn::IfThenElse(below, zero, weight);
        }
        const W signedNearer = hn::IfThenElse(
            hn::Gt(far, zero), r.symmetric ? hn::Neg(nearer) : nearer, hn::Neg(nearer));
        storeReal(wide, signedNearer, distance + j);
        storeReal(wide, far, side + j);

        const W tiny = hn::Set(wide, std::numeric_limits<double>::min());
        const auto noFactor = hn::Lt(square, tiny), noWeight = hn::Lt(weight, tiny);
        const W safe = hn::IfThenElse(noFactor, one, square);
        Scaled<Doubles> power(hn::IfThenElse(noWeight, one, weight)), factor(safe);
        if (m % 2 == 1) power.multiply(Scaled<Doubles>(hn::Sqrt(safe)));
        for (int bits = m / 2; bits > 0; bits /= 2) {
            if (bits % 2 == 1) power.multiply(factor);
            factor.multiply(factor);
        }
        W value, exponent;
        startOf<T>(wide, power, m > 0 ? hn::Or(noFactor, noWeight) : noWeight, value, exponent);
        storeReal(wide, hn::Mul(value, hn::Set(wide, r.starts[m])), p + j);
        storeReal(wide, exponent, e + j);
    }

    /// Values of function k to out[k rowStep + lane].
    struct Take {
        const T* sign;  ///< [k % 2][lane]
        T* out;
        std::size_t rowStep;
        bool oddOnes;

        HWY_INLINE void operator()(int k, int v, V value) const {
            if (k % 2 != 0)
                value = oddOnes ? hn::Mul(value, hn::Load(D(), sign + v * n)) : hn::Zero(D());
            hn::StoreU(value, D(), out + static_cast<std::size_t>(k) * rowStep + v * n);
        }
    };

    /// `out` has room for `width` values in every row.
    HWY_INLINE void run(const Recurrences<T>& r, int m, T* out, std::size_t rowStep) {
        for (std::size_t j = 0; j < width; j += lanesOf<Doubles>) start(r, m, j);
        HWY_ALIGN T sign[width];
        for (std::size_t j = 0; j < width; ++j) sign[j] = r.symmetric && side[j] > 0 ? -1 : 1;
        Column<D, vectors> state(distance, side, p, e);
        const auto column = static_cast<std::size_t>(m);
        const Step<T>*one = r.steps[0] + r.offsets[column], *other = r.steps[1] + r.offsets[column];
        const int count = (r.order - m + r.bandStep - 1) / r.bandStep;
        const Take take{sign, out, rowStep, !r.evenOnly};
        if (r.symmetric)
            state.template run<true>(one, other, count, take);
        else
            state.template run<false>(one, other, count, take);
    }
};

template <class D, int vectors, class T = hn::TFromD<D>>
void block(const Recurrences<T>& r, int m, std::span<const Elevation<T>> points, std::size_t first,
           T* out, T* few) {
    using Points = Elevations<D, vectors>;
    Points points_;
    const std::size_t valid = std::min(Points::width, points.size() - first);
    const auto step = static_cast<std::size_t>(r.bandStep);
    points_.load(points.data() + first, valid);
    if (valid == Points::width) {
        points_.run(r, m, out + first, step * points.size());
        return;
    }
    points_.run(r, m, few, Points::width);
    for (std::size_t l = 0, k = 0; l < static_cast<std::size_t>(r.order - m); l += step, ++k)
        std::copy_n(few + k * Points::width, valid, out + l * points.size() + first);
}

template <class T>
void allPoints(const Recurrences<T>& r, int m, std::span<const Elevation<T>> points, T* out) {
    using D = Wide<T>;
    constexpr int vectors = 2;
    constexpr std::size_t width = Elevations<D, vectors>::width;
    const std::size_t count = points.size(), rows = static_cast<std::size_t>(r.order - m);
    hwy::AlignedFreeUniquePtr<T[]> few;
    if (count % width != 0) few = hwy::AllocateAligned<T>(rows * width);
    for (std::size_t first = 0; first < count; first += width) {
        if (count - first == 1)
            block<Single<T>, 1>(r, m, points, first, out, few.get());
        else
            block<D, vectors>(r, m, points, first, out, few.get());
    }
    for (std::size_t row = 1; r.bandStep == 2 && row < rows; row += 2)
        std::fill_n(out + row * count, count, T{0});
}

}  // namespace

void thetaDouble(const Recurrences<double>& r, int m, std::span<const Elevation<double>> points,
                 double* out) {
    allPoints(r, m, points, out);
}

void thetaFloat(const Recurrences<float>& r, int m, std::span<const Elevation<float>> points,
                float* out) {
    allPoints(r, m, points, out);
}

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::bases::kernels {

HWY_EXPORT(thetaDouble);
HWY_EXPORT(thetaFloat);

void theta(const Recurrences<double>& r, int m, std::span<const Elevation<double>> points,
           double* out) {
    HWY_DYNAMIC_DISPATCH(thetaDouble)(r, m, points, out);
}

void theta(const Recurrences<float>& r, int m, std::span<const Elevation<float>> points,
           float* out) {
    HWY_DYNAMIC_DISPATCH(thetaFloat)(r, m, points, out);
}

}  // namespace hshfit::bases::kernels
#endif
