// The rates at which a core computes and reads, in vectors. Included by machine.cpp once for each
// instruction set.

#include <hwy/highway.h>

#include <cstddef>

HWY_BEFORE_NAMESPACE();
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// More chains than latency times units need (10 on today's cores), fewer than registers.
constexpr std::size_t chains = 12;

/// Returns the number of floating-point operations. Every chain tends to 2, far from subnormal
/// numbers, and has its own start, so that no compiler can merge two of them.
template <class Real>
double fmaChains() {
    constexpr std::size_t steps = 4096;
    const hn::ScalableTag<Real> tag;
    const auto factor = hn::Set(tag, Real(0.5)), added = hn::Set(tag, Real(1));
    const auto start = [&](int number) HWY_ATTR { return hn::Set(tag, static_cast<Real>(number)); };
    auto a = start(1), b = start(3), c = start(4), d = start(5), e = start(6), f = start(7);
    auto g = start(8), h = start(9), i = start(10), j = start(11), k = start(12), l = start(13);
    for (std::size_t step = 0; step < steps; ++step) {
        a = hn::MulAdd(a, factor, added), b = hn::MulAdd(b, factor, added);
        c = hn::MulAdd(c, factor, added), d = hn::MulAdd(d, factor, added);
        e = hn::MulAdd(e, factor, added), f = hn::MulAdd(f, factor, added);
        g = hn::MulAdd(g, factor, added), h = hn::MulAdd(h, factor, added);
        i = hn::MulAdd(i, factor, added), j = hn::MulAdd(j, factor, added);
        k = hn::MulAdd(k, factor, added), l = hn::MulAdd(l, factor, added);
    }
    for (const auto& other : {b, c, d, e, f, g, h, i, j, k, l}) a = hn::Add(a, other);
    volatile Real kept = hn::GetLane(a);
    static_cast<void>(kept);
    return 2.0 * chains * steps * static_cast<double>(hn::Lanes(tag));
}

double fmaChainsDouble() {
    return fmaChains<double>();
}
double fmaChainsFloat() {
    return fmaChains<float>();
}

/// The sum of `count` numbers, a multiple of 64.
double sumOf(const double* values, std::size_t count) {
    const hn::ScalableTag<double> tag;
    const std::size_t lanes = hn::Lanes(tag);
    auto a = hn::Zero(tag), b = a, c = a, d = a;
    for (std::size_t k = 0; k < count; k += 4 * lanes) {
        a = hn::Add(a, hn::LoadU(tag, values + k));
        b = hn::Add(b, hn::LoadU(tag, values + k + lanes));
        c = hn::Add(c, hn::LoadU(tag, values + k + 2 * lanes));
        d = hn::Add(d, hn::LoadU(tag, values + k + 3 * lanes));
    }
    return hn::GetLane(hn::SumOfLanes(tag, hn::Add(hn::Add(a, b), hn::Add(c, d))));
}

/// The count is a multiple of 64, as for sumOf.
void copyOf(const double* from, std::size_t count, double* to) {
    const hn::ScalableTag<double> tag;
    const std::size_t lanes = hn::Lanes(tag);
    for (std::size_t k = 0; k < count; k += 2 * lanes) {
        hn::StoreU(hn::LoadU(tag, from + k), tag, to + k);
        hn::StoreU(hn::LoadU(tag, from + k + lanes), tag, to + k + lanes);
    }
}

}  // namespace HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
