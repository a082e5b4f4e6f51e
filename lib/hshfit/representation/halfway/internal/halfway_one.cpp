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

/// Legendre polynomials of the four axes side by side: table[4 n + axis].
template <class T>
void legendre(const HalfwayLayout<T>& layout, const Four<T>& x, T* table) {
    Four<T> before = Four<T>::all(0), now = Four<T>::all(1);
    const Four<T> t = mulAdd(Four<T>::all(2), x, Four<T>::all(-1));
    for (std::size_t n = 0; 2 * n < layout.steps.size(); ++n) {
        now.to(table + 4 * n);
        const T a = layout.steps[2 * n], b = layout.steps[2 * n + 1];
        const Four<T> next = Four<T>::each([&](std::size_t p) {
            typename Four<T>::Tag tag;
            return hn::NegMulAdd(hn::Set(tag, b), before.part[p],
                                 hn::Mul(hn::Mul(hn::Set(tag, a), t.part[p]), now.part[p]));
        });
        before = now;
        now = next;
    }
}

/// The functions of the axes at the point, and the factors after them (HalfwayLayout::OneRow).
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

/// The sum of runs first .. last - 1 in up to three channels; `value` moves on.
template <class T>
Four<T> sumOf(const HalfwayLayout<T>& layout, std::size_t first, std::size_t last, const T* table,
              std::size_t channels, const T*& value) {
    Four<T> total[2] = {Four<T>::all(0), Four<T>::all(0)};
    for (std::size_t r = first; r < last; ++r) {
        const typename HalfwayLayout<T>::Run& run = layout.oneRuns[r];
        Four<T> part = Four<T>::all(0);
        for (std::size_t i = 0; i < run.length; ++i, value += channels)
            part = mulAdd(Four<T>::from(value), Four<T>::all(table[run.first + 4 * i]), part);
        T factor = table[run.factors[0]];
        for (std::size_t m = 1; m < run.factorCount; ++m) factor *= table[run.factors[m]];
        total[r % 2] = mulAdd(part, Four<T>::all(factor), total[r % 2]);
    }
    return mulAdd(total[0], Four<T>::all(1), total[1]);
}

template <class T>
void evaluateOne(const HalfwayLayout<T>& layout, const HalfwayPoint& point, std::size_t stride,
                 T* out) {
    HWY_ALIGN T table[HalfwayLayout<T>::mostOneRows];
    fillTable(layout, point, table);
    const T* value = layout.values.data();
    for (std::size_t c = 0; c < layout.channels; c += 3) {
        const std::size_t group = std::min<std::size_t>(3, layout.channels - c);
        const Four<T> smooth = sumOf(layout, 0, layout.smoothRuns, table, group, value);
        const Four<T> lobe =
            sumOf(layout, layout.smoothRuns, layout.runs.size(), table, group, value);
        T most[3][4] = {};
        for (std::size_t n = 0; n < group; ++n)
            for (std::size_t k = 0; k < 3; ++k) most[k][n] = layout.ceilings[3 * (c + n) + k];
        const auto exponential = [](const Four<T>& sum, const T* ceiling) {
            const Four<T> bound = Four<T>::from(ceiling);
            return Four<T>::each([&](std::size_t p) {
                return hn::Exp(typename Four<T>::Tag(), hn::Min(sum.part[p], bound.part[p]));
            });
        };
        T f[4];
        mulAdd(Four<T>::all(static_cast<T>(point.weight)), exponential(lobe, most[1]),
               exponential(smooth, most[0]))
            .to(f);
        for (std::size_t n = 0; n < group; ++n) out[(c + n) * stride] = std::min(f[n], most[2][n]);
    }
}

}  // namespace

void HalfwayOneInSingle(const HalfwayLayout<float>& layout, const HalfwayPoint& point,
                        std::size_t stride, float* out) {
    evaluateOne(layout, point, stride, out);
}
void HalfwayOneInDouble(const HalfwayLayout<double>& layout, const HalfwayPoint& point,
                        std::size_t stride, double* out) {
    evaluateOne(layout, point, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline halfway {

HWY_EXPORT(HalfwayOneInSingle);
HWY_EXPORT(HalfwayOneInDouble);

void evaluateHalfwayPair(const HalfwayLayout<float>& layout, const HalfwayPoint& point,
                         std::size_t stride, float* out) {
    HWY_DYNAMIC_DISPATCH(HalfwayOneInSingle)(layout, point, stride, out);
}

void evaluateHalfwayPair(const HalfwayLayout<double>& layout, const HalfwayPoint& point,
                         std::size_t stride, double* out) {
    HWY_DYNAMIC_DISPATCH(HalfwayOneInDouble)(layout, point, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway
#endif
