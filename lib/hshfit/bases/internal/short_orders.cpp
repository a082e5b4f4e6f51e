#include <hshfit/bases/internal/short_orders.h>

#include <hshfit/vector_targets.h>

#include <algorithm>
#include <numeric>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/bases/internal/short_orders.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/vectors-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {
namespace {

/// Inputs of the recurrences for a block of directions, one per lane.
template <class V>
struct Place {
    V s, u, x, y;
};

template <class D, class V = hn::Vec<D>>
HWY_INLINE Place<V> placeOf(D d, Front front, const double* x, const double* y, const double* z) {
    const V mu = loadReal(d, z), one = hn::Set(d, 1), zero = hn::Zero(d);
    const V px = loadReal(d, x), py = loadReal(d, y);
    if (front == Front::sphere) return {mu, one, px, py};
    if (front == Front::sphereSquared) return {hn::Mul(mu, mu), one, px, py};
    const V above = hn::Max(mu, zero), onePlus = hn::Add(above, one);
    V u = hn::IfThenElse(hn::Ge(mu, zero), one, zero), w, s;
    if (front == Front::chord) {
        s = hn::Sub(one, hn::Add(above, above));
        w = hn::Div(one, hn::Sqrt(onePlus));
    } else {
        s = hn::Sub(hn::Add(above, above), one);
        const V root = hn::Sqrt(hn::Div(above, onePlus));
        w = hn::Add(root, root);
        if (front == Front::rootHump) u = hn::Sqrt(above);
    }
    return {s, u, hn::Mul(px, w), hn::Mul(py, w)};
}

/// Takes the slots of a block in their order, and transposes and stores them once there is one for
/// every lane. `valid` lanes are written.
template <class D, bool bySlot>
struct Sink {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    static constexpr std::size_t n = lanesOf<D>;

    V pending[n];
    T* HWY_RESTRICT out;
    std::size_t stride;  ///< between directions or, bySlot, between slots

    HWY_INLINE Sink(T* to, std::size_t step) : out(to), stride(step) {}

    template <std::size_t slot>
    HWY_INLINE void take(V value) {
        const D d;
        if constexpr (bySlot) {
            hn::StoreU(value, d, out + slot * stride);
        } else {
            pending[slot % n] = value;
            if constexpr (slot % n == n - 1) {
                transpose(d, pending);
                storeAll<slot - (n - 1), 0>();
            }
        }
    }

    template <std::size_t slot, std::size_t lane>
    HWY_INLINE void storeAll() {
        hn::StoreU(pending[lane], D(), out + lane * stride + slot);
        if constexpr (lane + 1 < n) storeAll<slot, lane + 1>();
    }

    /// The slots of [end - end % n, end), which did not fill a vector.
    template <std::size_t end>
    HWY_INLINE void finish() {
        if constexpr (!bySlot && end % n != 0) {
            const D d;
            HWY_ALIGN T values[n * n];
            for (std::size_t i = 0; i < end % n; ++i) hn::Store(pending[i], d, values + i * n);
            for (std::size_t lane = 0; lane < n; ++lane)
                for (std::size_t i = 0; i < end % n; ++i)
                    out[lane * stride + (end - end % n) + i] = values[i * n + lane];
        }
    }
};

/// Row by row, unrolled at compile time. p[k % 2][m] is the k-th function of column m.
template <class D, int step, bool bySlot>
struct Rows {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;

    V p[2][shortOrders], re[shortOrders], im[shortOrders];
    const Place<V> place;
    const ShortTable<T>& table;
    Sink<D, bySlot> sink;

    HWY_INLINE Rows(const Place<V>& at, const ShortTable<T>& steps, T* out, std::size_t stride)
        : place(at), table(steps), sink(out, stride) {}

    /// p_{l,m} for m = m .. l.
    template <int l, int m>
    HWY_INLINE void column() {
        const D d;
        const auto& [a, b, c] = table.step[l * (l + 1) / 2 + m];
        constexpr int k = (l - m) / step;
        V& value = p[k % 2][m];
        if constexpr (l == m) {
            value = hn::Set(d, table.first[m]);
            if constexpr (m == 0) value = hn::Mul(value, place.u);
        } else if constexpr ((l - m) % step == 0) {
            const V factor = hn::MulAdd(hn::Set(d, a), place.s, hn::Set(d, b));
            if constexpr (k == 1) {
                value = factor;
                if constexpr (m == 0) value = hn::Mul(value, place.u);
            } else {
                V carried = hn::Set(d, c);
                if constexpr (k > 2)
                    carried = hn::Mul(carried, value);
                else if constexpr (m == 0)
                    carried = hn::Mul(carried, place.u);
                value = hn::MulAdd(factor, p[(k + 1) % 2][m], carried);
            }
        }
        if constexpr (m < l) column<l, m + 1>();
    }

    template <int l, int m>
    HWY_INLINE void emit() {
        constexpr std::size_t slot = l * (l + 1) + m;
        constexpr int column = m < 0 ? -m : m;
        const V& value = p[(l - column) / step % 2][column];
        if constexpr ((l - column) % step != 0)
            sink.template take<slot>(hn::Zero(D()));
        else if constexpr (m == 0)
            sink.template take<slot>(value);
        else
            sink.template take<slot>(hn::Mul(value, m < 0 ? im[column] : re[column]));
        if constexpr (m < l) emit<l, m + 1>();
    }

    template <int l>
    HWY_INLINE void row(int order) {
        if constexpr (l == 1) {
            re[1] = hn::Mul(place.x, place.u);
            im[1] = hn::Mul(place.y, place.u);
        } else if constexpr (l > 1) {
            re[l] = hn::NegMulAdd(im[l - 1], place.y, hn::Mul(re[l - 1], place.x));
            im[l] = hn::MulAdd(re[l - 1], place.y, hn::Mul(im[l - 1], place.x));
        }
        column<l, 0>();
        emit<l, -l>();
        if (order == l + 1)
            sink.template finish<(l + 1) * (l + 1)>();
        else if constexpr (l + 1 < shortOrders)
            row<l + 1>(order);
    }
};

/// The inputs of `valid` directions from `first` on; lanes beyond repeat the last one.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE Place<hn::Vec<D>> placeOfSome(const ShortJob<T>& job, std::size_t first,
                                         std::size_t valid) {
    constexpr std::size_t n = lanesOf<D>;
    const auto& [x, y, z, count] = job.directions;
    if (valid >= n) return placeOf(D(), job.front, x + first, y + first, z + first);
    double px[n], py[n], pz[n];
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t k = first + std::min(j, valid - 1);
        px[j] = x[k], py[j] = y[k], pz[j] = z[k];
    }
    return placeOf(D(), job.front, px, py, pz);
}

/// Whole vectors of directions straight to their places, [direction][slot] or, with `Slots`,
/// [slot][direction]; the rest through a copy.
template <class D, int step, bool Slots, class T = hn::TFromD<D>>
void straight(const ShortJob<T>& job) {
    constexpr std::size_t n = lanesOf<D>;
    const std::size_t count = job.directions.count;
    const auto slots = static_cast<std::size_t>(job.order * job.order);
    HWY_ALIGN T some[n * shortOrders * shortOrders];
    // Roots and quotients of the next block are under way while this one runs.
    auto next = placeOfSome<D>(job, 0, count);
    for (std::size_t k = 0; k < count; k += n) {
        const auto place = next;
        if (k + n < count) next = placeOfSome<D>(job, k + n, count - k - n);
        const bool whole = k + n <= count;
        T* const out = job.out + (Slots ? k : k * slots);
        Rows<D, step, Slots> rows(place, *job.table, whole ? out : some,
                                  !Slots ? slots : (whole ? count : n));
        rows.template row<0>(job.order);
        if (whole) continue;
        if constexpr (Slots)
            for (std::size_t i = 0; i < slots; ++i)
                std::copy_n(some + i * n, count - k, out + i * count);
        else
            std::copy_n(some, (count - k) * slots, out);
    }
}

/// Through a tile, so that every slot gets whole cache lines at once.
template <class D, int step, class T = hn::TFromD<D>>
void bySlotTiled(const ShortJob<T>& job) {
    constexpr std::size_t n = lanesOf<D>, width = 4 * n;
    const std::size_t count = job.directions.count;
    HWY_ALIGN T tile[width * shortOrders * shortOrders];
    for (std::size_t first = 0; first < count; first += width) {
        const std::size_t valid = std::min(width, count - first);
        for (std::size_t k = 0; k < valid; k += n) {
            Rows<D, step, true> rows(placeOfSome<D>(job, first + k, valid - k), *job.table,
                                     tile + k, width);
            rows.template row<0>(job.order);
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(job.order * job.order); ++i) {
            const T* from = tile + i * width;
            T* to = job.out + i * count + first;
            if (valid < width)
                std::copy_n(from, valid, to);
            else
                for (std::size_t k = 0; k < width; k += n)
                    hn::StoreU(hn::Load(D(), from + k), D(), to + k);
        }
    }
}

/// Whether so many slots fall into the same sets of a first-level cache (lines 4096 bytes apart
/// share one) that lines would be thrown out between the vectors that fill them.
template <class T>
bool slotsCollide(std::size_t slots, std::size_t count) {
    constexpr std::size_t period = 4096, line = 64, perSet = 4;
    const std::size_t places = period / std::gcd(count * sizeof(T), period);
    return slots > perSet * std::min(places, period / line);
}

/// One direction: the same operations on vectors of one lane, so that the result is the same.
template <int step, class T>
void oneDirection(const ShortJob<T>& job) {
    using D = Single<T>;
    const auto& [x, y, z, count] = job.directions;
    Rows<D, step, true> rows(placeOf(D(), job.front, x, y, z), *job.table, job.out, 1);
    rows.template row<0>(job.order);
}

template <int step, class T>
void tabulate(const ShortJob<T>& job) {
    if (job.directions.count == 1)
        oneDirection<step>(job);
    else if (job.bySlot &&
             slotsCollide<T>(static_cast<std::size_t>(job.order * job.order), job.directions.count))
        bySlotTiled<Wide<T>, step>(job);
    else if (job.bySlot)
        straight<Wide<T>, step, true>(job);
    else
        straight<Wide<T>, step, false>(job);
}

}  // namespace

void tabulateDouble(const ShortJob<double>& job) {
    job.step == 1 ? tabulate<1>(job) : tabulate<2>(job);
}

void tabulateFloat(const ShortJob<float>& job) {
    job.step == 1 ? tabulate<1>(job) : tabulate<2>(job);
}

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::bases::kernels {

HWY_EXPORT(tabulateDouble);
HWY_EXPORT(tabulateFloat);

void tabulateShort(const ShortJob<double>& job) {
    if (job.directions.count > 0) HWY_DYNAMIC_DISPATCH(tabulateDouble)(job);
}

void tabulateShort(const ShortJob<float>& job) {
    if (job.directions.count > 0) HWY_DYNAMIC_DISPATCH(tabulateFloat)(job);
}

}  // namespace hshfit::bases::kernels
#endif
