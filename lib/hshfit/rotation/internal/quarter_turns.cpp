#include <hshfit/rotation/internal/quarter_turns.h>

#include <hshfit/vector_targets.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/rotation/internal/quarter_turns.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hshfit/bases/vectors-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline rotation {
namespace kernels::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = bases::kernels::HWY_NAMESPACE::Wide<double>;
using V = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

}  // namespace

void rowsOf(int l, const QuarterSteps& steps, double* rows) {
    const Tag tag;
    const std::size_t top = static_cast<std::size_t>(l);
    double* row = rows + rowOffset(top);
    std::fill(std::copy_n(steps.start, top + 1, row), row + padded(top + 1), 0.0);
    const V lane = hn::Iota(tag, 0), width = hn::Set(tag, lanes);
    const double* above = row;  // of no weight for m = l, where carry is 0
    for (std::size_t m = top; m > 0; --m) {
        double* below = rows + rowOffset(m - 1);
        const V slope = hn::Set(tag, steps.slope[m - 1]), carry = hn::Set(tag, steps.carry[m - 1]);
        V column = hn::Mul(slope, lane);
        const V step = hn::Mul(slope, width);
        for (std::size_t k = 0; k < m; k += lanes) {
            const V here = hn::LoadU(tag, row + k), last = hn::LoadU(tag, above + k);
            hn::StoreU(hn::MulAdd(column, here, hn::Mul(carry, last)), tag, below + k);
            column = hn::Add(column, step);
        }
        above = row;
        row = below;
    }
}

namespace {

/// Sums of a vector's lanes of even and of odd index; `parity` is the index of lane 0 modulo 2.
struct Sums {
    double even = 0, odd = 0;
};

HWY_INLINE Sums sumsOf(V values) {
    HWY_ALIGN double lane[lanes];
    hn::Store(values, Tag(), lane);
    Sums sums;
    for (std::size_t i = 0; i < lanes; i += 2) sums.even += lane[i];
    for (std::size_t i = 1; i < lanes; i += 2) sums.odd += lane[i];
    return sums;
}

/// The columns k < m of row m: sums of row[k] in[k], and out[k] += row[k] times `even` or `odd`.
HWY_INLINE Sums rowTimes(std::size_t m, const double* row, const double* in, double even,
                         double odd, double* out) {
    const Tag tag;
    if constexpr (lanes == 1) {
        Sums sums;
        for (std::size_t k = 0; k < m; ++k) {
            (k % 2 == 0 ? sums.even : sums.odd) += row[k] * in[k];
            out[k] += row[k] * (k % 2 == 0 ? even : odd);
        }
        return sums;
    } else {
        HWY_ALIGN double both[lanes];
        for (std::size_t i = 0; i < lanes; ++i) both[i] = i % 2 == 0 ? even : odd;
        const V factor = hn::Load(tag, both);
        V sum = hn::Zero(tag);
        std::size_t k = 0;
        for (; k + lanes <= m; k += lanes) {
            const V r = hn::LoadU(tag, row + k);
            sum = hn::MulAdd(r, hn::LoadU(tag, in + k), sum);
            hn::StoreU(hn::MulAdd(r, factor, hn::LoadU(tag, out + k)), tag, out + k);
        }
        if (k < m) {
            const V r = hn::IfThenElseZero(hn::FirstN(tag, m - k), hn::LoadU(tag, row + k));
            sum = hn::MulAdd(r, hn::LoadU(tag, in + k), sum);
            hn::StoreU(hn::MulAdd(r, factor, hn::LoadU(tag, out + k)), tag, out + k);
        }
        return sumsOf(sum);
    }
}

}  // namespace

void apply(int l, const double* rows, const double* in, double* out) {
    const std::size_t size = padded(static_cast<std::size_t>(l) + 1);
    const double *cosIn = in, *sinIn = in + size;
    double *cosOut = out, *sinOut = out + size;
    std::fill_n(out, 2 * size, 0.0);
    // Parities in x, y and z decide which functions meet. Signs: + between cosines, - between
    // sines. Between a sine and a cosine the sign is + if the larger m is odd, - if it is even.
    for (std::size_t m = 0; m <= static_cast<std::size_t>(l); ++m) {
        const double* row = rows + rowOffset(m);
        const bool evenBand = l % 2 == 0, evenRow = m % 2 == 0;
        const bool cosine = evenBand == evenRow;  // of the functions k < m
        if (evenRow) {
            const double even = cosine ? cosIn[m] : -sinIn[m], odd = cosine ? -sinIn[m] : -cosIn[m];
            const Sums sums =
                rowTimes(m, row, cosine ? cosIn : sinIn, even, odd, cosine ? cosOut : sinOut);
            cosOut[m] += cosine ? sums.even : -sums.odd;
            sinOut[m] -= cosine ? sums.odd : sums.even;
        } else {
            const double even = cosine ? sinIn[m] : cosIn[m], odd = cosine ? cosIn[m] : -sinIn[m];
            const Sums sums =
                rowTimes(m, row, cosine ? cosIn : sinIn, even, odd, cosine ? cosOut : sinOut);
            cosOut[m] += cosine ? sums.odd : sums.even;
            sinOut[m] += cosine ? sums.even : -sums.odd;
        }
        if (cosine)
            cosOut[m] += row[m] * cosIn[m];
        else
            sinOut[m] -= row[m] * sinIn[m];
    }
}

}  // namespace kernels::HWY_NAMESPACE
}  // namespace hshfit::inline rotation
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline rotation {
namespace kernels {

HWY_EXPORT(rowsOf);
HWY_EXPORT(apply);

QuarterTables::QuarterTables(int order) {
    assert(order >= 1 && order <= 1020);
    long double first = 2;  // 2^(1-l) sqrt(binomial(2l, l))
    for (int l = 0; l < order; ++l) {
        if (l > 0) first *= std::sqrt((2.0L * l - 1) / (2.0L * l));
        long double value = first;
        for (int k = 0; k <= l; ++k) {
            start_.push_back(static_cast<double>(value));
            value *= std::sqrt(static_cast<long double>(l - k) / (l + k + 1));
        }
        const auto g = [l](int m) { return std::sqrt((l + m) * (l - m + 1.0L)); };
        for (int m = 1; m <= l; ++m) {
            slope_.push_back(static_cast<double>(-2 / g(m)));
            carry_.push_back(static_cast<double>(-g(m + 1) / g(m)));
        }
    }
}

QuarterSteps QuarterTables::steps(int l) const {
    const auto before = static_cast<std::size_t>(l) * static_cast<std::size_t>(l + 1) / 2;
    const std::size_t steps = before - static_cast<std::size_t>(l);
    return {start_.data() + before, slope_.data() + steps, carry_.data() + steps};
}

void quarterRows(int l, const QuarterSteps& steps, double* rows) {
    HWY_DYNAMIC_DISPATCH(rowsOf)(l, steps, rows);
}

void applyQuarter(int l, const double* rows, const double* in, double* out) {
    HWY_DYNAMIC_DISPATCH(apply)(l, rows, in, out);
}

}  // namespace kernels
}  // namespace hshfit::inline rotation
#endif
