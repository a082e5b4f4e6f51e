#include <hshfit/representation/halfway/internal/halfway_kernel.h>
#include <hshfit/vector_targets.h>

#include <algorithm>

// Compiled once for every instruction set; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/representation/halfway/internal/halfway_one.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Four numbers, one for each axis or channel, in as few vectors as hold them.
template <class T>
struct Four {
    using Tag = hn::CappedTag<T, 4>;
    static constexpr std::size_t lanes = hn::MaxLanes(Tag()), parts = 4 / lanes;
    hn::Vec<Tag> part[parts];

    static Four all(T value) {
        return each([&](std::size_t) { return hn::Set(Tag(), value); });
    }
    static Four from(const T* values) {
        return each([&](std::size_t p) { return hn::LoadU(Tag(), values + p * lanes); });
    }
    void to(T* values) const {
        for (std::size_t p = 0; p < parts; ++p) hn::StoreU(part[p], Tag(), values + p * lanes);
    }
    template <class Make>
    static Four each(const Make& make) {
        Four result;
        for (std::size_t p = 0; p < parts; ++p) result.part[p] = make(p);
        return result;
    }
};

template <class T>
Four<T> mulAdd(const Four<T>& a, const Four<T>& b, const Four<T>& c) {
    return Four<T>::each(
        [&](std::size_t p) { return hn::MulAdd(a.part[p], b.part[p], c.part[p]); });
}

/// HalfwayAxes::at with its cube roots and its logarithm side by side, as many pairs have them.
template <class T>
HalfwayPoint pointOf(const HalfwayLayout<T>& layout, const Direction& wi, const Direction& wo) {
    double tail;
    HalfwayPoint point = HalfwayAxes::unplaced(layout.axes, wi, wo, tail);
    typename Four<T>::Tag tag;
    const T least = static_cast<T>(1e-30), third = static_cast<T>(1.0 / 3);
    T values[4] = {std::max(static_cast<T>(wi.z), least), std::max(static_cast<T>(wo.z), least),
                   static_cast<T>(tail), 1};
    const Four<T> from = Four<T>::from(values);
    const Four<T> logs = Four<T>::each([&](std::size_t p) { return hn::Log(tag, from.part[p]); });
    const Four<T> roots = Four<T>::each(
        [&](std::size_t p) { return hn::Exp(tag, hn::Mul(logs.part[p], hn::Set(tag, third))); });
    T logarithms[4];
    logs.to(logarithms);
    roots.to(values);
    point.place(values[0], values[1], static_cast<double>(logarithms[2]) * layout.axes.perLog);
    return point;
}

/// Legendre polynomials of the four axes, computed side by side, each axis by itself in the end.
template <class T>
void legendre(const HalfwayLayout<T>& layout, const Four<T>& x, T* table) {
    typename Four<T>::Tag tag;
    const std::size_t functions = layout.steps.size() / 2;
    HWY_ALIGN T sides[HalfwayLayout<T>::mostOneRows];
    Four<T> before = Four<T>::all(0), now = Four<T>::all(1);
    const Four<T> t = mulAdd(Four<T>::all(2), x, Four<T>::all(-1));
    for (std::size_t n = 0; n < functions; ++n) {
        now.to(sides + 4 * n);
        // Only one operation waits for the polynomial before.
        const auto a = hn::Set(tag, layout.steps[2 * n]), b = hn::Set(tag, layout.steps[2 * n + 1]);
        const Four<T> next = Four<T>::each([&](std::size_t p) {
            return hn::MulSub(hn::Mul(a, t.part[p]), now.part[p], hn::Mul(b, before.part[p]));
        });
        before = now;
        now = next;
    }
    for (std::size_t n = 0; n < functions; n += Four<T>::lanes) {
        hn::Vec<typename Four<T>::Tag> axis[4];
        hn::LoadInterleaved4(tag, sides + 4 * n, axis[0], axis[1], axis[2], axis[3]);
        for (std::size_t k = 0; k < 4; ++k) hn::StoreU(axis[k], tag, table + k * functions + n);
    }
}

/// The functions of the axes at the point, and the factors after them (HalfwayLayout::oneRuns).
template <class T>
void fillTable(const HalfwayLayout<T>& layout, const HalfwayPoint& point, T* table) {
    const T axes[4] = {static_cast<T>(point.mean), static_cast<T>(point.x), static_cast<T>(point.v),
                       static_cast<T>(point.product)};
    legendre(layout, Four<T>::from(axes), table);
    T* next = table + 2 * layout.steps.size();
    T power = static_cast<T>(point.x);
    for (int n = 0; n < layout.powers; ++n) {
        power *= static_cast<T>(point.kappa);
        *next++ = power;
    }
    T c = static_cast<T>(point.x), s = 0;
    const T cosine = static_cast<T>(point.cosine), sine = static_cast<T>(point.sine);
    for (int q = 0; q < layout.harmonics; ++q) {
        const T turned = c * cosine - s * sine;
        s = c * sine + s * cosine;
        c = turned;
        *next++ = c;
        *next++ = s;
    }
    *next++ = static_cast<T>(point.gap);
    *next++ = static_cast<T>(point.handed);
}

/// The sums of runs first .. last - 1 in a group of channels.
template <std::size_t Channels, class T>
Four<T> sumOf(const HalfwayLayout<T>& layout, std::size_t first, std::size_t last, const T* table,
              const T* values) {
    const hn::CappedTag<T, halfwayPadding> tag;
    const std::size_t lanes = hn::Lanes(tag);
    using Vector = hn::Vec<decltype(tag)>;
    Vector total[2][Channels];
    for (auto& part : total)
        for (Vector& t : part) t = hn::Zero(tag);
    for (std::size_t r = first; r < last; ++r) {
        const HalfwayRunLayout& run = layout.oneRuns[r];
        Vector factor = hn::Set(tag, table[run.factors[0]]);
        for (std::size_t m = 1; m < run.factorCount; ++m)
            factor = hn::Mul(factor, hn::Set(tag, table[run.factors[m]]));
        const T* value = values + Channels * run.value;
        // Beyond the functions of a run lie functions of the next axis; the coefficients stored for
        // them are 0.
        for (std::size_t i = 0; i < run.stored; i += lanes) {
            const Vector function = hn::Mul(factor, hn::LoadU(tag, table + run.first + i));
            // In turns, so that a sum does not wait for the one before.
            for (std::size_t c = 0; c < Channels; ++c) {
                const Vector sum =
                    hn::MulAdd(function, hn::LoadU(tag, value + c * run.stored + i), total[0][c]);
                total[0][c] = total[1][c];
                total[1][c] = sum;
            }
        }
    }
    T sums[4] = {};
    for (std::size_t c = 0; c < Channels; ++c)
        sums[c] = hn::GetLane(hn::SumOfLanes(tag, hn::Add(total[0][c], total[1][c])));
    return Four<T>::from(sums);
}

/// f in a group of channels that begins at `firstChannel`.
template <std::size_t Channels, class T>
void evaluateGroup(const HalfwayLayout<T>& layout, std::size_t firstChannel, const T* table,
                   T weight, std::size_t stride, T* out) {
    const T* values = layout.values.data() + firstChannel * layout.stored;
    const std::size_t smoothRuns = layout.smoothRuns, runs = layout.runs.size();
    const Four<T> smooth = sumOf<Channels>(layout, 0, smoothRuns, table, values);
    const Four<T> lobe = sumOf<Channels>(layout, smoothRuns, runs, table, values);
    T most[3][4] = {};
    for (std::size_t n = 0; n < Channels; ++n)
        for (std::size_t k = 0; k < 3; ++k)
            most[k][n] = layout.ceilings[3 * (firstChannel + n) + k];
    const auto exponential = [](const Four<T>& sum, const T* ceiling) {
        const Four<T> bound = Four<T>::from(ceiling);
        return Four<T>::each([&](std::size_t p) {
            return hn::Exp(typename Four<T>::Tag(), hn::Min(sum.part[p], bound.part[p]));
        });
    };
    T f[4];
    mulAdd(Four<T>::all(weight), exponential(lobe, most[1]), exponential(smooth, most[0])).to(f);
    for (std::size_t n = 0; n < Channels; ++n)
        out[(firstChannel + n) * stride] = std::min(f[n], most[2][n]);
}

template <class T>
void evaluateOne(const HalfwayLayout<T>& layout, const Direction& wi, const Direction& wo,
                 std::size_t stride, T* out) {
    HWY_ALIGN T table[HalfwayLayout<T>::mostOneRows];
    const HalfwayPoint point = pointOf(layout, wi, wo);
    fillTable(layout, point, table);
    const T weight = static_cast<T>(point.weight);
    for (std::size_t c = 0; c < layout.channels; c += 3) {
        const std::size_t group = layout.channels - c;
        if (group >= 3) {
            evaluateGroup<3>(layout, c, table, weight, stride, out);
        } else if (group == 2) {
            evaluateGroup<2>(layout, c, table, weight, stride, out);
        } else {
            evaluateGroup<1>(layout, c, table, weight, stride, out);
        }
    }
}

}  // namespace

void HalfwayOneInSingle(const HalfwayLayout<float>& layout, const Direction& wi,
                        const Direction& wo, std::size_t stride, float* out) {
    evaluateOne(layout, wi, wo, stride, out);
}
void HalfwayOneInDouble(const HalfwayLayout<double>& layout, const Direction& wi,
                        const Direction& wo, std::size_t stride, double* out) {
    evaluateOne(layout, wi, wo, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline halfway {

HWY_EXPORT(HalfwayOneInSingle);
HWY_EXPORT(HalfwayOneInDouble);

void evaluateHalfwayPair(const HalfwayLayout<float>& layout, const Direction& wi,
                         const Direction& wo, std::size_t stride, float* out) {
    HWY_DYNAMIC_DISPATCH(HalfwayOneInSingle)(layout, wi, wo, stride, out);
}

void evaluateHalfwayPair(const HalfwayLayout<double>& layout, const Direction& wi,
                         const Direction& wo, std::size_t stride, double* out) {
    HWY_DYNAMIC_DISPATCH(HalfwayOneInDouble)(layout, wi, wo, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway
#endif
