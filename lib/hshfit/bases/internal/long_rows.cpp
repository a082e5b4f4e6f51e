// Orders above the short ones, direction by direction: columns m in lanes, so that a row of
// functions is stored as it is and one direction keeps whole vectors busy.

#include <hshfit/bases/internal/long_orders.h>

#include <hshfit/vector_targets.h>

#include <algorithm>
#include <utility>

#include <hwy/aligned_allocator.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/bases/internal/long_rows.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/internal/columns-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {
namespace {

/// Directions evaluated together, which share the loads of the steps.
constexpr std::size_t together = 4;

/// The layout of a team's state: for every vector of n columns and every direction the arrays p,
/// d, re, im of n values each; then `sparse` re and im for rows of odd l (the first two being for
/// rows of even l, with 0 where the basis lacks a function), then `careful` the exponents.
constexpr std::size_t arraysOf(bool sparse, bool careful) {
    return 4 + (sparse ? 2 : 0) + (careful ? 1 : 0);
}

/// The run of a team. `flipped`: from t = -1 with the steps from t = 1 of a symmetric weight,
/// whence every step changes sign. `sparse`: functions with odd l - m are 0. `once`: one step
/// serves two rows. `careful`: columns may start below the range.
template <bool flipped_, bool sparse_, bool once_, bool careful_>
struct Way {
    static constexpr bool flipped = flipped_, sparse = sparse_, once = once_, careful = careful_;
};

template <class D, std::size_t directions, class Way>
class Passes {
public:
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    static constexpr std::size_t n = lanesOf<D>;
    static constexpr std::size_t step = arraysOf(Way::sparse, Way::careful) * n;

    HWY_INLINE Passes(std::size_t functions, const T* distances, T* const* to) : order(functions) {
        for (std::size_t v = 0; v < directions; ++v) distance[v] = distances[v], out[v] = to[v];
    }

    HWY_INLINE void run(const StepRows<T>& steps, T* state) {
        for (std::size_t b = 0; b < steps.blocks(); ++b) {
            const std::size_t m0 = b * StepRows<T>::columns, width = steps.width(b);
            T* const first = state + m0 * (directions * step / n);
            const T* row = steps.block(b);
            std::size_t l = m0;
            for (; l + 1 < order; l += 2) pass<2>(l, m0, width, row, first);
            if (l < order) pass<1>(l, m0, width, row, first);
        }
    }

private:
    template <int rows>
    HWY_INLINE void pass(std::size_t l, std::size_t m0, std::size_t width, const T*& row,
                         T* state) {
        const T* next = Way::once || rows == 1 ? row : row + 3 * width;
        const std::size_t full = std::min((l + 1 - m0) / n * n, width);
        for (std::size_t j = 0; j < full; j += n, state += directions * step)
            group<rows, n, n>(l, m0 + j, row + j, next + j, width, state);
        if (full < width && m0 + full <= l + rows - 1)
            edge<rows, n == 1 ? 0 : 1>(l, m0 + full, row + full, next + full, width, state);
        row = next + 3 * width;
    }

    /// The columns of row l that end within a vector: as l - m0 is even, an odd number of them.
    template <int rows, std::size_t inside>
    HWY_INLINE void edge(std::size_t l, std::size_t m, const T* one, const T* two,
                         std::size_t width, T* state) {
        if (inside + 2 > n || l + 1 - m == inside)
            group<rows, inside, inside + 1>(l, m, one, two, width, state);
        else if constexpr (inside + 2 <= n)
            edge<rows, inside + 2>(l, m, one, two, width, state);
    }

    /// Columns m .. m + n - 1 of row l and, with two rows, l + 1, of which the first `inside` and
    /// `insideNext` are functions.
    template <int rows, std::size_t inside, std::size_t insideNext>
    HWY_INLINE void group(std::size_t l, std::size_t m, const T* one, const T* two,
                          std::size_t width, T* state) const {
        const D tag;
        const V slope = hn::Load(tag, one), ratio = hn::Load(tag, one + width),
                carry = hn::Load(tag, one + 2 * width);
        const V slopeNext = hn::Load(tag, two), ratioNext = hn::Load(tag, two + width),
                carryNext = hn::Load(tag, two + 2 * width);
        for (std::size_t v = 0; v < directions; ++v, state += step) {
            V p = hn::Load(tag, state), d = hn::Load(tag, state + n), e = hn::Zero(tag);
            if constexpr (Way::careful) e = hn::Load(tag, state + (step - n));
            const V re = hn::Load(tag, state + 2 * n), im = hn::Load(tag, state + 3 * n);
            const V y = hn::Set(tag, distance[v]);
            const V value = advance(slope, ratio, carry, y, p, d, e);
            T* const centre = out[v] + l * (l + 1);
            emit<inside>(centre, m, hn::Mul(value, re), hn::Mul(value, im));
            if constexpr (rows == 2) {
                V reNext = re, imNext = im, valueNext = value;
                if constexpr (Way::sparse) {
                    reNext = hn::Load(tag, state + 4 * n);
                    imNext = hn::Load(tag, state + 5 * n);
                }
                if constexpr (!Way::once)
                    valueNext = advance(slopeNext, ratioNext, carryNext, y, p, d, e);
                emit<insideNext>(centre + 2 * (l + 1), m, hn::Mul(valueNext, reNext),
                                 hn::Mul(valueNext, imNext));
            }
            hn::Store(p, tag, state);
            hn::Store(d, tag, state + n);
            if constexpr (Way::careful) hn::Store(e, tag, state + (step - n));
        }
    }

    static HWY_INLINE V advance(V slope, V ratio, V carry, V y, V& p, V& d, V& e) {
        const V steep = hn::Mul(slope, y), carried = hn::Mul(carry, d);
        if constexpr (Way::flipped) {
            d = hn::Neg(hn::MulAdd(steep, p, carried));
            p = hn::NegMulAdd(ratio, p, d);
        } else {
            d = hn::MulAdd(steep, p, carried);
            p = hn::MulAdd(ratio, p, d);
        }
        if constexpr (Way::careful) {
            if (!hn::AllFalse(D(), hn::Lt(e, hn::Zero(D())))) {
                wakeUp(D(), p, d, e);
                return valueOf(D(), p, e);
            }
        }
        return p;
    }

    /// Functions (l, m) and (l, -m) of the first `inside` of the lanes' columns; `centre` is the
    /// slot of (l, 0).
    template <std::size_t inside>
    static HWY_INLINE void emit(T* centre, std::size_t m, V plus, V minus) {
        if constexpr (inside > 0) {
            const D tag;
            if constexpr (Way::sparse) {  // no negative zeros
                plus = hn::Add(plus, hn::Zero(tag));
                minus = hn::Add(minus, hn::Zero(tag));
            }
            storeLast<inside>(tag, hn::Reverse(tag, minus), centre - (m + inside - 1));
            storeFirst<inside>(tag, plus, centre + m);
        }
    }

    const std::size_t order;
    T distance[directions];
    T* out[directions];
};

/// Splits the directions of a batch into chunks and sorts each chunk into teams.
template <class T>
class Tabulation {
public:
    Tabulation(const Recurrences<T>& recurrences, std::size_t count, T* to)
        : r(recurrences),
          order(static_cast<std::size_t>(r.order)),
          sparse(r.evenOnly || r.bandStep == 2),
          out(to) {
        columns = (order + StepRows<T>::group - 1) / StepRows<T>::group * StepRows<T>::group;
        const std::size_t need =
            columns * arraysOf(sparse, true) * (count < together ? 1 : together);
        if (need > smallMemory) large = hwy::AllocateAligned<T>(need);
        state = large ? large.get() : small;
    }

    static constexpr std::size_t chunk = 64;

    /// Directions first .. first + count - 1, at most `chunk`.
    void run(DirectionBatch directions, std::size_t first, std::size_t count) {
        if (count == 1)
            placeAll<Single<double>>(directions, first, count);
        else
            placeAll<Wide<double>>(directions, first, count);
        // Directions with the same starting end and range are evaluated together.
        std::size_t members[4][chunk], counts[4] = {0, 0, 0, 0};
        for (std::size_t k = 0; k < count; ++k) {
            const std::size_t kind = (awake[k] > 0 ? 0 : 2) + (far[k] > 0 ? 1 : 0);
            members[kind][counts[kind]++] = k;
        }
        T* const base = out + first * order * order;
        for (std::size_t kind = 0; kind < 4; ++kind) {
            std::size_t i = 0;
            for (; i + together <= counts[kind]; i += together)
                kind < 2 ? runTeam<together, false>(members[kind] + i, base)
                         : runTeam<together, true>(members[kind] + i, base);
            for (; i < counts[kind]; ++i)
                kind < 2 ? runTeam<1, false>(members[kind] + i, base)
                         : runTeam<1, true>(members[kind] + i, base);
        }
    }

private:
    static constexpr std::size_t n = lanesOf<Wide<T>>, smallMemory = 8192 / sizeof(T);

    template <class W>
    void placeAll(DirectionBatch directions, std::size_t first, std::size_t count) {
        constexpr std::size_t lanes = lanesOf<W>;
        const W wide;
        for (std::size_t j = 0; j < count; j += lanes) {
            HWY_ALIGN double x[lanes], y[lanes], z[lanes];
            for (std::size_t i = 0; i < lanes; ++i) {
                const std::size_t k = first + std::min(j + i, count - 1);
                x[i] = directions.x[k], y[i] = directions.y[k], z[i] = directions.z[k];
            }
            const Place<W> place =
                placeAt(wide, r, hn::Load(wide, x), hn::Load(wide, y), hn::Load(wide, z));
            hn::Store(place.distance, wide, distance + j);
            hn::Store(place.far, wide, far + j);
            hn::Store(place.factor, wide, factor + j);
            hn::Store(place.weight, wide, weight + j);
            hn::Store(place.c, wide, c + j);
            hn::Store(place.s, wide, s + j);
            const auto inRange = staysInRange<T>(wide, place.factor, place.weight, r.order);
            hn::Store(hn::IfThenElse(inRange, hn::Set(wide, 1), hn::Zero(wide)), wide, awake + j);
        }
    }

    template <std::size_t directions, bool careful>
    void runTeam(const std::size_t* members, T* base) {
        const bool fromOther = far[members[0]] > 0, flipped = r.symmetric && fromOther;
        start<directions, careful>(members, flipped);
        T distances[directions];
        T* to[directions];
        for (std::size_t v = 0; v < directions; ++v) {
            distances[v] = static_cast<T>(distance[members[v]]);
            to[v] = base + members[v] * order * order;
        }
        const StepRows<T>& rows = *r.rows[r.symmetric ? 0 : fromOther];
        if (r.bandStep == 2)
            pass<directions, Way<false, true, true, careful>>(rows, distances, to);
        else if (r.evenOnly && flipped)
            pass<directions, Way<true, true, false, careful>>(rows, distances, to);
        else if (r.evenOnly)
            pass<directions, Way<false, true, false, careful>>(rows, distances, to);
        else if (flipped)
            pass<directions, Way<true, false, false, careful>>(rows, distances, to);
        else
            pass<directions, Way<false, false, false, careful>>(rows, distances, to);
    }

    template <std::size_t directions, class Way>
    HWY_NOINLINE void pass(const StepRows<T>& rows, const T* distances, T* const* to) {
        Passes<Wide<T>, directions, Way>(order, distances, to).run(rows, state);
    }

    /// Starts and azimuths of a team's directions into its state.
    template <std::size_t directions, bool careful>
    void start(const std::size_t* members, bool flipped) {
        using W = hn::CappedTag<double, directions>;
        constexpr std::size_t lanes = lanesOf<W>;
        const W wide;
        const auto zero = hn::Zero(wide);
        const std::size_t step = arraysOf(sparse, careful) * n;
        for (std::size_t j = 0; j < directions; j += lanes) {
            HWY_ALIGN double values[4][lanes];
            for (std::size_t i = 0; i < lanes; ++i) {
                const std::size_t k = members[j + i];
                values[0][i] = factor[k], values[1][i] = weight[k];
                values[2][i] = c[k], values[3][i] = s[k];
            }
            Starts<T, W> starts(r,
                                {zero, zero, hn::Load(wide, values[0]), hn::Load(wide, values[1]),
                                 hn::Load(wide, values[2]), hn::Load(wide, values[3])});
            for (std::size_t m = 0; m < columns; m += 4) {
                if (m < order)
                    starts.next(static_cast<int>(m));
                else
                    starts.end();
                // A column is held m + 1 times before its first step, which changes its sign.
                for (std::size_t i = 0; i < 4 && flipped; i += 2)
                    starts.p[i] = hn::Neg(starts.p[i]);
                scatter(starts.p, state, directions, step, j, m);
                scatter(starts.a, state + 2 * n, directions, step, j, m);
                scatter(starts.b, state + 3 * n, directions, step, j, m);
                if constexpr (careful)
                    scatter(starts.e, state + (step - n), directions, step, j, m);
            }
        }
        T* at = state;
        for (std::size_t i = 0; i < columns / n * directions; ++i, at += step) {
            const Wide<T> tag;
            hn::Store(hn::Zero(tag), tag, at + n);
            if (sparse) separate(at + 2 * n, i / directions * n);
        }
    }

    /// values[i] lane a to column m + i of direction j + a in the array that starts at `array`.
    template <class V>
    static HWY_INLINE void scatter(const V* values, T* array, std::size_t directions,
                                   std::size_t step, std::size_t j, std::size_t m) {
        using W = hn::DFromV<V>;
        constexpr std::size_t lanes = lanesOf<W>;
        static_assert(n % lanes == 0);
        for (std::size_t i = 0; i < 4; i += lanes) {
            V block[lanes];
            for (std::size_t a = 0; a < lanes; ++a) block[a] = values[i + a];
            transpose(W(), block);
            const std::size_t column = m + i;
            T* const to = array + (column / n * directions + j) * step + column % n;
            for (std::size_t a = 0; a < lanes; ++a) storeReal(W(), block[a], to + a * step);
        }
    }

    /// Splits the azimuths of columns m .. m + n - 1 into the ones for rows of even l and for rows
    /// of odd l.
    static HWY_INLINE void separate(T* azimuths, std::size_t m) {
        for (T* array : {azimuths, azimuths + n})
            for (std::size_t i = 0; i < n; ++i) {
                const bool odd = (m + i) % 2 == 1;
                array[2 * n + i] = odd ? array[i] : T{0};
                if (odd) array[i] = 0;
            }
    }

    const Recurrences<T>& r;
    std::size_t order, columns;
    bool sparse;
    T* out;
    HWY_ALIGN double distance[chunk], far[chunk], factor[chunk], weight[chunk], c[chunk], s[chunk],
        awake[chunk];
    HWY_ALIGN T small[smallMemory];
    hwy::AlignedFreeUniquePtr<T[]> large;
    T* state;
};

template <class T>
void tabulate(const Recurrences<T>& r, DirectionBatch directions, T* out) {
    Tabulation<T> tabulation(r, directions.count, out);
    constexpr std::size_t chunk = Tabulation<T>::chunk;
    for (std::size_t k = 0; k < directions.count; k += chunk)
        tabulation.run(directions, k, std::min(chunk, directions.count - k));
}

}  // namespace

void rowsDouble(const Recurrences<double>& r, DirectionBatch directions, double* out) {
    tabulate(r, directions, out);
}

void rowsFloat(const Recurrences<float>& r, DirectionBatch directions, float* out) {
    tabulate(r, directions, out);
}

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::bases::kernels {

HWY_EXPORT(rowsDouble);
HWY_EXPORT(rowsFloat);

void tabulateLong(const Recurrences<double>& r, DirectionBatch directions, double* out) {
    if (directions.count > 0) HWY_DYNAMIC_DISPATCH(rowsDouble)(r, directions, out);
}

void tabulateLong(const Recurrences<float>& r, DirectionBatch directions, float* out) {
    if (directions.count > 0) HWY_DYNAMIC_DISPATCH(rowsFloat)(r, directions, out);
}

}  // namespace hshfit::bases::kernels
#endif
