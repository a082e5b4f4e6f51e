// Vector code of material maps on every instruction set, against plain loops, with texels that end
// where memory does.

#include <guarded_array.h>
#include <vector_targets.h>

#include <hshfit/material_maps/texel_kernel.h>

#include <Imath/half.h>
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace hshfit {
namespace {

using test::forEveryTarget;
using test::GuardedArray;
using test::Side;

constexpr Side sides[] = {Side::front, Side::back};
constexpr std::size_t mostCount = 33;  // two vectors of floats and one more

double numberAt(std::size_t k) {
    return std::sin(0.3 + 1.7 * static_cast<double>(k));
}

/// Value i of the lobes at p: a cubic, which the table interpolates exactly.
double lobeAt(std::size_t i, double p) {
    return numberAt(i) + p * (numberAt(i + 1) + p * (numberAt(i + 2) + p * numberAt(i + 3)));
}

/// Few outgoing directions and functions make texels that are shorter than a vector.
void checkTexels(std::size_t outgoing, std::size_t slots, std::size_t channels, std::size_t lobes,
                 bool placesByChannel) {
    SCOPED_TRACE(
        fmt::format("{} directions, {} functions, {} channels", outgoing, slots, channels));
    TexelLayout layout{.outgoing = OutgoingSet::elevations(static_cast<int>(outgoing)),
                       .slots = std::vector<int>(slots),
                       .channels = channels};
    std::iota(layout.slots.begin(), layout.slots.end(), 0);
    const std::size_t shape = layout.shape(), floats = layout.floats();
    const LobeGrid table({.axes = {{.name = "p", .low = 0, .high = 1}},
                          .lobes = lobes,
                          .length = shape,
                          .at =
                              [&](std::span<const double> p) {
                                  std::vector<double> values;
                                  for (std::size_t i = 0; i < lobes * shape; ++i)
                                      values.push_back(lobeAt(i, p[0]));
                                  return values;
                              },
                          .weights = std::vector<double>(shape, 1)});
    const TexelKernel kernel(table, layout, placesByChannel);
    for (std::size_t count = 1; count <= mostCount; ++count) {
        TexelBlock block{.count = count};
        for (std::size_t k = 0; k < count * kernel.weightsOfTexel(); ++k)
            block.weights.push_back(static_cast<float>(numberAt(k)));
        for (std::size_t k = 0; k < count * kernel.placesOfTexel(); ++k)
            block.places.push_back(static_cast<float>(std::abs(numberAt(k))));
        for (const Side side : sides) {
            GuardedArray<float> out(count * floats, side);
            kernel.run(block, 0, count, out.data());
            for (std::size_t t = 0; t < count; ++t)
                for (std::size_t i = 0; i < floats; ++i) {
                    const std::size_t lane = i % layout.stride(), c = lane / slots;
                    double sum = 0;
                    for (std::size_t k = 0; k < lobes && c < channels; ++k) {
                        const std::size_t place = placesByChannel ? c : 0;
                        sum += double{block.weights[(k * channels + c) * count + t]} *
                               lobeAt(k * shape + i / layout.stride() * slots + lane % slots,
                                      double{block.places[place * count + t]});
                    }
                    ASSERT_NEAR(out[t * floats + i], sum, 1e-5)
                        << "number " << i << " of texel " << t << " of " << count;
                }
        }
    }
}

TEST(TexelKernel, TexelsOfAnySizeStayWithinTheirBlock) {
    forEveryTarget([] {
        for (const std::size_t outgoing : {2, 3, 5})
            for (const std::size_t slots : {1, 3, 4, 9, 16, 17})
                for (const std::size_t channels : {1, 3})
                    checkTexels(outgoing, slots, channels, 2, channels == 3);
    });
}

TEST(TexelKernel, HalvesStayWithinTheirLayers) {
    forEveryTarget([] {
        for (const std::size_t layers : {1, 2, 3, 4, 5, 8, 9})
            for (std::size_t count = 1; count <= mostCount; ++count)
                for (const Side side : sides) {
                    const GuardedArray<float> texels(count * 4 * layers, side, numberAt);
                    GuardedArray<std::uint16_t> out(count * 4 * layers, side);
                    const HalfRange range =
                        toHalfLayers(texels.data(), 4 * layers, count, layers, out.data(), count);
                    float largest = 0;
                    for (std::size_t k = 0; k < texels.size(); ++k) {
                        largest = std::max(largest, std::abs(texels[k]));
                        const std::size_t texel = k / (4 * layers), layer = k / 4 % layers;
                        ASSERT_EQ(out[4 * (layer * count + texel) + k % 4],
                                  Imath::half(texels[k]).bits());
                    }
                    ASSERT_EQ(range.largest, largest);
                    ASSERT_TRUE(range.finite);
                }
    });
}

TEST(TexelKernel, MeansStayWithinTheirRow) {
    forEveryTarget([] {
        for (const std::size_t step : {1, 3, 4, 5, 8, 12, 16, 17, 33})
            for (const std::size_t count : {1, 2, 5})
                for (const Side side : sides) {
                    const GuardedArray<float> above(2 * count * step, side, numberAt);
                    const GuardedArray<float> below(2 * count * step, side, numberAt);
                    GuardedArray<float> out(count * step, side);
                    meanOfFour(above.data(), below.data(), count, step, out.data());
                    for (std::size_t k = 0; k < out.size(); ++k) {
                        const std::size_t left = k / step * 2 * step + k % step;
                        const double sum = double{above[left]} + double{above[left + step]} +
                                           double{below[left]} + double{below[left + step]};
                        ASSERT_NEAR(out[k], sum / 4, 1e-6);
                    }
                }
    });
}

TEST(TexelKernel, ProjectionsStayWithinTheirPoints) {
    forEveryTarget([] {
        for (const std::size_t length : {16, 32, 48})
            for (const std::size_t count : {0, 1, 3})
                for (const Side side : sides) {
                    const GuardedArray<float> directions(count * length, side, numberAt);
                    const GuardedArray<float> x(length, side, numberAt);
                    GuardedArray<float> y(count, side);
                    const float rest =
                        projectOnto(directions.data(), count, length, x.data(), y.data());
                    std::vector<double> left(length);
                    for (std::size_t i = 0; i < length; ++i) left[i] = double{x[i]};
                    for (std::size_t r = 0; r < count; ++r) {
                        double part = 0;
                        for (std::size_t i = 0; i < length; ++i)
                            part += double{directions[r * length + i]} * double{x[i]};
                        ASSERT_NEAR(y[r], part, 1e-5);
                        for (std::size_t i = 0; i < length; ++i)
                            left[i] -= part * double{directions[r * length + i]};
                    }
                    double square = 0;
                    for (const double each : left) square += each * each;
                    ASSERT_NEAR(rest, square, 1e-5 * (1 + square));
                }
    });
}

TEST(TexelKernel, NearestPointsStayWithinTheirColumns) {
    forEveryTarget([] {
        for (const std::size_t dimensions : {1, 3})
            for (std::size_t count = 1; count <= 2 * mostCount; ++count)
                for (const Side side : sides) {
                    const GuardedArray<float> points(count * dimensions, side, numberAt);
                    const NearestPoint nearest({points.data(), points.size()}, dimensions);
                    const GuardedArray<float> point(
                        dimensions, side, [&](std::size_t k) { return numberAt(k + count); });
                    std::size_t first = 0;
                    double least = std::numeric_limits<double>::infinity();
                    for (std::size_t i = 0; i < count; ++i) {
                        double square = 0;
                        for (std::size_t k = 0; k < dimensions; ++k)
                            square +=
                                std::pow(double{points[i * dimensions + k]} - double{point[k]}, 2);
                        if (square < least) least = square, first = i;
                    }
                    const Nearest found = nearest(point.data());
                    ASSERT_EQ(found.index, first);
                    ASSERT_NEAR(found.square, least, 1e-6);
                }
    });
}

}  // namespace
}  // namespace hshfit
