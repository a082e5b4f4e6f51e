#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/light/internal/picture_spectra.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/light/internal/real_transform-inl.h>
#include <hwy/aligned_allocator.h>

#include <algorithm>
#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline light {
namespace HWY_NAMESPACE {
namespace {

/// Values number first, first + step, …
template <int n, class Load, std::size_t... k>
HWY_INLINE void leaf(const Load& load, std::size_t first, std::size_t step, double* out,
                     std::index_sequence<k...>) {
    V v[n] = {load(first + step * reversed(k, n))...};
    transformInRegisters<n>(v);
    (hn::Store(v[k], Tag(), out + k * lanes), ...);
}

template <class Load>
void transform(const FourierPlan& plan, const Load& load, std::size_t first, std::size_t step,
               std::size_t n, double* out) {
    switch (n) {
        case 1:
            return leaf<1>(load, first, step, out, std::make_index_sequence<1>());
        case 2:
            return leaf<2>(load, first, step, out, std::make_index_sequence<2>());
        case 4:
            return leaf<4>(load, first, step, out, std::make_index_sequence<4>());
        case 8:
            return leaf<8>(load, first, step, out, std::make_index_sequence<8>());
        case 16:
            return leaf<16>(load, first, step, out, std::make_index_sequence<16>());
        default:
            break;
    }
    const Tag d;
    const std::size_t half = n / 2;
    transform(plan, load, first, 2 * step, half, out);
    transform(plan, load, first + step, 2 * step, half, out + half * lanes);
    const auto at = [&](std::size_t k) HWY_ATTR { return out + k * lanes; };
    const V a = hn::Load(d, at(0)), b = hn::Load(d, at(half));
    hn::Store(hn::Add(a, b), d, at(0));
    hn::Store(hn::Sub(a, b), d, at(half));
    hn::Store(hn::Neg(hn::Load(d, at(half + half / 2))), d, at(half + half / 2));
    const double* w = plan.twiddles.data() + n / 2;
    for (std::size_t k = 1; k < half / 2; ++k) {
        V evenRe = hn::Load(d, at(k)), evenIm = hn::Load(d, at(half - k));
        V oddRe = hn::Load(d, at(half + k)), oddIm = hn::Load(d, at(n - k));
        butterfly(set(w[2 * k]), set(w[2 * k + 1]), evenRe, evenIm, oddRe, oddIm);
        hn::Store(evenRe, d, at(k));
        hn::Store(evenIm, d, at(half - k));
        hn::Store(oddRe, d, at(half + k));
        hn::Store(oddIm, d, at(n - k));
    }
}

/// The transforms of values a, a + count / base, … for all a: [a][base][lane].
template <class Load>
HWY_INLINE void transformAll(const FourierPlan& plan, const Load& load, double* terms) {
    const std::size_t parts = plan.count / plan.base;
    for (std::size_t a = 0; a < parts; ++a)
        transform(plan, load, a, parts, plan.base, terms + a * plan.base * lanes);
}

/// Sums over the values of cos(x) and sin(x), x = 2 pi m (4 j + shift) / (4 count), for `many`
/// numbers m.
template <int many>
HWY_INLINE void sumsOf(const FourierPlan& plan, const double* terms, const std::size_t* m,
                       std::size_t shift, V* cosine, V* sine) {
    const Tag d;
    const std::size_t base = plan.base, period = 4 * plan.count;
    std::size_t at[many], step[many], re[many], im[many];
    double sign[many];
    for (int i = 0; i < many; ++i) {
        const std::size_t k = m[i] % base, near = std::min(k, base - k);
        at[i] = m[i] * shift % period;
        step[i] = m[i] * 4 % period;
        re[i] = near * lanes;
        im[i] = (near == 0 ? 0 : base - near) * lanes;
        sign[i] = near == 0 || 2 * near == base ? 0 : k == near ? 1 : -1;
        cosine[i] = sine[i] = hn::Zero(d);
    }
    for (std::size_t a = 0; a < plan.count / base; ++a, terms += base * lanes)
        for (int i = 0; i < many; ++i) {
            const double c = plan.waves[at[i]];
            const double s =
                plan.waves[at[i] >= plan.count ? at[i] - plan.count : at[i] + 3 * plan.count];
            const V x = hn::Load(d, terms + re[i]), y = hn::Load(d, terms + im[i]);
            cosine[i] = hn::MulAdd(set(c), x, hn::MulAdd(set(sign[i] * s), y, cosine[i]));
            sine[i] = hn::MulAdd(set(s), x, hn::NegMulAdd(set(sign[i] * c), y, sine[i]));
            at[i] += step[i];
            if (at[i] >= period) at[i] -= period;
        }
}

/// Pixels of one channel, a row a lane, [column][R, G, B][lane].
struct PixelLoad {
    const float* from;
    HWY_INLINE V operator()(std::size_t j) const {
        return hn::PromoteTo(Tag(), hn::LoadU(FloatTag(), from + 3 * j * lanes));
    }
};

struct ValueLoad {
    const double* from;
    HWY_INLINE V operator()(std::size_t j) const { return hn::Load(Tag(), from + j * lanes); }
};

/// `lanes` rows of `count` values to [value][lane]; `rows` may repeat.
HWY_INLINE void toLanes(const float* const* rows, std::size_t count, float* out) {
    const FloatTag d;
    std::size_t k = 0;
    for (; k + lanes <= count; k += lanes) {
        hn::Vec<FloatTag> v[lanes];
        for (std::size_t i = 0; i < lanes; ++i) v[i] = hn::LoadU(d, rows[i] + k);
        shared::transpose(d, v);
        for (std::size_t i = 0; i < lanes; ++i) hn::StoreU(v[i], d, out + (k + i) * lanes);
    }
    for (; k < count; ++k)
        for (std::size_t i = 0; i < lanes; ++i) out[k * lanes + i] = rows[i][k];
}

struct LongBuffers {
    hwy::AlignedFreeUniquePtr<float[]> pixels;
    hwy::AlignedFreeUniquePtr<double[]> terms, sums;
    std::size_t size = 0, columns = 0;
    void hold(std::size_t values, std::size_t all) {
        if (values > size) {
            pixels = hwy::AllocateAligned<float>(3 * values * lanes);
            terms = hwy::AllocateAligned<double>(values * lanes);
            size = values;
        }
        if (all > columns) sums = hwy::AllocateAligned<double>((columns = all) * lanes);
    }
};

}  // namespace

void longRows(const FourierPlan& plan, const SpectrumColumns& columns, const float* rows,
              std::size_t count, double* out, double* squares) {
    constexpr int together = 4;
    const Tag d;
    const std::size_t width = plan.count, all = columns.all;
    // Kept between calls: fresh pages for each would cost as much as the transforms.
    thread_local LongBuffers buffers;
    buffers.hold(std::max(width, group), all);
    double* const sums = buffers.sums.get();
    std::fill(sums, sums + all * lanes, 0.0);
    for (std::size_t first = 0; first < count; first += lanes) {
        const std::size_t valid = std::min(lanes, count - first);
        const float* starts[lanes];
        for (std::size_t i = 0; i < lanes; ++i)
            starts[i] = rows + (first + std::min(i, valid - 1)) * 3 * width;
        toLanes(starts, 3 * width, buffers.pixels.get());
        for (std::size_t c = 0; c < 3; ++c) {
            const PixelLoad load{buffers.pixels.get() + c * lanes};
            // Several sums, since each addition waits for the last.
            V some[together] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
            for (std::size_t j = 0; j < width; ++j) {
                const V value = load(j);
                some[j % together] = hn::MulAdd(value, value, some[j % together]);
            }
            const V square = hn::Add(hn::Add(some[0], some[1]), hn::Add(some[2], some[3]));
            HWY_ALIGN double each[lanes];
            hn::Store(square, d, each);
            for (std::size_t i = 0; i < valid; ++i) squares[3 * (first + i) + c] = each[i];
            transformAll(plan, load, buffers.terms.get());
            for (std::size_t m = 0; m < columns.order; m += together) {
                std::size_t which[together];
                V cosine[together], sine[together];
                for (std::size_t i = 0; i < together; ++i)
                    which[i] = std::min(m + i, columns.order - 1);
                sumsOf<together>(plan, buffers.terms.get(), which, 2, cosine, sine);
                for (std::size_t i = 0; i < together; ++i) {
                    hn::Store(cosine[i], d, sums + columns.of(which[i], false) * lanes);
                    hn::Store(sine[i], d, sums + columns.of(which[i], true) * lanes);
                }
            }
            for (std::size_t column = 0; column < all; column += lanes) {
                V v[lanes];
                for (std::size_t i = 0; i < lanes; ++i)
                    v[i] = hn::Load(d, sums + (column + i) * lanes);
                shared::transpose(d, v);
                for (std::size_t i = 0; i < valid; ++i)
                    hn::StoreU(v[i], d, out + (3 * (first + i) + c) * all + column);
            }
        }
    }
}

void columnSums(const FourierPlan& plan, bool sine, const double* in, std::size_t stride,
                std::size_t degrees, const double* factors, double* out) {
    const Tag d;
    const std::size_t n = plan.count;
    thread_local hwy::AlignedFreeUniquePtr<double[]> values, terms;
    thread_local std::size_t size = 0;
    if (n > size) {
        values = hwy::AllocateAligned<double>(n * lanes);
        terms = hwy::AllocateAligned<double>(n * lanes);
        size = n;
    }
    for (std::size_t i = 0; i < group; i += lanes) {
        // Even rows, then odd rows from the last: the transform of n values in this order has their
        // cosine sums at half steps (Makhoul 1980). Sine sum j is cosine sum n - j of the values
        // with alternating signs.
        for (std::size_t r = 0; r < n; ++r) {
            const V value = hn::LoadU(d, in + r * stride + i);
            const std::size_t to = r % 2 == 0 ? r / 2 : n - 1 - r / 2;
            hn::Store(sine && r % 2 == 1 ? hn::Neg(value) : value, d, values.get() + to * lanes);
        }
        const ValueLoad load{values.get()};
        transformAll(plan, load, terms.get());
        for (std::size_t j = 0; j < degrees; ++j) {
            const std::size_t m = sine ? n - j : j;
            V cosines, sines;
            sumsOf<1>(plan, terms.get(), &m, 1, &cosines, &sines);
            if (sine && j == 0) cosines = hn::Zero(d);
            hn::StoreU(hn::Mul(set(factors[j]), cosines), d, out + j * stride + i);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline light
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline light {
HWY_EXPORT(longRows);
HWY_EXPORT(columnSums);

FourierPlan::FourierPlan(std::size_t values) : count(values), base(1) {
    constexpr std::size_t mostBase = 4096;
    while (base < mostBase && count % (2 * base) == 0) base *= 2;
    constexpr double turn = 2 * std::numbers::pi;
    twiddles.resize(std::max<std::size_t>(base, 2));
    for (std::size_t n = 4; n <= base; n *= 2)
        for (std::size_t k = 0; k < n / 4; ++k) {
            const double angle = turn * static_cast<double>(k) / static_cast<double>(n);
            twiddles[n / 2 + 2 * k] = std::cos(angle);
            twiddles[n / 2 + 2 * k + 1] = std::tan(angle);
        }
    waves = wavesOf(count);
}

std::vector<double> wavesOf(std::size_t quarter) {
    std::vector<double> waves(4 * quarter);
    for (std::size_t k = 0; k <= quarter; ++k) {
        const double value = k == quarter ? 0
                                          : std::cos(std::numbers::pi / 2 * static_cast<double>(k) /
                                                     static_cast<double>(quarter));
        waves[k] = waves[(4 * quarter - k) % (4 * quarter)] = value;
        waves[2 * quarter - k] = waves[2 * quarter + k] = -value;
    }
    return waves;
}

void pictureSpectra(const FourierPlan& plan, const SpectrumColumns& columns, const float* rows,
                    std::size_t count, double* out, double* squares) {
    HWY_DYNAMIC_DISPATCH(longRows)(plan, columns, rows, count, out, squares);
}

void colatitudeSums(const FourierPlan& plan, bool sine, const double* in, std::size_t stride,
                    std::size_t degrees, const double* factors, double* out) {
    HWY_DYNAMIC_DISPATCH(columnSums)(plan, sine, in, stride, degrees, factors, out);
}

}  // namespace hshfit::inline light
#endif  // HWY_ONCE
