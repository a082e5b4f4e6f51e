// Compiled once for each instruction set and chosen from at run time. SSSE3 has too few users to
// compile for; the vectors of SVE and RVV cannot be kept in arrays.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/ring_kernels.cpp"
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
#include <hwy/foreach_target.h>

#include <hshfit/ring_kernels.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;
using Vec = hn::Vec<Tag>;

/// I x J products at once: 4 x 3 keep 12 sums, and what is multiplied, in 16 registers.
template <std::size_t I, std::size_t J>
HWY_INLINE void tile(const double* HWY_RESTRICT a, std::size_t aStride,
                     const double* HWY_RESTRICT b, std::size_t bStride, std::size_t depth,
                     double* HWY_RESTRICT out, std::size_t outStride) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    Vec sums[I][J];
    for (auto& row : sums)
        for (Vec& sum : row) sum = hn::Zero(d);
    std::size_t k = 0;
    for (; k + lanes <= depth; k += lanes) {
        Vec right[J];
        for (std::size_t j = 0; j < J; ++j) right[j] = hn::LoadU(d, b + j * bStride + k);
        for (std::size_t i = 0; i < I; ++i) {
            const Vec left = hn::LoadU(d, a + i * aStride + k);
            for (std::size_t j = 0; j < J; ++j) sums[i][j] = hn::MulAdd(left, right[j], sums[i][j]);
        }
    }
    if (k < depth) {
        const auto mask = hn::FirstN(d, depth - k);
        Vec right[J];
        for (std::size_t j = 0; j < J; ++j) right[j] = hn::MaskedLoad(mask, d, b + j * bStride + k);
        for (std::size_t i = 0; i < I; ++i) {
            const Vec left = hn::MaskedLoad(mask, d, a + i * aStride + k);
            for (std::size_t j = 0; j < J; ++j) sums[i][j] = hn::MulAdd(left, right[j], sums[i][j]);
        }
    }
    for (std::size_t i = 0; i < I; ++i)
        for (std::size_t j = 0; j < J; ++j)
            out[i * outStride + j] += hn::GetLane(hn::SumOfLanes(d, sums[i][j]));
}

template <std::size_t I>
void rowsOf(const double* a, std::size_t aStride, const RowBlock& b, std::size_t depth, double* out,
            std::size_t outStride) {
    std::size_t j = 0;
    for (; j + 3 <= b.rows; j += 3)
        tile<I, 3>(a, aStride, b.data + j * b.stride, b.stride, depth, out + j, outStride);
    if (b.rows - j == 2)
        tile<I, 2>(a, aStride, b.data + j * b.stride, b.stride, depth, out + j, outStride);
    if (b.rows - j == 1)
        tile<I, 1>(a, aStride, b.data + j * b.stride, b.stride, depth, out + j, outStride);
}

void rowProducts(const RowBlock& a, const RowBlock& b, std::size_t depth, double* out,
                 std::size_t outStride) {
    std::size_t i = 0;
    for (; i + 4 <= a.rows; i += 4)
        rowsOf<4>(a.data + i * a.stride, a.stride, b, depth, out + i * outStride, outStride);
    for (; i + 2 <= a.rows; i += 2)
        rowsOf<2>(a.data + i * a.stride, a.stride, b, depth, out + i * outStride, outStride);
    if (i < a.rows)
        rowsOf<1>(a.data + i * a.stride, a.stride, b, depth, out + i * outStride, outStride);
}

/// I rows by J vectors of functions.
template <std::size_t I, std::size_t J>
HWY_INLINE void columnTile(const double* HWY_RESTRICT a, std::size_t aStride,
                           const double* HWY_RESTRICT b, std::size_t depth,
                           double* HWY_RESTRICT out, std::size_t outStride) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    Vec sums[I][J];
    for (std::size_t i = 0; i < I; ++i)
        for (std::size_t j = 0; j < J; ++j)
            sums[i][j] = hn::LoadU(d, out + i * outStride + j * lanes);
    for (std::size_t k = 0; k < depth; ++k, b += lanesOfFunctions) {
        Vec right[J];
        for (std::size_t j = 0; j < J; ++j) right[j] = hn::LoadU(d, b + j * lanes);
        for (std::size_t i = 0; i < I; ++i) {
            const Vec left = hn::Set(d, a[i * aStride + k]);
            for (std::size_t j = 0; j < J; ++j) sums[i][j] = hn::MulAdd(left, right[j], sums[i][j]);
        }
    }
    for (std::size_t i = 0; i < I; ++i)
        for (std::size_t j = 0; j < J; ++j)
            hn::StoreU(sums[i][j], d, out + i * outStride + j * lanes);
}

void columnProducts(const RowBlock& a, const double* b, std::size_t depth, double* out,
                    std::size_t outStride) {
    constexpr std::size_t vectors = 3;
    const std::size_t step = vectors * hn::Lanes(Tag());
    for (std::size_t f = 0; f < lanesOfFunctions; f += step) {
        std::size_t i = 0;
        for (; i + 4 <= a.rows; i += 4)
            columnTile<4, vectors>(a.data + i * a.stride, a.stride, b + f, depth,
                                   out + i * outStride + f, outStride);
        for (; i < a.rows; ++i)
            columnTile<1, vectors>(a.data + i * a.stride, a.stride, b + f, depth,
                                   out + i * outStride + f, outStride);
    }
}

/// Two by two, a full cache line of every row at a time.
void interleave(const double* rows, std::size_t functions, std::size_t stride, std::size_t count,
                double* out) {
    constexpr std::size_t line = 8;
    for (std::size_t p = 0; p < count; p += line) {
        const std::size_t end = p + line < count ? p + line : count;
        for (std::size_t f = 0; f < lanesOfFunctions; f += 2) {
            const double *first = rows + f * stride, *second = first + stride;
            double* to = out + f;
            std::size_t q = p;
#if HWY_TARGET != HWY_SCALAR
            const hn::FixedTag<double, 2> d;
            if (f + 1 < functions) {
                for (; q + 2 <= end; q += 2) {
                    const auto a = hn::LoadU(d, first + q), b = hn::LoadU(d, second + q);
                    hn::StoreU(hn::InterleaveLower(d, a, b), d, to + q * lanesOfFunctions);
                    hn::StoreU(hn::InterleaveUpper(d, a, b), d, to + (q + 1) * lanesOfFunctions);
                }
            }
#endif
            for (; q < end; ++q) {
                to[q * lanesOfFunctions] = f < functions ? first[q] : 0.0;
                to[q * lanesOfFunctions + 1] = f + 1 < functions ? second[q] : 0.0;
            }
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
    for (std::size_t quadrant = 0; quadrant < ring.quadrants; ++quadrant) {
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

/// `load` and `store` take what is left at the end of the quadrant with a mask.
template <bool Half, class Load, class Store>
HWY_INLINE Vec foldOnce(const double* values, std::size_t count, std::size_t k,
                        const QuadrantFold& out, Vec squares, Load load, Store store) {
    const Vec first = load(values + k), second = load(values + count + k);
    squares = hn::MulAdd(first, first, hn::MulAdd(second, second, squares));
    if constexpr (Half) {
        store(hn::Add(first, second), out.c0 + k);
        store(hn::Sub(first, second), out.c1 + k);
    } else {
        const Vec third = load(values + 2 * count + k), fourth = load(values + 3 * count + k);
        squares = hn::MulAdd(third, third, hn::MulAdd(fourth, fourth, squares));
        const Vec even = hn::Add(first, third), odd = hn::Sub(first, third);
        const Vec evenBehind = hn::Add(second, fourth), oddBehind = hn::Sub(second, fourth);
        store(hn::Add(even, evenBehind), out.c0 + k);
        store(hn::Sub(even, evenBehind), out.c1 + k);
        store(hn::Add(odd, oddBehind), out.s1 + k);
        store(hn::Sub(odd, oddBehind), out.s0 + k);
    }
    return squares;
}

template <bool Half>
double fold(const double* values, std::size_t count, const QuadrantFold& out) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    Vec squares = hn::Zero(d);
    std::size_t k = 0;
    for (; k + lanes <= count; k += lanes)
        squares = foldOnce<Half>(
            values, count, k, out, squares, [&](const double* from) { return hn::LoadU(d, from); },
            [&](Vec v, double* to) { hn::StoreU(v, d, to); });
    if (k < count) {
        const auto mask = hn::FirstN(d, count - k);
        squares = foldOnce<Half>(
            values, count, k, out, squares,
            [&](const double* from) { return hn::MaskedLoad(mask, d, from); },
            [&](Vec v, double* to) { hn::BlendedStore(v, mask, d, to); });
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
}  // namespace hshfit
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit {

HWY_EXPORT(rowProducts);
HWY_EXPORT(columnProducts);
HWY_EXPORT(ringDirections);
HWY_EXPORT(interleave);
HWY_EXPORT(foldMany);
HWY_EXPORT(foldWhole);
HWY_EXPORT(foldHalf);

void addRowProducts(RowBlock a, RowBlock b, std::size_t depth, double* out, std::size_t outStride) {
    HWY_DYNAMIC_DISPATCH(rowProducts)(a, b, depth, out, outStride);
}

void addColumnProducts(RowBlock a, const double* b, std::size_t depth, double* out,
                       std::size_t outStride) {
    HWY_DYNAMIC_DISPATCH(columnProducts)(a, b, depth, out, outStride);
}

void fillRing(const RingDirections& ring, double sinTheta, double cosTheta, double* x, double* y,
              double* z) {
    HWY_DYNAMIC_DISPATCH(ringDirections)(ring, sinTheta, cosTheta, x, y, z);
}

void interleaveFunctions(const double* rows, std::size_t functions, std::size_t stride,
                         std::size_t count, double* out) {
    HWY_DYNAMIC_DISPATCH(interleave)(rows, functions, stride, count, out);
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

}  // namespace hshfit
#endif  // HWY_ONCE
