// Orders above the short ones, slot by slot: directions in lanes, column by column.

#include <hshfit/bases/internal/long_orders.h>

#include <hshfit/vector_targets.h>

#include <algorithm>
#include <utility>

#include <hwy/aligned_allocator.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/bases/internal/long_columns.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/internal/columns-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::bases::kernels::HWY_NAMESPACE {
namespace {

/// A block of directions on its way through the columns.
template <class D, int vectors>
class Block {
public:
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    static constexpr std::size_t n = lanesOf<D>, width = n * vectors;

    explicit Block(const Recurrences<T>& recurrences, std::size_t count)
        : r(recurrences), order(static_cast<std::size_t>(r.order)) {
        const std::size_t padded = (order + 3) / 4 * 4;
        memory =
            hwy::AllocateAligned<T>(width * (2 + 6 * padded + (count % width ? 2 * order : 0)));
        T* next = memory.get();
        const auto take = [&next](std::size_t rows) {
            return std::exchange(next, next + rows * width);
        };
        distance = take(1), side = take(1);
        azimuth = take(4 * padded), p = take(padded), e = take(padded);
        few = next;
    }

    /// Directions `first` to first + valid - 1, at most `width` of them, to out[slot stride + j].
    void run(DirectionBatch directions, std::size_t first, std::size_t valid, T* out,
             std::size_t stride) {
        for (std::size_t j = 0; j < width; j += lanesOf<W>) start(directions, first, valid, j);
        for (std::size_t m = 0; m < order; ++m) {
            T* const plus = out + m * (m + 2) * stride;
            T* const minus = out + m * m * stride;
            const std::size_t bandStep = static_cast<std::size_t>(r.bandStep);
            if (valid == width) {
                // Slots of l and l + bandStep lie bandStep (2 l + bandStep + 1) apart.
                column(m, {plus, minus, bandStep * (2 * m + bandStep + 1) * stride,
                           2 * bandStep * bandStep * stride});
            } else {
                column(m, {few, few + width, 2 * width, 0});
                const T* row = few;
                for (std::size_t l = m; l < order; l += bandStep, row += 2 * width) {
                    std::copy_n(row, valid, out + l * (l + 1) * stride + m * stride);
                    std::copy_n(row + width, valid, out + l * (l + 1) * stride - m * stride);
                }
            }
            for (std::size_t l = m + 1; bandStep == 2 && l < order; l += 2)
                for (const std::size_t slot : {l * (l + 1) - m, l * (l + 1) + m})
                    std::fill_n(out + slot * stride, valid, T{0});
        }
    }

private:
    using W = hn::CappedTag<double, 64 / sizeof(double)>;

    void start(DirectionBatch directions, std::size_t first, std::size_t valid, std::size_t j) {
        constexpr std::size_t lanes = lanesOf<W>;
        const W wide;
        HWY_ALIGN double x[lanes], y[lanes], z[lanes];
        for (std::size_t i = 0; i < lanes; ++i) {
            const std::size_t k = first + std::min(j + i, valid - 1);
            x[i] = directions.x[k], y[i] = directions.y[k], z[i] = directions.z[k];
        }
        const Place<W> place =
            placeAt(wide, r, hn::Load(wide, x), hn::Load(wide, y), hn::Load(wide, z));
        storeReal(wide, place.distance, distance + j);
        storeReal(wide, place.far, side + j);
        const auto one = hn::Set(wide, 1);
        const auto other = r.symmetric ? hn::Sub(one, hn::Add(place.far, place.far)) : one;
        Starts<T, W> starts(r, place);
        for (std::size_t m = 0; m < order; m += 4) {
            starts.next(static_cast<int>(m));
            for (std::size_t i = 0; i < 4; ++i) {
                storeReal(wide, starts.p[i], p + (m + i) * width + j);
                storeReal(wide, starts.e[i], e + (m + i) * width + j);
                T* to = azimuth + 4 * (m + i) * width + j;
                storeReal(wide, starts.a[i], to);
                storeReal(wide, starts.b[i], to + width);
                storeReal(wide, hn::Mul(starts.a[i], other), to + 2 * width);
                storeReal(wide, hn::Mul(starts.b[i], other), to + 3 * width);
            }
        }
    }

    /// The destination of a column's values: function k at plus and minus, moved on by `step`,
    /// which grows by `growth` from function to function.
    struct Target {
        T *plus, *minus;
        std::size_t step, growth;
    };

    /// Values times azimuths; these are cosine and sine for functions k = 0, 2, ..., then for
    /// 1, 3, ..., which differ in sign where a lane runs mirrored.
    struct Take {
        const T* azimuth;
        Target to;
        bool oddOnes;  ///< whether functions with odd k exist

        HWY_INLINE void operator()(int k, int v, V value) {
            const T* part = azimuth + (k % 2 == 0 ? 0 : 2 * width) + v * n;
            if (k % 2 != 0 && !oddOnes) value = hn::Zero(D());
            V plus = hn::Mul(value, hn::Load(D(), part));
            V minus = hn::Mul(value, hn::Load(D(), part + width));
            if (!oddOnes) {  // no negative zeros
                plus = hn::Add(plus, hn::Zero(D()));
                minus = hn::Add(minus, hn::Zero(D()));
            }
            hn::StoreU(minus, D(), to.minus + v * n);
            hn::StoreU(plus, D(), to.plus + v * n);
            if (v + 1 < vectors) return;
            to.plus += to.step;
            to.minus += to.step;
            to.step += to.growth;
        }
    };

    void column(std::size_t m, const Target& target) {
        const int step = r.bandStep, count = (r.order - static_cast<int>(m) + step - 1) / step;
        const Step<T>*one = r.steps[0] + r.offsets[m], *other = r.steps[1] + r.offsets[m];
        Column<D, vectors> state(distance, side, p + m * width, e + m * width);
        const Take take{azimuth + 4 * m * width, target, !r.evenOnly};
        if (r.symmetric)
            state.template run<true>(one, other, count, take);
        else
            state.template run<false>(one, other, count, take);
    }

    const Recurrences<T>& r;
    std::size_t order;
    hwy::AlignedFreeUniquePtr<T[]> memory;
    T *distance, *side, *azimuth, *p, *e, *few;
};

template <class T>
void tabulateAll(const Recurrences<T>& r, DirectionBatch directions, T* out) {
    using Blocks = Block<Wide<T>, 4>;
    Blocks block(r, directions.count);
    for (std::size_t k = 0; k < directions.count; k += Blocks::width)
        block.run(directions, k, std::min(Blocks::width, directions.count - k), out + k,
                  directions.count);
}

}  // namespace

void columnsDouble(const Recurrences<double>& r, DirectionBatch directions, double* out) {
    tabulateAll(r, directions, out);
}

void columnsFloat(const Recurrences<float>& r, DirectionBatch directions, float* out) {
    tabulateAll(r, directions, out);
}

}  // namespace hshfit::bases::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::bases::kernels {

HWY_EXPORT(columnsDouble);
HWY_EXPORT(columnsFloat);

void tabulateLongBySlot(const Recurrences<double>& r, DirectionBatch directions, double* out) {
    if (directions.count > 0) HWY_DYNAMIC_DISPATCH(columnsDouble)(r, directions, out);
}

void tabulateLongBySlot(const Recurrences<float>& r, DirectionBatch directions, float* out) {
    if (directions.count > 0) HWY_DYNAMIC_DISPATCH(columnsFloat)(r, directions, out);
}

}  // namespace hshfit::bases::kernels
#endif
