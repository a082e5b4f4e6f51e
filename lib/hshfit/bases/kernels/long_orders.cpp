#include <hshfit/bases/kernels/long_orders.h>

#include <hshfit/bases/kernels/targets.h>

#include <algorithm>
#include <cmath>

#include <hwy/aligned_allocator.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/bases/kernels/long_orders.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/kernels/columns-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {
namespace {

/// A block of directions on its way through the columns. Rows are done in groups whose values fit
/// into the cache; between groups the columns wait in `p`, `d`, `e`.
template <class D, int vectors>
class Block {
public:
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    using Doubles = hn::CappedTag<double, lanesOf<D> == 1 ? 1 : 64 / sizeof(double)>;
    static constexpr std::size_t n = lanesOf<D>, width = n * vectors;
    static constexpr std::size_t tileBytes = 1 << 16;

    explicit Block(const Recurrences<T>& recurrences)
        : r(recurrences), order(static_cast<std::size_t>(r.order)) {
        tileSlots = std::max(tileBytes / (width * sizeof(T)), 2 * order);
        tileSlots = std::min(tileSlots, order * order);
        memory = hwy::AllocateAligned<T>(width * (2 + 7 * order + tileSlots));
        T* next = memory.get();
        const auto take = [&next](std::size_t count) {
            T* const first = next;
            next += count * width;
            return first;
        };
        distance = take(1), side = take(1);
        azimuth = take(4 * order), p = take(order), d = take(order), e = take(order);
        tile = take(tileSlots);
    }

    /// Directions `first` to first + valid - 1, at most `width` of them.
    void run(DirectionBatch directions, std::size_t first, std::size_t valid, bool bySlot, T* out) {
        for (std::size_t j = 0; j < width; ++j) {
            const std::size_t k = first + std::min(j, valid - 1);
            x[j] = directions.x[k], y[j] = directions.y[k], z[j] = directions.z[k];
        }
        for (std::size_t j = 0; j < width; j += lanesOf<Doubles>) start(j);
        const std::size_t slots = order * order;
        for (std::size_t l0 = 0; l0 < order;) {
            std::size_t l1 = l0 + 1;
            while (l1 < order && (l1 + 1) * (l1 + 1) - l0 * l0 <= tileSlots) ++l1;
            for (std::size_t m = 0; m < l1; ++m) column(m, l0, l1);
            if (bySlot)
                drainBySlot(l0 * l0, l1 * l1, valid, out + first, directions.count);
            else
                drain(l0 * l0, l1 * l1, valid, out + first * slots, slots);
            l0 = l1;
        }
    }

private:
    static constexpr Doubles wide{};
    using W = hn::Vec<Doubles>;

    /// Azimuths, distances from the nearer end and the starts of all columns for the directions
    /// from j on. In double for either type: they cost n operations, the columns n^2.
    void start(std::size_t j) {
        const W zero = hn::Zero(wide), one = hn::Set(wide, 1);
        const W px = hn::Load(wide, x + j), py = hn::Load(wide, y + j), mu = hn::Load(wide, z + j);
        // The larger of |x| and |y| is taken out first, so that squares do not underflow.
        const W large = hn::Max(hn::Abs(px), hn::Abs(py));
        const auto pole = hn::Eq(large, zero);
        const W unit = hn::IfThenElse(pole, one, large);
        const W ux = hn::Div(px, unit), uy = hn::Div(py, unit);
        const W length = hn::Sqrt(hn::MulAdd(ux, ux, hn::Mul(uy, uy)));
        const W c = hn::IfThenElse(pole, one, hn::Div(ux, length));
        const W s = hn::IfThenElse(pole, zero, hn::Div(uy, length));
        const W sine = hn::IfThenElse(pole, zero, hn::Mul(large, length));
        const auto below = hn::Lt(mu, zero);
        W factor = sine, weight = one;
        W far = zero;  // 1 where the nearer end is t = -1
        if (r.domain == Domain::sphere) {
            const W height = hn::Abs(mu);
            far = hn::IfThenElse(below, one, zero);
            storeReal(wide, hn::Neg(hn::Div(hn::Mul(sine, sine), hn::Add(one, height))),
                      distance + j);
        } else {
            const W above = hn::Max(mu, zero), onePlus = hn::Add(one, above);
            const W rest = hn::Div(hn::Mul(sine, sine), onePlus);
            const auto nearPole = hn::Le(rest, hn::Set(wide, 0.5));
            const bool chord = r.domain == Domain::chord;
            const W nearer = hn::IfThenElse(nearPole, rest, above);
            far = hn::IfThenElse(nearPole, chord ? one : zero, chord ? zero : one);
            const W twice = hn::Add(nearer, nearer);
            const auto positive = hn::Gt(far, zero);
            storeReal(
                wide,
                r.symmetric ? hn::Neg(twice) : hn::IfThenElse(positive, twice, hn::Neg(twice)),
                distance + j);
            const W ratio = hn::Div(chord ? one : above, onePlus);
            factor = hn::Mul(sine, hn::Sqrt(ratio));
            if (!chord) factor = hn::Add(factor, factor);
            if (r.timesRootCosine) weight = hn::Sqrt(above);
            weight = hn::IfThenElse(below, zero, weight);
        }
        storeReal(wide, far, side + j);
        startColumns(j, factor, weight);
        startAzimuths(j, c, s, hn::Sub(one, hn::Add(far, far)));
    }

    void startColumns(std::size_t j, W factor, W weight) {
        const W tiny = hn::Set(wide, std::numeric_limits<double>::min()), one = hn::Set(wide, 1);
        const auto noFactor = hn::Lt(factor, tiny), noWeight = hn::Lt(weight, tiny);
        const Scaled<Doubles> base(hn::IfThenElse(noFactor, one, factor));
        Scaled<Doubles> power(hn::IfThenElse(noWeight, one, weight));
        // Where no power leaves the range, the same products without exponents.
        const W lowest = hn::MulAdd(base.exponent, hn::Set(wide, static_cast<double>(order - 1)),
                                    power.exponent);
        const auto inRange = hn::Gt(lowest, hn::Set(wide, -shiftOf<T> / 2.0));
        if (hn::AllTrue(wide, inRange) && hn::AllFalse(wide, hn::Or(noFactor, noWeight))) {
            W product = weight;
            for (std::size_t m = 0; m < order; ++m) {
                storeReal(wide, hn::Mul(product, hn::Set(wide, r.starts[m])), p + m * width + j);
                storeReal(wide, hn::Zero(wide), e + m * width + j);
                product = hn::Mul(product, factor);
            }
            return;
        }
        for (std::size_t m = 0; m < order; ++m) {
            W value, exponent;
            startOf<T>(wide, power, m > 0 ? hn::Or(noFactor, noWeight) : noWeight, value, exponent);
            storeReal(wide, hn::Mul(value, hn::Set(wide, r.starts[m])), p + m * width + j);
            storeReal(wide, exponent, e + m * width + j);
            power.multiply(base);
        }
    }

    /// Per column four vectors for every lane: cosine and sine for functions k = 0, 2, …, then for
    /// 1, 3, …, which differ in sign where a lane runs mirrored.
    void startAzimuths(std::size_t j, W c, W s, W sign) {
        W re = hn::Set(wide, 1), im = hn::Zero(wide);
        const W other = r.symmetric ? sign : re;
        for (std::size_t m = 0; m < order; ++m) {
            if (m > 0) {
                const W next = hn::NegMulAdd(im, s, hn::Mul(re, c));
                im = hn::MulAdd(re, s, hn::Mul(im, c));
                re = next;
            }
            const double scale =
                (m % 2 == 1 && r.condonShortley ? -1 : 1) / std::sqrt(m == 0 ? 2 * pi : pi);
            const W a = hn::Mul(re, hn::Set(wide, scale)), b = hn::Mul(im, hn::Set(wide, scale));
            T* to = azimuth + 4 * m * width + j;
            storeReal(wide, a, to);
            storeReal(wide, b, to + width);
            storeReal(wide, hn::Mul(a, other), to + 2 * width);
            storeReal(wide, hn::Mul(b, other), to + 3 * width);
        }
    }

    /// Values times azimuths into the tile.
    struct Take {
        const T* azimuth;
        T* tile;
        std::ptrdiff_t base;  ///< slot 0 of the tile
        int m, step;
        bool oddOnes;  ///< whether functions with odd k exist

        HWY_INLINE void operator()(int k, int v, V value) const {
            const std::ptrdiff_t l = m + static_cast<std::ptrdiff_t>(k) * step;
            const T* part = azimuth + (k % 2 == 0 ? 0 : 2 * width) + v * n;
            if (k % 2 != 0 && !oddOnes) value = hn::Zero(D());
            T* centre = tile + (l * (l + 1) - base) * static_cast<std::ptrdiff_t>(width) + v * n;
            const std::ptrdiff_t away = m * static_cast<std::ptrdiff_t>(width);
            hn::Store(hn::Mul(value, hn::Load(D(), part + width)), D(), centre - away);
            hn::Store(hn::Mul(value, hn::Load(D(), part)), D(), centre + away);
        }
    };

    /// Rows l0 .. l1 - 1 of column m.
    void column(std::size_t m, std::size_t l0, std::size_t l1) {
        const auto step = static_cast<std::size_t>(r.bandStep);
        const bool fresh = m >= l0;
        const std::size_t from = fresh ? 0 : (l0 - m + step - 1) / step;
        const std::size_t to = (l1 - m + step - 1) / step;
        Column<D, vectors> state;
        state.place(distance, side);
        state.resume(p + m * width, fresh ? nullptr : d + m * width, e + m * width);
        const Take take{azimuth + 4 * m * width, tile,       static_cast<std::ptrdiff_t>(l0 * l0),
                        static_cast<int>(m),     r.bandStep, !r.evenOnly};
        const Step<T>*one = r.steps[0] + r.offsets[m], *other = r.steps[1] + r.offsets[m];
        if (r.symmetric)
            state.template run<true>(one, other, static_cast<int>(from), static_cast<int>(to),
                                     fresh, take);
        else
            state.template run<false>(one, other, static_cast<int>(from), static_cast<int>(to),
                                      fresh, take);
        if (l1 < order) state.save(p + m * width, d + m * width, e + m * width);
        for (std::size_t l = std::max(l0, m); step == 2 && l < l1; ++l)
            if ((l - m) % 2 != 0)
                for (std::size_t slot : {l * (l + 1) - m, l * (l + 1) + m})
                    std::fill_n(tile + (slot - l0 * l0) * width, width, T{0});
    }

    void drainBySlot(std::size_t from, std::size_t to, std::size_t valid, T* out,
                     std::size_t stride) const {
        for (std::size_t slot = from; slot < to; ++slot)
            std::copy_n(tile + (slot - from) * width, valid, out + slot * stride);
    }

    /// The tile transposed: slots from .. to - 1 of `valid` directions.
    void drain(std::size_t from, std::size_t to, std::size_t valid, T* out,
               std::size_t stride) const {
        const std::size_t whole = (to - from) / n * n;
        for (std::size_t i = 0; i < whole; i += n)
            for (std::size_t v = 0; v < vectors; ++v) {
                V values[n];
                for (std::size_t a = 0; a < n; ++a)
                    values[a] = hn::Load(D(), tile + (i + a) * width + v * n);
                transpose(D(), values);
                T* to0 = out + v * n * stride + from + i;
                if (v * n + n <= valid)
                    for (std::size_t a = 0; a < n; ++a)
                        hn::StoreU(values[a], D(), to0 + a * stride);
                else
                    for (std::size_t a = 0; v * n + a < valid; ++a)
                        hn::StoreU(values[a], D(), to0 + a * stride);
            }
        for (std::size_t slot = from + whole; slot < to; ++slot)
            for (std::size_t k = 0; k < valid; ++k)
                out[k * stride + slot] = tile[(slot - from) * width + k];
    }

    const Recurrences<T>& r;
    std::size_t order, tileSlots;
    hwy::AlignedFreeUniquePtr<T[]> memory;
    T *distance, *side, *azimuth, *p, *d, *e, *tile;
    HWY_ALIGN double x[width], y[width], z[width];
};

template <class T>
void tabulateAll(const Recurrences<T>& r, DirectionBatch directions, bool bySlot, T* out) {
    if (directions.count == 1) {
        Block<Single<T>, 1>(r).run(directions, 0, 1, bySlot, out);
        return;
    }
    using Blocks = Block<Wide<T>, 2>;
    Blocks block(r);
    for (std::size_t k = 0; k < directions.count; k += Blocks::width)
        block.run(directions, k, std::min(Blocks::width, directions.count - k), bySlot, out);
}

}  // namespace

void tabulateDouble(const Recurrences<double>& r, DirectionBatch directions, bool bySlot,
                    double* out) {
    tabulateAll(r, directions, bySlot, out);
}

void tabulateFloat(const Recurrences<float>& r, DirectionBatch directions, bool bySlot,
                   float* out) {
    tabulateAll(r, directions, bySlot, out);
}

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::bases::kernels {

HWY_EXPORT(tabulateDouble);
HWY_EXPORT(tabulateFloat);

void tabulateLong(const Recurrences<double>& r, DirectionBatch directions, bool bySlot,
                  double* out) {
    if (directions.count > 0) HWY_DYNAMIC_DISPATCH(tabulateDouble)(r, directions, bySlot, out);
}

void tabulateLong(const Recurrences<float>& r, DirectionBatch directions, bool bySlot, float* out) {
    if (directions.count > 0) HWY_DYNAMIC_DISPATCH(tabulateFloat)(r, directions, bySlot, out);
}

}  // namespace hshfit::bases::kernels
#endif
