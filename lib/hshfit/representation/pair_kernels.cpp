#include <hshfit/representation/pair_kernels.h>

// Compiled once for every instruction set; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/representation/pair_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::HWY_NAMESPACE {

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

void DotMixed(const RowMix& mix, const float* basis, std::size_t length, std::size_t channels,
              float* out) {
    const Lanes lanes;
    for (std::size_t c = 0; c < channels; ++c) {
        Vector sum = hn::Zero(lanes);
        for (std::size_t k = 0; k < length; k += hn::Lanes(lanes)) {
            Vector mixed = hn::Mul(hn::Set(lanes, mix.weights[0]),
                                   hn::LoadU(lanes, mix.rows[0] + c * length + k));
            for (int r = 1; r < mix.count; ++r) {
                mixed = hn::MulAdd(hn::Set(lanes, mix.weights[r]),
                                   hn::LoadU(lanes, mix.rows[r] + c * length + k), mixed);
            }
            sum = hn::MulAdd(mixed, hn::LoadU(lanes, basis + k), sum);
        }
        out[c] = hn::GetLane(hn::SumOfLanes(lanes, sum));
    }
}

}  // namespace hshfit::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit {

HWY_EXPORT(SumBilinear);
HWY_EXPORT(DotMixed);

void sumBilinear(const BilinearForm& form, const float* rows, const float* columns,
                 std::size_t count, float* out) {
    HWY_DYNAMIC_DISPATCH(SumBilinear)(form, rows, columns, count, out);
}

void dotMixed(const RowMix& mix, const float* basis, std::size_t length, std::size_t channels,
              float* out) {
    HWY_DYNAMIC_DISPATCH(DotMixed)(mix, basis, length, channels, out);
}

}  // namespace hshfit
#endif
