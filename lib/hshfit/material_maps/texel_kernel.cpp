#include <hshfit/vector_targets.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hshfit/material_maps/texel_kernel.cpp"
#include <hwy/foreach_target.h>

#include <hshfit/material_maps/texel_kernel.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <Imath/half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#ifndef HSHFIT_TEXEL_MIXTURE
#define HSHFIT_TEXEL_MIXTURE
namespace hshfit::inline material_maps {

/// The lobes of a texel and how they make its channels.
struct Mixture {
    const float* shapes;   ///< [place][lobe][outgoing][slot]
    std::size_t pitch;     ///< from the shapes of a channel to the next channel's; 0: one for all
    const float* weights;  ///< [lobe][channel]
    std::size_t lobes, channels, outgoing, slots, stride;
};

}  // namespace hshfit::inline material_maps
#endif

HWY_BEFORE_NAMESPACE();
namespace hshfit::inline material_maps {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;

/// sum[i] = sum over the nodes of a place of weight * row[i]; both have room beyond `count`.
void interpolate(const float* values, std::size_t stride, const LobeGrid::Place& place,
                 std::size_t count, float* sum) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < count; i += lanes) {
        auto total = hn::Zero(d);
        for (std::uint32_t k = 0; k < place.count; ++k) {
            total = hn::MulAdd(hn::Set(d, place.weight[k]),
                               hn::LoadU(d, values + place.row[k] * stride + i), total);
        }
        hn::StoreU(total, d, sum + i);
    }
}

/// to[i] = sum over lobes of weight[lobe * step] * shape[lobe * length + i], i < count, and beyond
/// it up to a vector.
void combine(const float* shape, std::size_t length, const float* weight, std::size_t step,
             std::size_t lobes, std::size_t count, float* to) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < count; i += lanes) {
        auto total = hn::Zero(d);
        for (std::size_t k = 0; k < lobes; ++k) {
            total = hn::MulAdd(hn::Set(d, weight[k * step]), hn::LoadU(d, shape + k * length + i),
                               total);
        }
        hn::StoreU(total, d, to + i);
    }
}

/// A whole texel. Vectors write beyond the slots of a channel, over values that come later.
void mix(const Mixture& m, float* texel) {
    for (std::size_t o = 0; o < m.outgoing; ++o) {
        float* to = texel + o * m.stride;
        for (std::size_t c = 0; c < m.channels; ++c) {
            combine(m.shapes + c * m.pitch + o * m.slots, m.outgoing * m.slots, m.weights + c,
                    m.channels, m.lobes, m.slots, to + c * m.slots);
        }
        std::fill(to + m.channels * m.slots, to + m.stride, 0.0F);
    }
}

/// Where the processor has no instruction for it, Highway cuts halves off.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_NEON
constexpr bool halvesAreNearest = true;
#else
constexpr bool halvesAreNearest = false;
#endif

/// Floats of one texel as halves, with the largest magnitude and whether all are numbers.
template <class D>
std::size_t toHalves(D d, const float* from, std::size_t first, std::size_t count,
                     std::uint16_t* to, float& most, bool& numbers) {
    const hn::Rebind<hwy::float16_t, D> half;
    const std::size_t lanes = hn::Lanes(d);
    auto largest = hn::Zero(d);
    auto ordered = hn::Eq(largest, largest);
    for (; first + lanes <= count; first += lanes) {
        const auto value = hn::LoadU(d, from + first);
        largest = hn::Max(largest, hn::Abs(value));
        ordered = hn::And(ordered, hn::Eq(value, value));
        if constexpr (halvesAreNearest)
            hn::StoreU(hn::DemoteTo(half, value), half,
                       reinterpret_cast<hwy::float16_t*>(to + first));
        else
            for (std::size_t k = first; k < first + lanes; ++k) to[k] = Imath::half(from[k]).bits();
    }
    most = std::max(most, hn::GetLane(hn::MaxOfLanes(d, largest)));
    numbers = numbers && hn::AllTrue(d, ordered);
    return first;
}

/// Four halves of each of `count` texels, `step` apart, one after another. Whole lines of the cache
/// are written past it: nobody reads them before the disk does.
void storeLayer(const std::uint16_t* from, std::size_t step, std::size_t count, std::uint16_t* to) {
    constexpr std::size_t line = 8;
    if (count != line || reinterpret_cast<std::uintptr_t>(to) % 64 != 0) {
        for (std::size_t k = 0; k < count; ++k) std::memcpy(to + 4 * k, from + k * step, 8);
        return;
    }
    alignas(64) std::uint64_t texels[line];
    for (std::size_t k = 0; k < line; ++k) std::memcpy(texels + k, from + k * step, 8);
    const hn::CappedTag<std::uint64_t, line> d;
    for (std::size_t k = 0; k < line; k += hn::Lanes(d))
        hn::Stream(hn::Load(d, texels + k), d, reinterpret_cast<std::uint64_t*>(to) + k);
}

/// Several texels at a time, so that layers get whole lines of the cache.
HalfRange halfLayers(const float* texels, std::size_t stride, std::size_t count, std::size_t layers,
                     std::uint16_t* out, std::size_t pitch) {
    constexpr std::size_t group = 8;
    const std::size_t floats = 4 * layers;
    std::vector<std::uint16_t> halves(group * floats);
    float most = 0;
    bool numbers = true;
    for (std::size_t t = 0; t < count; t += group) {
        const std::size_t together = std::min(group, count - t);
        for (std::size_t k = 0; k < together; ++k) {
            const float* from = texels + (t + k) * stride;
            std::uint16_t* to = halves.data() + k * floats;
            const std::size_t done = toHalves(Tag(), from, 0, floats, to, most, numbers);
            toHalves(hn::CappedTag<float, 4>(), from, done, floats, to, most, numbers);
        }
        for (std::size_t layer = 0; layer < layers; ++layer)
            storeLayer(halves.data() + 4 * layer, floats, together, out + 4 * (layer * pitch + t));
    }
    hwy::FlushStream();
    return {most, numbers && most <= std::numeric_limits<float>::max()};
}

void means(const float* above, const float* below, std::size_t count, std::size_t step,
           float* out) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const auto share = hn::Set(d, 0.25F);
    for (std::size_t t = 0; t < count; ++t) {
        const float* a = above + 2 * t * step;
        const float* b = below + 2 * t * step;
        std::size_t k = 0;
        for (; k + lanes <= step; k += lanes) {
            auto sum = hn::Add(hn::LoadU(d, a + k), hn::LoadU(d, a + step + k));
            sum = hn::Add(sum, hn::LoadU(d, b + k));
            sum = hn::Add(sum, hn::LoadU(d, b + step + k));
            hn::StoreU(hn::Mul(sum, share), d, out + t * step + k);
        }
        for (; k < step; ++k) out[t * step + k] = (a[k] + a[step + k] + b[k] + b[step + k]) * 0.25F;
    }
}

float project(const float* directions, std::size_t count, std::size_t length, const float* x,
              float* y) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t r = 0; r < count; ++r) {
        auto sum = hn::Zero(d);
        for (std::size_t i = 0; i < length; i += lanes) {
            sum = hn::MulAdd(hn::LoadU(d, directions + r * length + i), hn::LoadU(d, x + i), sum);
        }
        y[r] = hn::GetLane(hn::SumOfLanes(d, sum));
    }
    auto square = hn::Zero(d);
    for (std::size_t i = 0; i < length; i += lanes) {
        auto left = hn::LoadU(d, x + i);
        for (std::size_t r = 0; r < count; ++r) {
            left = hn::NegMulAdd(hn::Set(d, y[r]), hn::LoadU(d, directions + r * length + i), left);
        }
        square = hn::MulAdd(left, left, square);
    }
    return hn::GetLane(hn::SumOfLanes(d, square));
}

/// The nearest of points in columns; `count` is a multiple of 16.
Nearest nearestOf(const float* columns, std::size_t dimensions, std::size_t count,
                  const float* point) {
    const Tag d;
    const hn::RebindToUnsigned<Tag> whole;
    const std::size_t lanes = hn::Lanes(d);
    auto best = hn::Set(d, std::numeric_limits<float>::max());
    auto bestIndex = hn::Zero(whole);
    const auto consider = [&](auto square, std::size_t first) HWY_ATTR {
        const auto nearer = hn::Lt(square, best);
        best = hn::IfThenElse(nearer, square, best);
        bestIndex = hn::IfThenElse(hn::RebindMask(whole, nearer),
                                   hn::Set(whole, static_cast<std::uint32_t>(first)), bestIndex);
    };
    std::size_t i = 0;
    // Four sums at a time, none of which waits for another.
    for (; i + 4 * lanes <= count; i += 4 * lanes) {
        auto a = hn::Zero(d), b = hn::Zero(d), c = hn::Zero(d), e = hn::Zero(d);
        for (std::size_t k = 0; k < dimensions; ++k) {
            const float* from = columns + k * count + i;
            const auto at = hn::Set(d, point[k]);
            const auto offA = hn::Sub(hn::LoadU(d, from), at);
            const auto offB = hn::Sub(hn::LoadU(d, from + lanes), at);
            const auto offC = hn::Sub(hn::LoadU(d, from + 2 * lanes), at);
            const auto offE = hn::Sub(hn::LoadU(d, from + 3 * lanes), at);
            a = hn::MulAdd(offA, offA, a);
            b = hn::MulAdd(offB, offB, b);
            c = hn::MulAdd(offC, offC, c);
            e = hn::MulAdd(offE, offE, e);
        }
        consider(a, i);
        consider(b, i + lanes);
        consider(c, i + 2 * lanes);
        consider(e, i + 3 * lanes);
    }
    for (; i < count; i += lanes) {
        auto square = hn::Zero(d);
        for (std::size_t k = 0; k < dimensions; ++k) {
            const auto off = hn::Sub(hn::LoadU(d, columns + k * count + i), hn::Set(d, point[k]));
            square = hn::MulAdd(off, off, square);
        }
        consider(square, i);
    }
    float squares[16];
    std::uint32_t starts[16];
    hn::StoreU(best, d, squares);
    hn::StoreU(bestIndex, whole, starts);
    Nearest nearest{starts[0], squares[0]};
    for (std::uint32_t k = 1; k < lanes; ++k) {
        const std::uint32_t index = starts[k] + k;
        if (squares[k] < nearest.square || (squares[k] == nearest.square && index < nearest.index))
            nearest = {index, squares[k]};
    }
    return nearest;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace hshfit::inline material_maps
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace hshfit::inline material_maps {

HWY_EXPORT(interpolate);
HWY_EXPORT(mix);
HWY_EXPORT(halfLayers);
HWY_EXPORT(means);
HWY_EXPORT(project);
HWY_EXPORT(nearestOf);

namespace {
constexpr std::size_t slack = 16;  // floats of the widest vector
}

TexelKernel::TexelKernel(const LobeGrid& table, const TexelLayout& layout, bool placesByChannel)
    : table_(table), layout_(layout), placesByChannel_(placesByChannel) {}

void TexelKernel::run(const TexelBlock& block, std::size_t first, std::size_t count,
                      float* out) const {
    const std::size_t channels = layout_.channels;
    const std::size_t lobes = table_.lobes(), shape = layout_.shape();
    const std::size_t places = placesByChannel_ ? channels : 1;
    const std::size_t shapesLength = lobes * shape + slack;
    std::vector<float> shapes(places * shapesLength), weights(lobes * channels);
    const std::size_t floats = layout_.floats();
    std::vector<float> copy(floats + slack);
    float p[3];
    LobeGrid::Place place;
    const Mixture mixture{.shapes = shapes.data(),
                          .pitch = places > 1 ? shapesLength : 0,
                          .weights = weights.data(),
                          .lobes = lobes,
                          .channels = channels,
                          .outgoing = layout_.outgoing.size(),
                          .slots = layout_.slots.size(),
                          .stride = layout_.stride()};
    for (std::size_t t = 0; t < count; ++t) {
        for (std::size_t k = 0; k < weights.size(); ++k)
            weights[k] = block.weights[k * block.count + first + t];
        for (std::size_t c = 0; c < places; ++c) {
            for (std::size_t a = 0; a < table_.axes(); ++a)
                p[a] = block.places[(a * places + c) * block.count + first + t];
            table_.find(p, place);
            HWY_DYNAMIC_DISPATCH(interpolate)
            (table_.values().data(), table_.rowStride(), place, lobes * shape,
             shapes.data() + c * shapesLength);
        }
        // Vectors write beyond a texel: into the texels that come next, or into a copy near the
        // end.
        float* const to = out + t * floats;
        const bool room = (count - t - 1) * floats >= slack;
        HWY_DYNAMIC_DISPATCH(mix)(mixture, room ? to : copy.data());
        if (!room) std::copy_n(copy.data(), floats, to);
    }
}

HalfRange toHalfLayers(const float* texels, std::size_t stride, std::size_t count,
                       std::size_t layers, std::uint16_t* out, std::size_t pitch) {
    return HWY_DYNAMIC_DISPATCH(halfLayers)(texels, stride, count, layers, out, pitch);
}

void meanOfFour(const float* above, const float* below, std::size_t count, std::size_t step,
                float* out) {
    HWY_DYNAMIC_DISPATCH(means)(above, below, count, step, out);
}

float projectOnto(const float* directions, std::size_t count, std::size_t length, const float* x,
                  float* y) {
    return HWY_DYNAMIC_DISPATCH(project)(directions, count, length, x, y);
}

NearestPoint::NearestPoint(std::span<const float> points, std::size_t dimensions)
    : dimensions_(dimensions),
      count_(points.size() / dimensions),
      padded_((count_ + 15) / 16 * 16),
      columns_(padded_ * dimensions, 1e18F) {
    for (std::size_t i = 0; i < count_; ++i)
        for (std::size_t k = 0; k < dimensions_; ++k)
            columns_[k * padded_ + i] = points[i * dimensions_ + k];
}

Nearest NearestPoint::operator()(const float* point) const {
    return HWY_DYNAMIC_DISPATCH(nearestOf)(columns_.data(), dimensions_, padded_, point);
}

}  // namespace hshfit::inline material_maps
#endif
