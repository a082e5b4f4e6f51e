#include <hshfit/rotation/internal/short_bands.h>

#include <hshfit/vector_targets.h>

#include <algorithm>
#include <utility>

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/rotation/internal/short_bands.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/vectors-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline rotation {
namespace kernels::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
namespace shared = bases::kernels::HWY_NAMESPACE;
using Tag = shared::Wide<double>;
using V = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

HWY_INLINE V set(double value) {
    return hn::Set(Tag(), value);
}

/// Cosines and sines of multiples of one angle a lane, [m], m = 1 .. shortBands - 1.
struct Phases {
    V cosine[shortBands], sine[shortBands];

    HWY_INLINE void fill(V c, V s, int bands) {
        cosine[1] = c;
        sine[1] = s;
        for (int m = 2; m < bands; ++m) {
            const V last = cosine[m - 1];
            cosine[m] = hn::NegMulAdd(sine[m - 1], s, hn::Mul(last, c));
            sine[m] = hn::MulAdd(sine[m - 1], c, hn::Mul(last, s));
        }
    }
};

/// A function that is no more than its expansion over a pack: every step at compile time.
template <int columns, int step, std::size_t... j>
HWY_INLINE V rowTimes(const double* k, const V* in, std::index_sequence<j...>) {
    V sum = hn::Mul(set(k[0]), in[0]);
    ((sum = j == 0 ? sum : hn::MulAdd(set(k[j * step]), in[2 * j], sum)), ...);
    return sum;
}

/// out[2 i] = sum of k[i columns + j] in[2 j], or with k transposed.
template <int rows, int columns, bool transposed, std::size_t... i>
HWY_INLINE void timesRows(const double* k, const V* in, V* out, std::index_sequence<i...>) {
    if constexpr (transposed)
        ((out[2 * i] = rowTimes<rows, columns>(k + i, in, std::make_index_sequence<rows>())), ...);
    else
        ((out[2 * i] =
              rowTimes<columns, 1>(k + i * columns, in, std::make_index_sequence<columns>())),
         ...);
}

template <int rows, int columns>
HWY_INLINE void times(const double* k, const V* in, V* out) {
    if constexpr (rows > 0 && columns > 0)
        timesRows<rows, columns, false>(k, in, out, std::make_index_sequence<rows>());
}
template <int rows, int columns>
HWY_INLINE void timesTransposed(const double* k, const V* in, V* out) {
    if constexpr (rows > 0 && columns > 0)
        timesRows<rows, columns, true>(k, in, out, std::make_index_sequence<columns>());
}

/// One band: cosines [m] and sines [m].
template <int l>
struct Band {
    V c[l + 1], s[l + 1];

    template <std::size_t... k>
    HWY_INLINE void load(const double* at, std::index_sequence<k...>) {
        // Slots of a band are m = -l .. l, a vector each.
        ((c[k] = hn::Load(Tag(), at + (l + k) * lanes)), ...);
        ((s[k] = hn::Load(Tag(), at + (l - k) * lanes)), ...);
    }
    template <std::size_t... k>
    HWY_INLINE void store(double* at, std::index_sequence<k...>) const {
        ((hn::Store(c[k], Tag(), at + (l + k) * lanes)), ...);
        ((k > 0 ? hn::Store(s[k], Tag(), at + (l - k) * lanes) : void()), ...);
    }

    /// *this = J from.
    HWY_INLINE void exchange(const double* k, const Band& from) {
        constexpr int h = l / 2;
        if constexpr (l % 2 == 0) {
            times<h + 1, h + 1>(k, from.c, c);
            times<h, h>(k + (h + 1) * (h + 1), from.s + 1, s + 1);
            const double* mixed = k + (h + 1) * (h + 1) + h * h;
            times<h, h>(mixed, from.c + 1, s + 2);
            timesTransposed<h, h>(mixed, from.s + 2, c + 1);
        } else {
            times<h + 1, h + 1>(k, from.c + 1, c + 1);
            times<h, h>(k + (h + 1) * (h + 1), from.s + 2, s + 2);
            const double* mixed = k + (h + 1) * (h + 1) + h * h;
            times<h + 1, h + 1>(mixed, from.c, s + 1);
            timesTransposed<h + 1, h + 1>(mixed, from.s + 1, c);
        }
    }
};

struct AllPhases {
    Phases alpha, beta, gamma;
};

// A step is made for all bands before the next one, so that there is always work that does not wait
// for the last result. Blocks are [slot][lane].

/// Bands 1 .. bands - 1 about z, by the angle of `phases` or, `back`, by its opposite.
template <bool back>
HWY_INLINE void turnAll(const Phases& phases, int bands, double* block) {
    const Tag tag;
    for (int m = 1; m < bands; ++m) {
        const V cosine = phases.cosine[m], sine = phases.sine[m];
        for (int l = m; l < bands; ++l) {
            double* const upper = block + static_cast<std::size_t>(l * (l + 1) + m) * lanes;
            double* const lower = block + static_cast<std::size_t>(l * (l + 1) - m) * lanes;
            const V a = hn::Load(tag, upper), b = hn::Load(tag, lower);
            const V left = hn::Mul(cosine, a), right = hn::Mul(cosine, b);
            hn::Store(back ? hn::MulAdd(sine, b, left) : hn::NegMulAdd(sine, b, left), tag, upper);
            hn::Store(back ? hn::NegMulAdd(sine, a, right) : hn::MulAdd(sine, a, right), tag,
                      lower);
        }
    }
}

/// Bands l .. bands - 1 times J.
template <int l>
HWY_INLINE void exchangeAll(const double* table, int bands, double* block) {
    if constexpr (l < shortBands) {
        if (l >= bands) return;
        constexpr auto all = std::make_index_sequence<l + 1>();
        Band<l> band, next;
        band.load(block + l * l * lanes, all);
        next.exchange(table + ShortTable::offset(l), band);
        next.store(block + l * l * lanes, all);
        exchangeAll<l + 1>(table, bands, block);
    }
}

/// Vectors `in[i]`, i < lanes, slot by slot to block[slot][i].
HWY_INLINE void gather(const double* const* in, std::size_t slots, double* block) {
    if (slots < lanes || lanes == 1) {
        for (std::size_t slot = 0; slot < slots; ++slot)
            for (std::size_t i = 0; i < lanes; ++i) block[slot * lanes + i] = in[i][slot];
        return;
    }
    for (std::size_t slot = 0; slot < slots; slot += lanes) {
        const std::size_t from = std::min(slot, slots - lanes);
        V v[lanes];
        for (std::size_t i = 0; i < lanes; ++i) v[i] = hn::LoadU(Tag(), in[i] + from);
        shared::transpose(Tag(), v);
        for (std::size_t i = 0; i < lanes; ++i) hn::Store(v[i], Tag(), block + (from + i) * lanes);
    }
}

/// The turns of one rotation a lane, as Rotation::turns.
HWY_INLINE void phasesOf(const ShortBatch& batch, std::size_t first, AllPhases& phases) {
    const Tag tag;
    const double* matrices[lanes];
    for (std::size_t i = 0; i < lanes; ++i)
        matrices[i] =
            batch.rotations[std::min(first + i, batch.count - 1) / batch.channels].matrix().data();
    HWY_ALIGN double rows[9][lanes];
    gather(matrices, 9, rows[0]);
    const auto r = [&](std::size_t e) HWY_ATTR { return hn::Load(tag, rows[e]); };
    const V zero = hn::Zero(tag), one = hn::Set(tag, 1);
    // Scaled against underflow of the squares of tiny tilts.
    const V up = hn::Max(hn::Abs(r(2)), hn::Abs(r(5)));
    const auto tilted = hn::Gt(up, zero);
    const V scale = hn::IfThenElse(tilted, up, one);
    const V x = hn::Div(r(2), scale), y = hn::Div(r(5), scale);
    const V length = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
    const V over = hn::Div(one, hn::IfThenElse(tilted, length, one));
    const V ca = hn::IfThenElse(tilted, hn::Mul(x, over), one);
    const V sa = hn::IfThenElse(tilted, hn::Mul(y, over), zero);
    const V sg = hn::MulSub(ca, r(3), hn::Mul(sa, r(0)));
    const V cg = hn::MulSub(ca, r(4), hn::Mul(sa, r(1)));
    const V unit = hn::Div(one, hn::Sqrt(hn::MulAdd(sg, sg, hn::Mul(cg, cg))));
    const V sb = hn::IfThenElseZero(tilted, hn::Mul(length, scale)), cb = r(8);
    const V tilt = hn::Div(one, hn::Sqrt(hn::MulAdd(sb, sb, hn::Mul(cb, cb))));
    phases.alpha.fill(ca, sa, batch.bands);
    phases.beta.fill(hn::Mul(cb, tilt), hn::Mul(sb, tilt), batch.bands);
    phases.gamma.fill(hn::Mul(cg, unit), hn::Mul(sg, unit), batch.bands);
}

HWY_INLINE void scatter(const double* block, std::size_t slots, std::size_t valid,
                        double* const* out) {
    if (slots < lanes || lanes == 1) {
        for (std::size_t slot = 0; slot < slots; ++slot)
            for (std::size_t i = 0; i < valid; ++i) out[i][slot] = block[slot * lanes + i];
        return;
    }
    for (std::size_t slot = 0; slot < slots; slot += lanes) {
        const std::size_t from = std::min(slot, slots - lanes);
        V v[lanes];
        for (std::size_t i = 0; i < lanes; ++i) v[i] = hn::Load(Tag(), block + (from + i) * lanes);
        shared::transpose(Tag(), v);
        for (std::size_t i = 0; i < valid; ++i) hn::StoreU(v[i], Tag(), out[i] + from);
    }
}

/// Asks for the vectors of the next block, which would come in too late where they are not in the
/// cache: eight streams of a few lines each end before the machine has recognised them.
HWY_INLINE void fetchAhead(const ShortBatch& batch, std::size_t first, std::size_t slots) {
    constexpr std::size_t line = 64 / sizeof(double);
    for (std::size_t k = first; k < std::min(first + lanes, batch.count); ++k)
        for (std::size_t slot = 0; slot < slots; slot += line) {
            hwy::Prefetch(batch.in + k * batch.stride + slot);
            if (batch.out != batch.in) hwy::Prefetch(batch.out + k * batch.stride + slot);
        }
}

}  // namespace

void rotateAll(const ShortTable& table, const ShortBatch& batch) {
    const auto slots =
        static_cast<std::size_t>(batch.bands) * static_cast<std::size_t>(batch.bands);
    HWY_ALIGN double block[shortBands * shortBands * lanes];
    for (std::size_t first = 0; first < batch.count; first += lanes) {
        const std::size_t valid = std::min(lanes, batch.count - first);
        const double* in[lanes];
        double* out[lanes];
        for (std::size_t i = 0; i < lanes; ++i) {
            const std::size_t vector = first + std::min(i, valid - 1);
            in[i] = batch.in + vector * batch.stride;
            out[i] = batch.out + vector * batch.stride;
        }
        fetchAhead(batch, first + lanes, slots);
        AllPhases phases;
        phasesOf(batch, first, phases);
        gather(in, slots, block);
        turnAll<false>(phases.gamma, batch.bands, block);
        exchangeAll<1>(table.data(), batch.bands, block);
        turnAll<true>(phases.beta, batch.bands, block);
        exchangeAll<1>(table.data(), batch.bands, block);
        turnAll<false>(phases.alpha, batch.bands, block);
        scatter(block, slots, valid, out);
    }
}

}  // namespace kernels::HWY_NAMESPACE
}  // namespace hshfit::inline rotation
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline rotation {
namespace kernels {

HWY_EXPORT(rotateAll);

void rotateShort(const ShortTable& table, const ShortBatch& batch) {
    if (batch.count > 0) HWY_DYNAMIC_DISPATCH(rotateAll)(table, batch);
}

}  // namespace kernels
}  // namespace hshfit::inline rotation
#endif
