#include <hshfit/representation/halfway/internal/halfway_kernel.h>
#include <hshfit/vector_targets.h>

#include <algorithm>
#include <array>

// Compiled once for every instruction set; the best one is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/representation/halfway/internal/halfway_kernel.cpp"
#include <hwy/foreach_target.h>
// foreach_target.h comes before these.
#include <hwy/aligned_allocator.h>
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<float>;
using Vector = hn::Vec<Lanes>;

/// Vectors of pairs that share every coefficient loaded.
constexpr std::size_t unroll = 2;
constexpr std::size_t block = unroll * hn::MaxLanes(Lanes());

/// Axis values of one block, [function][pair].
struct Axes {
    hwy::AlignedFreeUniquePtr<float[]> memory;
    float *half, *difference, *azimuth, *harmonics, *tau, *kappa, *above;
    float *node, *alongA, *alongB;  ///< of the envelope: the cell's first node, and place in it

    explicit Axes(const HalfwayLayout& layout)
        : memory(hwy::AllocateAligned<float>(block * (layout.half + layout.difference +
                                                      layout.azimuth + 2 * layout.harmonics + 8))) {
        half = memory.get();
        difference = half + block * layout.half;
        azimuth = difference + block * layout.difference;
        harmonics = azimuth + block * layout.azimuth;
        tau = harmonics + 2 * block * (layout.harmonics + 1);
        kappa = tau + block;
        above = kappa + block;
        node = above + block;
        alongA = node + block;
        alongB = alongA + block;
    }
};

/// One block's directions in single precision.
struct Pairs {
    HWY_ALIGN float values[6][block];

    void load(const DirectionBatch& wi, const DirectionBatch& wo, std::size_t first) {
        const double* from[] = {wi.x, wi.y, wi.z, wo.x, wo.y, wo.z};
        const std::size_t count = std::min(block, wi.count - first);
        for (std::size_t c = 0; c < 6; ++c) {
            for (std::size_t k = 0; k < count; ++k) {
                values[c][k] = static_cast<float>(from[c][first + k]);
            }
            for (std::size_t k = count; k < block; ++k) values[c][k] = c % 3 == 2 ? 1.0F : 0.0F;
        }
    }
};

void legendre(const float* steps, Vector x, int count, float* out) {
    const Lanes lanes;
    const Vector one = hn::Set(lanes, 1.0F), t = hn::Sub(hn::Add(x, x), one);
    Vector before = hn::Zero(lanes), now = one;
    for (int n = 0; n < count; ++n) {
        hn::Store(now, lanes, out + block * n);
        const Vector next = hn::NegMulAdd(hn::Set(lanes, steps[2 * n + 1]), before,
                                          hn::Mul(hn::Mul(hn::Set(lanes, steps[2 * n]), t), now));
        before = now;
        now = next;
    }
}

void harmonics(Vector cosine, Vector sine, Vector scale, int count, float* out) {
    const Lanes lanes;
    Vector c = scale, s = hn::Zero(lanes);
    for (int q = 1; q <= count; ++q) {
        const Vector turned = hn::NegMulAdd(s, sine, hn::Mul(c, cosine));
        s = hn::MulAdd(c, sine, hn::Mul(s, cosine));
        c = turned;
        hn::Store(c, lanes, out + 2 * block * q);
        hn::Store(s, lanes, out + 2 * block * q + block);
    }
}

/// halfwayPoint of halfway_terms.h, and the functions along each axis.
void fillAxes(const HalfwayLayout& layout, const Pairs& pairs, std::size_t k, const Axes& axes) {
    const Lanes lanes;
    const auto at = [&](int c) { return hn::Load(lanes, pairs.values[c] + k); };
    const Vector zero = hn::Zero(lanes), one = hn::Set(lanes, 1.0F), two = hn::Set(lanes, 2.0F);
    const Vector tiny = hn::Set(lanes, 1e-30F);
    const Vector mi = hn::Max(at(2), zero), mo = hn::Max(at(5), zero);
    const auto above = hn::And(hn::Gt(at(2), zero), hn::Gt(at(5), zero));
    hn::Store(hn::IfThenElseZero(above, one), lanes, axes.above + k);

    const Vector x = hn::Add(at(0), at(3)), y = hn::Add(at(1), at(4));
    const Vector z = hn::Max(hn::Add(mi, mo), tiny);
    const Vector across = hn::MulAdd(x, x, hn::Mul(y, y));
    const Vector length = hn::Sqrt(hn::MulAdd(z, z, across));
    const Vector oneMinusCosine =
        hn::Div(across, hn::Max(hn::Mul(length, hn::Add(length, z)), tiny));
    const Vector u = hn::Sqrt(hn::Sqrt(hn::Min(oneMinusCosine, one)));
    const Vector v = hn::Min(hn::Div(length, two), one);
    const Vector mean = hn::Mul(hn::Sqrt(mi), hn::Sqrt(mo));
    const Vector inverse = hn::Div(one, z);
    const Vector w = hn::Sqrt(hn::Min(hn::Mul(hn::Add(mean, mean), inverse), one));

    legendre(layout.steps.data(), u, layout.half, axes.half + k);
    legendre(layout.steps.data(), v, layout.difference, axes.difference + k);
    legendre(layout.steps.data(), w, layout.azimuth, axes.azimuth + k);
    hn::Store(hn::Mul(hn::Sub(mo, mi), inverse), lanes, axes.tau + k);
    hn::Store(hn::NegMulAdd(at(1), at(3), hn::Mul(at(0), at(4))), lanes, axes.kappa + k);
    if (layout.turns) {
        const Vector radius = hn::Sqrt(across);
        const auto pole = hn::Le(radius, tiny);
        const Vector cosine = hn::IfThenElse(pole, one, hn::Div(x, hn::Max(radius, tiny)));
        const Vector sine = hn::IfThenZeroElse(pole, hn::Div(y, hn::Max(radius, tiny)));
        harmonics(cosine, sine, hn::Mul(u, u), layout.harmonics, axes.harmonics + k);
    }
}

/// The whole part of x below `last`, and the rest.
Vector cellOf(Vector x, int last, Vector& rest) {
    const Lanes lanes;
    const Vector most = hn::Set(lanes, static_cast<float>(std::max(last - 1, 0)));
    const Vector below = hn::Min(hn::Floor(x), most);
    rest = last > 0 ? hn::Sub(x, below) : hn::Zero(lanes);
    return last > 0 ? below : hn::Zero(lanes);
}

/// HalfwayEnvelope::mixAt: the node of each pair's cell as a number, which is exact.
void fillEnvelope(const HalfwayLayout& layout, const Pairs& pairs, std::size_t k,
                  const Axes& axes) {
    const Lanes lanes;
    const auto at = [&](int c) { return hn::Load(lanes, pairs.values[c] + k); };
    const auto across = [&](int c) {
        return hn::Sqrt(hn::MulAdd(at(c), at(c), hn::Mul(at(c + 1), at(c + 1))));
    };
    const Vector zero = hn::Zero(lanes), one = hn::Set(lanes, 1.0F);
    const Vector high = hn::Sub(at(5), at(2)), wide = hn::Sub(across(3), across(0));
    const Vector chord = hn::MulAdd(high, high, hn::Mul(wide, wide));
    const Vector a = hn::Sqrt(hn::Min(one, hn::Mul(chord, hn::Set(lanes, 0.5F))));
    const Vector b = hn::Sqrt(hn::Sqrt(hn::Min(one, hn::Max(zero, hn::Min(at(2), at(5))))));
    const Vector ridge = hn::Set(lanes, layout.ridge);
    Vector along = hn::Min(one, hn::Div(hn::Mul(a, hn::Add(one, ridge)), hn::Add(a, ridge)));
    if (!layout.reciprocal) {
        const Vector signedAlong = hn::IfThenElse(hn::Lt(high, zero), hn::Neg(along), along);
        along = hn::Mul(hn::Set(lanes, 0.5F), hn::Add(signedAlong, one));
    }
    Vector x, y;
    const int lastA = layout.alongA - 1, lastB = layout.alongB - 1;
    const Vector left = cellOf(hn::Mul(along, hn::Set(lanes, static_cast<float>(lastA))), lastA, x);
    const Vector low = cellOf(hn::Mul(b, hn::Set(lanes, static_cast<float>(lastB))), lastB, y);
    const Vector row = hn::Set(lanes, static_cast<float>(layout.alongA));
    hn::Store(hn::MulAdd(low, row, left), lanes, axes.node + k);
    hn::Store(x, lanes, axes.alongA + k);
    hn::Store(y, lanes, axes.alongB + k);
}

/// E of a channel.
Vector envelopeAt(const HalfwayLayout& layout, const Axes& axes, std::size_t place,
                  std::size_t channel) {
    const Lanes lanes;
    const hn::RebindToSigned<Lanes> whole;
    const auto channels = static_cast<std::int32_t>(layout.channels);
    const auto node = hn::ConvertTo(whole, hn::Load(lanes, axes.node + place));
    const auto first = hn::Mul(node, hn::Set(whole, channels));
    const Vector x = hn::Load(lanes, axes.alongA + place);
    const Vector y = hn::Load(lanes, axes.alongB + place);
    const std::int32_t right = layout.alongA > 1 ? channels : 0;
    const std::int32_t up = layout.alongB > 1 ? layout.alongA * channels : 0;
    const float* logs = layout.logs.data() + channel;
    const auto from = [&](std::int32_t step) {
        return hn::GatherIndex(lanes, logs, hn::Add(first, hn::Set(whole, step)));
    };
    const Vector lower = hn::MulAdd(x, hn::Sub(from(right), from(0)), from(0));
    const Vector upper = hn::MulAdd(x, hn::Sub(from(up + right), from(up)), from(up));
    return hn::Exp(lanes, hn::MulAdd(y, hn::Sub(upper, lower), lower));
}

template <std::size_t Channels>
void sumChannels(const HalfwayLayout& layout, const Axes& axes, std::size_t firstChannel,
                 const float* values, float (*out)[block]) {
    const Lanes lanes;
    const std::size_t step = hn::Lanes(lanes);
    for (std::size_t k = 0; k < block; k += unroll * step) {
        Vector total[Channels][unroll];
        for (auto& row : total) {
            for (auto& t : row) t = hn::Zero(lanes);
        }
        const float* value = values;
        for (const HalfwayLayout::Run& run : layout.runs) {
            Vector part[Channels][unroll];
            for (auto& row : part) {
                for (auto& p : row) p = hn::Zero(lanes);
            }
            for (std::size_t i = 0; i < run.length; ++i, value += Channels) {
                Vector along[unroll];
                for (std::size_t n = 0; n < unroll; ++n) {
                    along[n] = hn::Load(lanes, axes.half + block * i + k + n * step);
                }
                for (std::size_t c = 0; c < Channels; ++c) {
                    const Vector coefficient = hn::Set(lanes, value[c]);
                    for (std::size_t n = 0; n < unroll; ++n) {
                        part[c][n] = hn::MulAdd(coefficient, along[n], part[c][n]);
                    }
                }
            }
            for (std::size_t n = 0; n < unroll; ++n) {
                const std::size_t place = k + n * step;
                Vector factor = hn::Mul(hn::Load(lanes, axes.difference + block * run.j + place),
                                        hn::Load(lanes, axes.azimuth + block * run.k + place));
                if (run.exchange) factor = hn::Mul(factor, hn::Load(lanes, axes.tau + place));
                if (run.mirror) factor = hn::Mul(factor, hn::Load(lanes, axes.kappa + place));
                if (run.q > 0) {
                    const std::size_t row = 2 * run.q + (run.sine ? 1 : 0);
                    factor = hn::Mul(factor, hn::Load(lanes, axes.harmonics + block * row + place));
                }
                for (std::size_t c = 0; c < Channels; ++c) {
                    total[c][n] = hn::MulAdd(part[c][n], factor, total[c][n]);
                }
            }
        }
        for (std::size_t c = 0; c < Channels; ++c) {
            for (std::size_t n = 0; n < unroll; ++n) {
                const std::size_t place = k + n * step;
                Vector f = hn::Max(hn::Zero(lanes), hn::Expm1(lanes, total[c][n]));
                if (!layout.logs.empty()) {
                    f = hn::Min(f, envelopeAt(layout, axes, place, firstChannel + c));
                }
                const auto above = hn::Gt(hn::Load(lanes, axes.above + place), hn::Zero(lanes));
                hn::Store(hn::IfThenElseZero(above, f), lanes, out[c] + place);
            }
        }
    }
}

}  // namespace

void EvaluateHalfway(const HalfwayLayout& layout, const DirectionBatch& wi,
                     const DirectionBatch& wo, std::size_t stride, float* out) {
    const Lanes lanes;
    const Axes axes(layout);
    Pairs pairs;
    HWY_ALIGN float sums[3][block];
    const std::size_t perChannel = layout.values.size() / std::max<std::size_t>(layout.channels, 1);
    for (std::size_t first = 0; first < wi.count; first += block) {
        pairs.load(wi, wo, first);
        for (std::size_t k = 0; k < block; k += hn::Lanes(lanes)) {
            fillAxes(layout, pairs, k, axes);
            if (!layout.logs.empty()) fillEnvelope(layout, pairs, k, axes);
        }
        const std::size_t count = std::min(block, wi.count - first);
        for (std::size_t c = 0; c < layout.channels; c += 3) {
            const float* values = layout.values.data() + c * perChannel;
            const std::size_t group = std::min<std::size_t>(3, layout.channels - c);
            if (group == 3) {
                sumChannels<3>(layout, axes, c, values, sums);
            } else if (group == 2) {
                sumChannels<2>(layout, axes, c, values, sums);
            } else {
                sumChannels<1>(layout, axes, c, values, sums);
            }
            for (std::size_t n = 0; n < group; ++n) {
                std::copy_n(sums[n], count, out + (c + n) * stride + first);
            }
        }
    }
}

}  // namespace hshfit::inline representation::inline halfway::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline representation::inline halfway {

HWY_EXPORT(EvaluateHalfway);

void evaluateHalfwayPairs(const HalfwayLayout& layout, const DirectionBatch& wi,
                          const DirectionBatch& wo, std::size_t stride, float* out) {
    HWY_DYNAMIC_DISPATCH(EvaluateHalfway)(layout, wi, wo, stride, out);
}

}  // namespace hshfit::inline representation::inline halfway
#endif
