#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/light/internal/picture_rows.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/light/internal/picture_rows.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline light {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<double>;
using FloatTag = hn::Rebind<float, Tag>;
using Vec = hn::Vec<Tag>;

struct Pixels {
    Vec channel[3];
};

HWY_INLINE Pixels pixelsAt(const float* row, std::size_t column) {
    const FloatTag d;
    hn::Vec<FloatTag> r, g, b;
    hn::LoadInterleaved3(d, row + 3 * column, r, g, b);
    return {{hn::PromoteTo(Tag(), r), hn::PromoteTo(Tag(), g), hn::PromoteTo(Tag(), b)}};
}

/// Columns `last`, last - 1, …
HWY_INLINE Pixels pixelsBack(const float* row, std::size_t last) {
    Pixels pixels = pixelsAt(row, last + 1 - hn::Lanes(Tag()));
    for (Vec& value : pixels.channel) value = hn::Reverse(Tag(), value);
    return pixels;
}

/// The four kinds from pixels at psi, pi - psi, -psi, pi + psi.
template <class Value, class Add, class Sub, class Store>
HWY_INLINE void foldFour(const Value& first, const Value& second, const Value& third,
                         const Value& fourth, Add add, Sub sub, Store store) {
    const auto even = add(first, third), odd = sub(first, third);
    const auto evenBehind = add(second, fourth), oddBehind = sub(second, fourth);
    store(0, add(even, evenBehind));
    store(1, sub(even, evenBehind));
    store(2, add(odd, oddBehind));
    store(3, sub(odd, oddBehind));
}

void fold(const float* row, std::size_t width, std::size_t kindStride, double* out,
          double* squares) {
    const Tag d;
    const std::size_t n = hn::Lanes(d), quadrant = width / 4, middle = width / 2;
    Vec sums[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    std::size_t j = 0;
    for (; j + n <= quadrant; j += n) {
        const Pixels p[4] = {pixelsAt(row, j), pixelsBack(row, middle - 1 - j),
                             pixelsBack(row, width - 1 - j), pixelsAt(row, middle + j)};
        for (std::size_t c = 0; c < 3; ++c) {
            for (const Pixels& each : p)
                sums[c] = hn::MulAdd(each.channel[c], each.channel[c], sums[c]);
            foldFour(
                p[0].channel[c], p[1].channel[c], p[2].channel[c], p[3].channel[c],
                [](Vec a, Vec b) HWY_ATTR { return hn::Add(a, b); },
                [](Vec a, Vec b) HWY_ATTR { return hn::Sub(a, b); },
                [&](std::size_t kind, Vec value)
                    HWY_ATTR { hn::StoreU(value, d, out + kind * kindStride + c * quadrant + j); });
        }
    }
    for (std::size_t c = 0; c < 3; ++c) squares[c] += hn::GetLane(hn::SumOfLanes(d, sums[c]));
    for (; j < quadrant; ++j) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto at = [&](std::size_t column) { return double{row[3 * column + c]}; };
            const double p[4] = {at(j), at(middle - 1 - j), at(width - 1 - j), at(middle + j)};
            for (const double value : p) squares[c] += value * value;
            foldFour(
                p[0], p[1], p[2], p[3], [](double a, double b) { return a + b; },
                [](double a, double b) { return a - b; },
                [&](std::size_t kind, double value) {
                    out[kind * kindStride + c * quadrant + j] = value;
                });
        }
    }
}

double sum(const float* row, std::size_t width) {
    const hn::ScalableTag<float> d;
    const std::size_t n = hn::Lanes(d), count = 3 * width;
    hn::Vec<decltype(d)> sums[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    std::size_t k = 0;
    for (; k + 4 * n <= count; k += 4 * n)
        for (std::size_t part = 0; part < 4; ++part)
            sums[part] = hn::Add(sums[part], hn::LoadU(d, row + k + part * n));
    double total = 0;
    for (const auto& part : sums) total += double{hn::GetLane(hn::SumOfLanes(d, part))};
    for (; k < count; ++k) total += double{row[k]};
    return total;
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline light
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline light {

HWY_EXPORT(fold);
HWY_EXPORT(sum);

void foldPictureRow(const float* row, std::size_t width, std::size_t kindStride, double* out,
                    double* squares) {
    HWY_DYNAMIC_DISPATCH(fold)(row, width, kindStride, out, squares);
}

double sumPictureRow(const float* row, std::size_t width) {
    return HWY_DYNAMIC_DISPATCH(sum)(row, width);
}

}  // namespace hshfit::inline light
#endif  // HWY_ONCE
