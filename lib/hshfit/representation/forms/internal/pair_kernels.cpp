#include <hshfit/representation/forms/internal/pair_kernels.h>
#include <hshfit/vector_targets.h>

// Compiled once for every instruction set; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/representation/forms/internal/pair_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline representation::inline forms::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::CappedTag<float, pairPadding>;
using Vector = hn::Vec<Lanes>;

/// `Channels` accumulators for one vector of pairs.
template <std::size_t Channels>
void sumChannels(const BilinearForm& form, std::size_t first, const float* rows,
                 const float* columns, std::size_t count, float* out) {
    const Lanes lanes;
    for (std::size_t k = 0; k < count; k += hn::Lanes(lanes)) {
        Vector total[Channels];
        for (auto& t : total) t = hn::Zero(lanes);
        for (std::size_t r = 0; r < form.rows.size(); ++r) {
            Vector part[Channels];
            for (auto& p : part) p = hn::Zero(lanes);
            for (std::size_t e = form.rowStarts[r]; e < form.rowStarts[r + 1]; ++e) {
                const Vector column = hn::LoadU(lanes, columns + form.columns[e] * count + k);
                const float* value = form.values.data() + e * form.channels + first;
                for (std::size_t c = 0; c < Channels; ++c) {
                    part[c] = hn::MulAdd(hn::Set(lanes, value[c]), column, part[c]);
                }
            }
            const Vector row = hn::LoadU(lanes, rows + form.rows[r] * count + k);
            for (std::size_t c = 0; c < Channels; ++c) {
                total[c] = hn::MulAdd(part[c], row, total[c]);
            }
        }
        for (std::size_t c = 0; c < Channels; ++c) {
            hn::StoreU(total[c], lanes, out + (first + c) * count + k);
        }
    }
}

void SumBilinear(const BilinearForm& form, const float* rows, const float* columns,
                 std::size_t count, float* out) {
    std::size_t first = 0;
    for (; first + 3 <= form.channels; first += 3) {
        sumChannels<3>(form, first, rows, columns, count, out);
    }
    for (; first < form.channels; ++first) {
        sumChannels<1>(form, first, rows, columns, count, out);
    }
}

/// One pair and `Channels` channels from number `c` on: a sum for each row and channel, which are
/// mixed at the end.
template <std::size_t Rows, std::size_t Channels>
HWY_INLINE void dotOne(const MixedDots& dots, const RowMix& mix, const float* basis, std::size_t c,
                       float* out) {
    const Lanes lanes;
    const std::size_t n = hn::Lanes(lanes);
    const float* rows[Rows];
    for (std::size_t r = 0; r < Rows; ++r) rows[r] = mix.rows[r] + c * dots.stride;
    Vector sums[Rows][Channels];
    for (auto& row : sums)
        for (Vector& sum : row) sum = hn::Zero(lanes);
    const auto add = [&](Vector value, std::size_t i) HWY_ATTR {
        for (std::size_t r = 0; r < Rows; ++r)
            for (std::size_t k = 0; k < Channels; ++k)
                sums[r][k] =
                    hn::MulAdd(value, hn::LoadU(lanes, rows[r] + k * dots.stride + i), sums[r][k]);
    };
    std::size_t i = 0;
    for (; i + n <= dots.length; i += n) add(hn::LoadU(lanes, basis + i), i);
    if (i < dots.length) {
        // Masked loads may read all lanes, and on some targets want them aligned.
        HWY_ALIGN float rest[pairPadding] = {};
        for (std::size_t k = i; k < dots.length; ++k) rest[k - i] = basis[k];
        add(hn::Load(lanes, rest), i);
    }
    for (std::size_t k = 0; k < Channels; ++k) {
        Vector total = hn::Mul(hn::Set(lanes, mix.weights[0]), sums[0][k]);
        for (std::size_t r = 1; r < Rows; ++r)
            total = hn::MulAdd(hn::Set(lanes, mix.weights[r]), sums[r][k], total);
        out[(c + k) * dots.outStride] = hn::GetLane(hn::SumOfLanes(lanes, total));
    }
}

template <std::size_t Rows>
HWY_INLINE void dotAll(const MixedDots& dots, const RowMix& mix, const float* basis, float* out) {
    std::size_t c = 0;
    for (; c + 3 <= dots.channels; c += 3) dotOne<Rows, 3>(dots, mix, basis, c, out);
    for (; c < dots.channels; ++c) dotOne<Rows, 1>(dots, mix, basis, c, out);
}

void DotMixed(const MixedDots& dots, const RowMix* mixes, float* out) {
    for (std::size_t k = 0; k < dots.count; ++k) {
        const float* basis = dots.basis + k * dots.length;
        switch (mixes[k].count) {
            case 1:
                dotAll<1>(dots, mixes[k], basis, out + k);
                break;
            case 2:
                dotAll<2>(dots, mixes[k], basis, out + k);
                break;
            case 3:
                dotAll<3>(dots, mixes[k], basis, out + k);
                break;
            default:
                dotAll<4>(dots, mixes[k], basis, out + k);
                break;
        }
    }
}

}  // namespace hshfit::inline representation::inline forms::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline forms {

HWY_EXPORT(SumBilinear);
HWY_EXPORT(DotMixed);

void sumBilinear(const BilinearForm& form, const float* rows, const float* columns,
                 std::size_t count, float* out) {
    HWY_DYNAMIC_DISPATCH(SumBilinear)(form, rows, columns, count, out);
}

void dotMixed(const MixedDots& dots, const RowMix* mixes, float* out) {
    HWY_DYNAMIC_DISPATCH(DotMixed)(dots, mixes, out);
}

}  // namespace hshfit::inline representation::inline forms
#endif
