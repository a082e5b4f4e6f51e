#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/light/internal/short_rows.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/light/internal/real_transform-inl.h>

#include <algorithm>
#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline light {
namespace HWY_NAMESPACE {
namespace {

constexpr std::size_t points = ShortPlan::points;

/// Terms 0 .. last alone; others cost nothing.
template <std::size_t last, class Load, std::size_t... k>
HWY_INLINE void transformPoints(const Load& load, double* terms, double* squares,
                                std::index_sequence<k...>) {
    V v[points] = {load(reversed(k, points))...};
    V sums[4] = {hn::Load(Tag(), squares), hn::Zero(Tag()), hn::Zero(Tag()), hn::Zero(Tag())};
    ((sums[k % 4] = hn::MulAdd(v[k], v[k], sums[k % 4])), ...);
    hn::Store(hn::Add(hn::Add(sums[0], sums[1]), hn::Add(sums[2], sums[3])), Tag(), squares);
    transformInRegisters<points>(v);
    ((k <= last || k + last >= points ? hn::Store(v[k], Tag(), terms + k * lanes) : void()), ...);
}

constexpr std::size_t fewTerms = 9, allTerms = points / 2;

// Values to come are asked for a quarter while transforming and the rest while summing: more
// requests at a time than the processor keeps track of would stop it. They go to the second cache,
// since a row, its tables and terms fill the first.
constexpr std::size_t line = 64 / sizeof(float);
constexpr std::size_t aheadInTransform = points * lanes / line / 4;
HWY_INLINE void fetch(const float* at) {
    __builtin_prefetch(at, 0, 2);
}

/// Transforms values `part` apart, with one transform in each lane. Adds the squares of the values
/// to `squares`, and prefetches a quarter as many values from `ahead`. Not inlined: the compiler
/// would keep a pointer for each value, in memory.
template <std::size_t last>
HWY_NOINLINE void transformColumns(const float* from, std::size_t part, const float* ahead,
                                   double* terms, double* squares) {
    const auto load = [&](std::size_t b) HWY_ATTR {
        if (b < aheadInTransform) fetch(ahead + b * line);
        return hn::PromoteTo(Tag(), hn::LoadU(FloatTag(), from + b * part));
    };
    transformPoints<last>(load, terms, squares, std::make_index_sequence<points>());
}

/// The same for the last lanes of a part, of which `some` are there.
template <std::size_t last>
HWY_NOINLINE void transformRest(const float* from, std::size_t part, std::size_t some,
                                double* terms, double* squares) {
    const auto load = [&](std::size_t b) HWY_ATTR {
        HWY_ALIGN float values[lanes] = {};
        std::copy_n(from + b * part, some, values);
        return hn::PromoteTo(Tag(), hn::Load(FloatTag(), values));
    };
    transformPoints<last>(load, terms, squares, std::make_index_sequence<points>());
}

/// Transforms that are summed together, as many for each place of the channels among the lanes:
/// lane i of transform number t has channel (t lanes + i) mod 3.
constexpr std::size_t together = 3;
constexpr std::size_t transformSize = (points + 1) * lanes;  // the last are zeros

/// The places at which the sums of each m find their terms, and the sign of the sines.
struct TermPlaces {
    std::size_t re[ShortPlan::mostOrder], im[ShortPlan::mostOrder];
    double sign[ShortPlan::mostOrder];
    explicit TermPlaces(std::size_t order) {
        for (std::size_t m = 0; m < order; ++m) {
            const std::size_t k = m % points, near = std::min(k, points - k);
            re[m] = near * lanes;
            im[m] = (near == 0 || 2 * near == points ? points : points - near) * lanes;
            sign[m] = k == near ? 1 : -1;
        }
    }
};

/// sums: [m][cosine, sine][3][lane]; tables[t]: [m][cosine, sine][group] of transform t.
HWY_INLINE void addShortSums(std::size_t order, const TermPlaces& places, const double* terms,
                             const double* const* tables, const float* ahead, double* sums) {
    const Tag d;
    constexpr std::size_t lines = together * (points * lanes / line - aheadInTransform);
    const std::size_t some = (lines + order - 1) / order;
    for (std::size_t m = 0; m < order; ++m) {
        for (std::size_t k = 0; k < some; ++k, ahead += line) fetch(ahead);
        double* const to = sums + m * 6 * lanes;
        V cosine[3], sine[3];
        for (std::size_t p = 0; p < 3; ++p) {
            cosine[p] = hn::Load(d, to + p * lanes);
            sine[p] = hn::Load(d, to + (3 + p) * lanes);
        }
        const double *re = terms + places.re[m], *im = terms + places.im[m];
        for (std::size_t t = 0; t < together; t += 3)
            for (std::size_t p = 0; p < 3; ++p) {
                const double* const w = tables[t + p] + m * 2 * group;
                const V c = hn::LoadU(d, w), s = hn::LoadU(d, w + group);
                const V x = hn::Load(d, re + (t + p) * transformSize);
                const V y = hn::Load(d, im + (t + p) * transformSize);
                cosine[p] = hn::MulAdd(c, x, hn::MulAdd(s, y, cosine[p]));
                sine[p] = hn::MulAdd(s, x, hn::NegMulAdd(c, y, sine[p]));
            }
        for (std::size_t p = 0; p < 3; ++p) {
            hn::Store(cosine[p], d, to + p * lanes);
            hn::Store(sine[p], d, to + (3 + p) * lanes);
        }
    }
}

/// The sums of each channel over 3 vectors.
HWY_INLINE void addChannels(const double* values, double sign, double* out, std::size_t outStride) {
    double r = 0, g = 0, b = 0;
    for (std::size_t k = 0; k < 3 * lanes; k += 3) {
        r += values[k];
        g += values[k + 1];
        b += values[k + 2];
    }
    out[0] = sign * r;
    out[outStride] = sign * g;
    out[2 * outStride] = sign * b;
}

template <std::size_t last>
void sumRows(const ShortPlan& plan, const SpectrumColumns& columns, const float* rows,
             std::size_t count, double* out, double* squares) {
    const std::size_t order = plan.order, part = 3 * plan.width / points;
    HWY_ALIGN double sums[6 * ShortPlan::mostOrder * lanes], square[3 * lanes];
    HWY_ALIGN double terms[together * transformSize];
    std::fill(std::begin(terms), std::end(terms), 0.0);
    const TermPlaces places(order);
    for (std::size_t r = 0; r < count; ++r) {
        const float* const row = rows + r * 3 * plan.width;
        const float* const next = r + 1 < count ? row + 3 * plan.width : row;
        std::fill(sums, sums + 6 * order * lanes, 0.0);
        std::fill(std::begin(square), std::end(square), 0.0);
        for (std::size_t first = 0; first < part; first += together * lanes) {
            const double* tables[together];
            for (std::size_t t = 0; t < together; ++t) {
                const std::size_t k = first + t * lanes;
                double* const to = terms + t * transformSize;
                tables[t] = plan.table.data();
                if (k >= part) {
                    std::fill(to, to + points * lanes, 0.0);
                    continue;
                }
                tables[t] += k / group * group * 2 * order + k % group;
                if (k + lanes <= part)
                    transformColumns<last>(row + k, part,
                                           next + first * points + t * aheadInTransform * line, to,
                                           square + t % 3 * lanes);
                else
                    transformRest<last>(row + k, part, part - k, to, square + t % 3 * lanes);
            }
            addShortSums(order, places, terms, tables,
                         next + first * points + together * aheadInTransform * line, sums);
        }
        double* const to = out + r * 3 * columns.all;
        for (std::size_t m = 0; m < order; ++m) {
            const double* const from = sums + m * 6 * lanes;
            addChannels(from, 1, to + columns.of(m, false), columns.all);
            addChannels(from + 3 * lanes, places.sign[m], to + columns.of(m, true), columns.all);
        }
        addChannels(square, 1, squares + 3 * r, 1);
    }
}

}  // namespace

void shortRows(const ShortPlan& plan, const SpectrumColumns& columns, const float* rows,
               std::size_t count, double* out, double* squares) {
    if (plan.order <= fewTerms + 1)
        sumRows<fewTerms>(plan, columns, rows, count, out, squares);
    else
        sumRows<allTerms>(plan, columns, rows, count, out, squares);
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
HWY_EXPORT(shortRows);
HWY_EXPORT(sum);

ShortPlan::ShortPlan(int bands, std::size_t columns)
    : order(static_cast<std::size_t>(bands)), width(columns) {
    constexpr std::size_t group = SpectrumColumns::group;
    const std::size_t part = 3 * width / points, groups = (part + group - 1) / group;
    table.assign(groups * 2 * order * group, 0.0);
    for (std::size_t m = 0; m < order; ++m) {
        // Terms beyond the middle are conjugates.
        const double sign = m % points > points / 2 ? -1 : 1;
        for (std::size_t column = 0; column < width / points; ++column) {
            const double angle = std::numbers::pi *
                                 static_cast<double>(m * (2 * column + 1) % (2 * width)) /
                                 static_cast<double>(width);
            const double cosine = std::cos(angle), sine = sign * std::sin(angle);
            for (std::size_t k = 3 * column; k < 3 * column + 3; ++k) {
                double* const to = &table[(k / group * order + m) * 2 * group + k % group];
                to[0] = cosine;
                to[group] = sine;
            }
        }
    }
}

void pictureSpectra(const ShortPlan& plan, const SpectrumColumns& columns, const float* rows,
                    std::size_t count, double* out, double* squares) {
    HWY_DYNAMIC_DISPATCH(shortRows)(plan, columns, rows, count, out, squares);
}

double sumPictureRow(const float* row, std::size_t width) {
    return HWY_DYNAMIC_DISPATCH(sum)(row, width);
}

}  // namespace hshfit::inline light
#endif  // HWY_ONCE
