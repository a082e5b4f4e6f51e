#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/projection/internal/ring_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/projection/internal/ring_kernels.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline projection {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;
using Vec = hn::Vec<Tag>;

/// Four functions by four values: rows of values become rows of functions.
#if HWY_CAP_GE256
constexpr bool byFours = true;
HWY_INLINE void turnFour(const double* rows, std::size_t stride, double* out) {
    const hn::FixedTag<double, 4> d;
    const auto a = hn::LoadU(d, rows), b = hn::LoadU(d, rows + stride);
    const auto c = hn::LoadU(d, rows + 2 * stride), e = hn::LoadU(d, rows + 3 * stride);
    const auto ab = hn::InterleaveLower(d, a, b), abUpper = hn::InterleaveUpper(d, a, b);
    const auto ce = hn::InterleaveLower(d, c, e), ceUpper = hn::InterleaveUpper(d, c, e);
    hn::StoreU(hn::ConcatLowerLower(d, ce, ab), d, out);
    hn::StoreU(hn::ConcatLowerLower(d, ceUpper, abUpper), d, out + lanesOfFunctions);
    hn::StoreU(hn::ConcatUpperUpper(d, ce, ab), d, out + 2 * lanesOfFunctions);
    hn::StoreU(hn::ConcatUpperUpper(d, ceUpper, abUpper), d, out + 3 * lanesOfFunctions);
}
#else
constexpr bool byFours = false;
HWY_INLINE void turnFour(const double*, std::size_t, double*) {}
#endif

/// A full cache line of every row at a time. The rows of the next ring are prefetched meanwhile.
void interleave(const double* rows, std::size_t functions, std::size_t stride, std::size_t count,
                const double* next, double* out) {
    constexpr std::size_t line = 8;
    for (std::size_t p = 0; p < count; p += line) {
        const std::size_t end = p + line < count ? p + line : count;
        for (std::size_t f = 0; f < lanesOfFunctions; f += 4) {
            const double* first = rows + f * stride;
            double* to = out + f;
            std::size_t q = p;
            if (f + 4 <= functions) {
                for (std::size_t k = 0; next && k < 4; ++k)
                    hwy::Prefetch(next + (f + k) * stride + p);
                for (; byFours && q + 4 <= end; q += 4)
                    turnFour(first + q, stride, to + q * lanesOfFunctions);
            }
            for (; q < end; ++q)
                for (std::size_t k = 0; k < 4; ++k)
                    to[q * lanesOfFunctions + k] = f + k < functions ? first[k * stride + q] : 0.0;
        }
    }
}

struct Folded {
    Vec kinds[4];
};

HWY_INLINE Folded foldAt(const double* ring, std::size_t azimuths, std::size_t j, std::size_t f) {
    const Tag d;
    const auto at = [&](std::size_t k) { return hn::LoadU(d, ring + k * lanesOfFunctions + f); };
    const std::size_t middle = azimuths / 2;
    const Vec first = at(j), second = at(middle - 1 - j), third = at(azimuths - 1 - j),
              fourth = at(middle + j);
    const Vec even = hn::Add(first, third), odd = hn::Sub(first, third);
    const Vec evenBehind = hn::Add(second, fourth), oddBehind = hn::Sub(second, fourth);
    return {{hn::Add(even, evenBehind), hn::Sub(even, evenBehind), hn::Add(odd, oddBehind),
             hn::Sub(odd, oddBehind)}};
}

void foldMany(const double* ring, const double* mirror, std::size_t azimuths, double* sum,
              double* difference) {
    const Tag d;
    const std::size_t part = azimuths / 4 * lanesOfFunctions;
    for (std::size_t j = 0; j < azimuths / 4; ++j) {
        for (std::size_t f = 0; f < lanesOfFunctions; f += hn::Lanes(d)) {
            const std::size_t at = j * lanesOfFunctions + f;
            const Folded here = foldAt(ring, azimuths, j, f);
            if (!mirror) {
                for (std::size_t k = 0; k < 4; ++k)
                    hn::StoreU(here.kinds[k], d, sum + k * part + at);
                continue;
            }
            const Folded there = foldAt(mirror, azimuths, j, f);
            for (std::size_t k = 0; k < 4; ++k) {
                hn::StoreU(hn::Add(here.kinds[k], there.kinds[k]), d, sum + k * part + at);
                hn::StoreU(hn::Sub(here.kinds[k], there.kinds[k]), d, difference + k * part + at);
            }
        }
    }
}

void ringDirections(const RingDirections& ring, double sinTheta, double cosTheta,
                    double* HWY_RESTRICT x, double* HWY_RESTRICT y, double* HWY_RESTRICT z) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const Vec height = hn::Set(d, cosTheta);
    for (std::size_t quadrant = 0; quadrant < ring.copies; ++quadrant) {
        const double sx = quadrant % 2 == 0 ? sinTheta : -sinTheta;
        const double sy = quadrant < 2 ? sinTheta : -sinTheta;
        std::size_t j = 0;
        for (; j + lanes <= ring.count; j += lanes) {
            hn::StoreU(hn::Mul(hn::Set(d, sx), hn::LoadU(d, ring.cosine + j)), d, x + j);
            hn::StoreU(hn::Mul(hn::Set(d, sy), hn::LoadU(d, ring.sine + j)), d, y + j);
            hn::StoreU(height, d, z + j);
        }
        for (; j < ring.count; ++j) {
            x[j] = sx * ring.cosine[j];
            y[j] = sy * ring.sine[j];
            z[j] = cosTheta;
        }
        x += ring.count;
        y += ring.count;
        z += ring.count;
    }
}

void squeezedDirections(const RingDirections& ring, double sinTheta, double cosTheta,
                        double* HWY_RESTRICT x, double* HWY_RESTRICT y, double* HWY_RESTRICT z) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const double a = sinTheta * ring.centreX, b = sinTheta * ring.centreY;
    for (std::size_t copy = 0; copy < ring.copies; ++copy) {
        const double across = copy == 0 ? 1 : -1;
        const Vec xc = hn::Set(d, a), xs = hn::Set(d, -across * b);
        const Vec yc = hn::Set(d, b), ys = hn::Set(d, across * a), height = hn::Set(d, cosTheta);
        std::size_t j = 0;
        for (; j + lanes <= ring.count; j += lanes) {
            const Vec c = hn::LoadU(d, ring.cosine + j), s = hn::LoadU(d, ring.sine + j);
            hn::StoreU(hn::MulAdd(xc, c, hn::Mul(xs, s)), d, x + j);
            hn::StoreU(hn::MulAdd(yc, c, hn::Mul(ys, s)), d, y + j);
            hn::StoreU(height, d, z + j);
        }
        for (; j < ring.count; ++j) {
            x[j] = a * ring.cosine[j] - across * b * ring.sine[j];
            y[j] = b * ring.cosine[j] + across * a * ring.sine[j];
            z[j] = cosTheta;
        }
        x += ring.count;
        y += ring.count;
        z += ring.count;
    }
}

template <bool Half, class D>
HWY_INLINE hn::Vec<D> foldPairs(D d, const double* values, const double* weights, std::size_t from,
                                std::size_t to, std::size_t count, double* even, double* odd) {
    hn::Vec<D> squares = hn::Zero(d);
    for (std::size_t k = from; k < to; k += hn::Lanes(d)) {
        const hn::Vec<D> first = hn::LoadU(d, values + k);
        hn::Vec<D> square = hn::Mul(first, first);
        if constexpr (Half) {
            hn::StoreU(first, d, even + k);
        } else {
            const hn::Vec<D> second = hn::LoadU(d, values + count + k);
            square = hn::MulAdd(second, second, square);
            hn::StoreU(hn::Add(first, second), d, even + k);
            hn::StoreU(hn::Sub(first, second), d, odd + k);
        }
        squares = hn::MulAdd(hn::LoadU(d, weights + k), square, squares);
    }
    return squares;
}

template <bool Half>
HWY_INLINE double foldSqueezedOf(const double* values, const double* weights, std::size_t count,
                                 double* even, double* odd) {
    const Tag d;
    const hn::CappedTag<double, 1> one;
    const std::size_t whole = count / hn::Lanes(d) * hn::Lanes(d);
    const Vec most = foldPairs<Half>(d, values, weights, 0, whole, count, even, odd);
    const auto rest = foldPairs<Half>(one, values, weights, whole, count, count, even, odd);
    return hn::GetLane(hn::SumOfLanes(d, most)) + hn::GetLane(rest);
}

double foldSqueezed(const double* values, const double* weights, std::size_t count, double* even,
                    double* odd) {
    return odd ? foldSqueezedOf<false>(values, weights, count, even, odd)
               : foldSqueezedOf<true>(values, weights, count, even, odd);
}

/// One vector's worth from number k on; the squares of the lanes in `counted` only.
template <bool Half, class D, class Mask>
HWY_INLINE hn::Vec<D> foldOnce(D d, const double* values, std::size_t count, std::size_t k,
                               const QuadrantFold& out, hn::Vec<D> squares, Mask counted) {
    const auto at = [&](std::size_t quadrant)
                        HWY_ATTR { return hn::LoadU(d, values + quadrant * count + k); };
    const auto add = [&](hn::Vec<D> a, hn::Vec<D> b) HWY_ATTR {
        squares = hn::Add(squares, counted(hn::MulAdd(a, a, hn::Mul(b, b))));
    };
    const hn::Vec<D> first = at(0), second = at(1);
    add(first, second);
    if constexpr (Half) {
        hn::StoreU(hn::Add(first, second), d, out.c0 + k);
        hn::StoreU(hn::Sub(first, second), d, out.c1 + k);
    } else {
        const hn::Vec<D> third = at(2), fourth = at(3);
        add(third, fourth);
        const hn::Vec<D> even = hn::Add(first, third), odd = hn::Sub(first, third);
        const hn::Vec<D> evenBehind = hn::Add(second, fourth), oddBehind = hn::Sub(second, fourth);
        hn::StoreU(hn::Add(even, evenBehind), d, out.c0 + k);
        hn::StoreU(hn::Sub(even, evenBehind), d, out.c1 + k);
        hn::StoreU(hn::Add(odd, oddBehind), d, out.s1 + k);
        hn::StoreU(hn::Sub(odd, oddBehind), d, out.s0 + k);
    }
    return squares;
}

/// The last vector of a quadrant overlaps the one before; less than a vector goes one by one.
template <bool Half>
double fold(const double* values, std::size_t count, const QuadrantFold& out) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const auto all = [](auto v) HWY_ATTR { return v; };
    if (count < lanes) {
        const hn::CappedTag<double, 1> one;
        auto squares = hn::Zero(one);
        for (std::size_t k = 0; k < count; ++k)
            squares = foldOnce<Half>(one, values, count, k, out, squares, all);
        return hn::GetLane(squares);
    }
    Vec squares = hn::Zero(d);
    std::size_t k = 0;
    for (; k + lanes <= count; k += lanes)
        squares = foldOnce<Half>(d, values, count, k, out, squares, all);
    if (k < count) {
        const auto known = hn::FirstN(d, lanes - (count - k));
        squares = foldOnce<Half>(d, values, count, count - lanes, out, squares,
                                 [&](Vec v) HWY_ATTR { return hn::IfThenZeroElse(known, v); });
    }
    return hn::GetLane(hn::SumOfLanes(d, squares));
}

double foldWhole(const double* values, std::size_t count, const QuadrantFold& out) {
    return fold<false>(values, count, out);
}
double foldHalf(const double* values, std::size_t count, const QuadrantFold& out) {
    return fold<true>(values, count, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline projection
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline projection {

HWY_EXPORT(ringDirections);
HWY_EXPORT(squeezedDirections);
HWY_EXPORT(foldSqueezed);
HWY_EXPORT(interleave);
HWY_EXPORT(foldMany);
HWY_EXPORT(foldWhole);
HWY_EXPORT(foldHalf);

void fillRing(const RingDirections& ring, double sinTheta, double cosTheta, double* x, double* y,
              double* z) {
    HWY_DYNAMIC_DISPATCH(ringDirections)(ring, sinTheta, cosTheta, x, y, z);
}

void fillSqueezedRing(const RingDirections& ring, double sinTheta, double cosTheta, double* x,
                      double* y, double* z) {
    HWY_DYNAMIC_DISPATCH(squeezedDirections)(ring, sinTheta, cosTheta, x, y, z);
}

double foldSqueezedRing(const double* values, const double* weights, std::size_t count,
                        double* even, double* odd) {
    return HWY_DYNAMIC_DISPATCH(foldSqueezed)(values, weights, count, even, odd);
}

void interleaveFunctions(const double* rows, std::size_t functions, std::size_t stride,
                         std::size_t count, const double* next, double* out) {
    HWY_DYNAMIC_DISPATCH(interleave)(rows, functions, stride, count, next, out);
}

void foldFunctions(const double* ring, const double* mirror, std::size_t azimuths, double* sum,
                   double* difference) {
    HWY_DYNAMIC_DISPATCH(foldMany)(ring, mirror, azimuths, sum, difference);
}

double foldRing(const double* values, std::size_t count, const QuadrantFold& out) {
    return HWY_DYNAMIC_DISPATCH(foldWhole)(values, count, out);
}

double foldHalfRing(const double* values, std::size_t count, const QuadrantFold& out) {
    return HWY_DYNAMIC_DISPATCH(foldHalf)(values, count, out);
}

}  // namespace hshfit::inline projection
#endif  // HWY_ONCE
