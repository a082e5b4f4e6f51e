#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/transfer/internal/shading_kernels.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/transfer/internal/shading_kernels.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline transfer {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Wide = hn::CappedTag<float, 16>;
using Single = hn::CappedTag<float, 1>;

/// `parts` vectors of vertices from v on: sums that do not wait for each other.
template <std::size_t parts, class D>
HWY_INLINE void dotsAt(D d, const DotJob& job, std::size_t v) {
    const std::size_t lanes = hn::Lanes(d);
    hn::Vec<D> sums[parts];
    for (std::size_t p = 0; p < parts; ++p) sums[p] = hn::Zero(d);
    for (std::size_t i = 0; i < job.slots; ++i) {
        const float* light = job.light + i * job.vertices + v;
        const float* brdf = job.brdf + i * job.slotStep + (job.perVertex ? v : 0);
        for (std::size_t p = 0; p < parts; ++p) {
            const auto c = job.perVertex ? hn::LoadU(d, brdf + p * lanes) : hn::Set(d, *brdf);
            sums[p] = hn::MulAdd(c, hn::LoadU(d, light + p * lanes), sums[p]);
        }
    }
    for (std::size_t p = 0; p < parts; ++p) hn::StoreU(sums[p], d, job.out + v + p * lanes);
}

void dots(const DotJob& job) {
    const Wide d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t v = 0;
    for (; v + 4 * lanes <= job.vertices; v += 4 * lanes) dotsAt<4>(d, job, v);
    for (; v + lanes <= job.vertices; v += lanes) dotsAt<1>(d, job, v);
    for (; v < job.vertices; ++v) dotsAt<1>(Single(), job, v);
}

/// The elevation below each view and the share of the one above it: radii are
/// tan(theta / 2) = k / (N - 1/2), and the last one holds to the horizon.
template <class D>
struct Place {
    hn::Vec<hn::RebindToSigned<D>> index;
    hn::Vec<D> share;
};

template <class D>
HWY_INLINE Place<D> placeOf(D d, const TableJob& job, hn::Vec<D> z) {
    const hn::RebindToSigned<D> whole;
    const auto one = hn::Set(d, 1.0f), zero = hn::Zero(d);
    const auto height = hn::Min(hn::Max(z, zero), one);
    const auto tangent = hn::Sqrt(hn::Div(hn::Sub(one, height), hn::Add(one, height)));
    const float last = static_cast<float>(job.elevations - 1);
    const auto at = hn::Min(hn::Mul(tangent, hn::Set(d, last + 0.5f)), hn::Set(d, last));
    const auto index = hn::ConvertTo(whole, at);
    return {index, hn::Sub(at, hn::ConvertTo(d, index))};
}

/// All channels of one vector of vertices.
template <class D>
HWY_INLINE void tableAt(D d, const TableJob& job, std::size_t v) {
    const auto zero = hn::Zero(d);
    const auto z = hn::LoadU(d, job.views.z + v);
    const auto cosine = hn::LoadU(d, job.views.cosine + v);
    const auto sine = hn::LoadU(d, job.views.sine + v);
    const Place<D> place = placeOf(d, job, z);
    const std::size_t row = job.elevations + 1, vertices = job.views.vertices;
    const auto slots = static_cast<std::size_t>(job.order) * static_cast<std::size_t>(job.order);
    for (std::size_t channel = 0; channel < job.channels; ++channel) {
        const float* table = job.table + channel * slots * row;
        const float* light = job.light + channel * slots * vertices + v;
        const auto coefficient = [&](int slot) HWY_ATTR {
            const float* at = table + static_cast<std::size_t>(slot) * row;
            const auto below = hn::GatherIndex(d, at, place.index);
            const auto above = hn::GatherIndex(d, at + 1, place.index);
            return hn::MulAdd(place.share, hn::Sub(above, below), below);
        };
        const auto lightAt = [&](int slot) HWY_ATTR {
            return hn::LoadU(d, light + static_cast<std::size_t>(slot) * vertices);
        };
        auto sum = zero, c = hn::Set(d, 1.0f), s = zero;
        for (int m = 0; m < job.order; ++m) {
            // B(phi - t): c_m takes cos(m t) L_m + sin(m t) L_-m, and c_-m the turned pair.
            auto even = zero, odd = zero;
            for (int l = m; l < job.order; ++l) {
                const int slot = slotOf(l, m), other = slotOf(l, -m);
                const auto value = coefficient(slot);
                even = hn::MulAdd(value, lightAt(slot), even);
                if (m > 0) odd = hn::MulAdd(value, lightAt(other), odd);
                if (m > 0 && !job.bilateral) {
                    const auto second = coefficient(other);
                    even = hn::MulAdd(second, lightAt(other), even);
                    odd = hn::NegMulAdd(second, lightAt(slot), odd);
                }
            }
            sum = hn::MulAdd(c, even, hn::MulAdd(s, odd, sum));
            const auto next = hn::NegMulAdd(s, sine, hn::Mul(c, cosine));
            s = hn::MulAdd(s, cosine, hn::Mul(c, sine));
            c = next;
        }
        sum = hn::IfThenElse(hn::Gt(z, zero), sum, zero);
        hn::StoreU(sum, d, job.out + channel * vertices + v);
    }
}

void table(const TableJob& job) {
    const Wide d;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t v = 0;
    for (; v + lanes <= job.views.vertices; v += lanes) tableAt(d, job, v);
    for (; v < job.views.vertices; ++v) tableAt(Single(), job, v);
}

}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline transfer
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline transfer {

HWY_EXPORT(dots);
HWY_EXPORT(table);

void shadeDots(const DotJob& job) {
    HWY_DYNAMIC_DISPATCH(dots)(job);
}

void shadeTable(const TableJob& job) {
    HWY_DYNAMIC_DISPATCH(table)(job);
}

}  // namespace hshfit::inline transfer
#endif  // HWY_ONCE
