#include "asymmetric.h"

#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/gpu/payload.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace hshfit::gpu {
namespace {

using samples::asymmetric;
using samples::floatDirections;

const OutgoingSet maps[] = {OutgoingSet::parabolic(12, 8), OutgoingSet::parabolic(5, 9),
                            OutgoingSet::elevations(6), OutgoingSet::direction(0.6, -1.1)};

double largest(const std::vector<double>& values) {
    double result = 0;
    for (double v : values) result = std::max(result, std::abs(v));
    return result;
}

/// Largest difference of the two reconstructions over pairs of directions.
double largestDifference(const Coefficients& a, const Coefficients& b) {
    const Reconstruction first(a), second(b);
    const auto wo = floatDirections(64, 1), wi = floatDirections(64, 2);
    std::vector<double> u(a.channels.count()), v(u.size());
    double difference = 0;
    for (std::size_t i = 0; i < wo.size(); ++i) {
        const DirectionBatch one{&wi[i].x, &wi[i].y, &wi[i].z, 1};
        first.evalQuantity(wo[i], one, u.data());
        second.evalQuantity(wo[i], one, v.data());
        for (std::size_t c = 0; c < u.size(); ++c)
            difference = std::max(difference, std::abs(u[c] - v[c]));
    }
    return difference;
}

TEST(Payload, SinglePrecisionComesBackAsTheRoundedCoefficients) {
    for (const OutgoingSet& map : maps) {
        for (const Channels& channels :
             {Channels::grey(), Channels::rgb(), Channels::spectral({400, 500, 550, 600, 700})}) {
            const Coefficients c = asymmetric("hsh", 4, map, channels, 7);
            const Payload payload = pack(c, {.number = Number::float32});
            const Coefficients back = unpack(payload);
            ASSERT_EQ(back.values.size(), c.values.size());
            std::size_t different = 0;
            for (std::size_t i = 0; i < c.values.size(); ++i)
                different += back.values[i] != static_cast<double>(static_cast<float>(c.values[i]));
            // Lane 0 of layer 0 holds the marks in four texels: coefficient 0 of the first channel.
            EXPECT_EQ(different, payload.marked() ? 4U : 0U) << map.spec();
            EXPECT_LE(largestDifference(c, back), 1e-6) << map.spec();
        }
    }
}

TEST(Payload, MarksChangeNoLookup) {
    for (const auto& [width, height] : {std::pair{8, 8}, {8, 64}, {12, 9}, {32, 32}}) {
        const OutgoingSet set = OutgoingSet::parabolic(width, height);
        const std::size_t w = static_cast<std::size_t>(width);
        const std::size_t marks[] = {0, w - 1, set.size() - w, set.size() - 1};
        for (int k = 0; k < 20000; ++k) {
            const double phi = 2 * pi * k / 20000;
            const OutgoingLookup found = lookUp(set, {std::cos(phi), std::sin(phi), 0});
            for (int i = 0; i < found.count; ++i)
                for (std::size_t mark : marks) ASSERT_NE(found.index[i], mark) << set.spec();
        }
    }
}

TEST(Payload, MarksAreOneToFourRowByRow) {
    const Payload payload =
        pack(asymmetric("hsh", 2, maps[0], Channels::grey(), 3), {.number = Number::float16});
    ASSERT_TRUE(payload.marked());
    const std::vector<double> texels = decode(payload.coefficients);
    const auto at = [&](std::size_t x, std::size_t y) { return texels[(y * 12 + x) * 4]; };
    EXPECT_EQ(at(0, 0), 1);
    EXPECT_EQ(at(11, 0), 2);
    EXPECT_EQ(at(0, 7), 3);
    EXPECT_EQ(at(11, 7), 4);
}

TEST(Payload, LayersFollowTheFormula) {
    const Coefficients c = asymmetric("hsh", 7, maps[0], Channels::rgb(), 5);
    EXPECT_EQ(pack(c, {}).coefficients.layers, 39U);
    EXPECT_EQ(pack(c, {.packing = Packing::rgb}).coefficients.layers, 49U);
    // Zernike has n(n+1)/2 of the n^2 functions: 28 at order 7.
    EXPECT_EQ(pack(asymmetric("zernike", 7, maps[0], Channels::rgb(), 5), {}).coefficients.layers,
              21U);
    const Payload chroma = pack(c, {.luminanceChroma = true, .chromaOrder = 3});
    EXPECT_EQ(chroma.coefficients.layers, 13U + 3U + 3U);
    EXPECT_EQ(chroma.stored[2].firstLayer, 16U);
}

TEST(Payload, SinesOfASymmetricBrdfAreLeftOut) {
    Coefficients c = asymmetric("hsh", 5, maps[2], Channels::grey(), 5);
    c.bilateral = true;
    EXPECT_EQ(pack(c, {}).slots.size(), 25U) << "sine terms that are not zero have to stay";
    for (std::size_t p = 0; p < c.outgoing.size(); ++p)
        for (int l = 0; l < 5; ++l)
            for (int m = 1; m <= l; ++m) c.at(p, 0)[slotOf(l, -m)] = 0;
    const Payload payload = pack(c, {.number = Number::float32});
    EXPECT_EQ(payload.slots.size(), 15U);
    EXPECT_LE(largestDifference(c, unpack(payload)), 1e-6);
    c.bilateral = false;
    EXPECT_EQ(pack(c, {}).slots.size(), 25U);
}

TEST(Payload, LuminanceAndChromaKeepTheSum) {
    const Coefficients c = asymmetric("sh", 4, maps[0], Channels::rgb(), 11);
    for (Packing packing : {Packing::coef4, Packing::rgb}) {
        const Payload payload =
            pack(c, {.number = Number::float32, .packing = packing, .luminanceChroma = true});
        EXPECT_EQ(payload.stored[0].name, "Y");
        EXPECT_LE(largestDifference(c, unpack(payload)), 2e-6);
    }
    // With fewer bands of the chroma, the luminance R/4 + G/2 + B/4 is still exact.
    const Coefficients cut =
        unpack(pack(c, {.number = Number::float32, .luminanceChroma = true, .chromaOrder = 2}));
    for (std::size_t k = 0; k < c.slots(); ++k) {
        const auto luminance = [&](const Coefficients& s) {
            return s.at(30, 0)[k] / 4 + s.at(30, 1)[k] / 2 + s.at(30, 2)[k] / 4;
        };
        EXPECT_NEAR(luminance(c), luminance(cut), 1e-6);
    }
    EXPECT_GT(largestDifference(c, cut), 1e-2);
}

TEST(Payload, BasisTexturesHoldTheBasis) {
    const Coefficients c = asymmetric("hsh", 3, maps[0], Channels::grey(), 2);
    const Payload payload = pack(c, {.number = Number::float32, .basisSize = 17});
    ASSERT_TRUE(payload.basisTexels);
    const std::vector<double> texels = decode(*payload.basisTexels);
    const auto basis = bases::make("hsh", 3, {});
    std::vector<double> expected(9);
    for (std::size_t p = 0; p < 17 * 17; ++p) {
        // p = +-1 at the centres of the second texels from the edge, less half a texel: the inset.
        const double x = (static_cast<double>(p % 17) - 8) * 2 / 15;
        const double y = (static_cast<double>(p / 17) - 8) * 2 / 15;
        const double r = std::hypot(x, y), theta = 2 * std::atan(std::min(r, 1.0));
        basis->evaluate(directionFromAngles(theta, std::atan2(y, x)), expected.data());
        for (std::size_t j = 0; j < 9; ++j)
            EXPECT_NEAR(texels[(j / 4 * 289 + p) * 4 + j % 4], expected[j], r >= 1 ? 1e-3 : 1e-6);
    }
}

TEST(Payload, UnpackablePayloadsAreRefused) {
    const Coefficients big = asymmetric("hsh", 20, maps[1], Channels::rgb(), 1);
    EXPECT_THROW(pack(big, {}), UsageError);
    const Coefficients grey = asymmetric("hsh", 3, maps[0], Channels::grey(), 1);
    EXPECT_THROW(pack(grey, {.luminanceChroma = true}), UsageError);
    EXPECT_THROW(pack(grey, {.chromaOrder = 2}), UsageError);
    EXPECT_THROW(pack(grey, {.basisSize = 3}), UsageError);
    const Coefficients spectral =
        asymmetric("hsh", 3, maps[0], Channels::spectral({1, 2, 3, 4, 5}), 1);
    EXPECT_THROW(pack(spectral, {.packing = Packing::rgb}), UsageError);
    for (double bad : {std::numeric_limits<double>::quiet_NaN(),
                       std::numeric_limits<double>::infinity(), 65520.0}) {
        Coefficients c = grey;
        c.values[5] = bad;
        EXPECT_THROW(pack(c, {}), NumericError) << bad;
    }
}

TEST(Texels, HalvesAreTheNearestEvenOnes) {
    // Every half, its neighbours' midpoints and points just beside them (IEEE 754-2019, 4.3.1).
    const auto halfValue = [](std::uint16_t bits) {
        const int exponent = bits >> 10, mantissa = bits & 1023;
        return exponent == 0 ? std::ldexp(mantissa, -24)
                             : std::ldexp(1024 + mantissa, exponent - 25);
    };
    std::vector<double> values;
    std::vector<std::uint16_t> expected;
    const auto add = [&](double value, int bits) {
        values.push_back(value);
        expected.push_back(static_cast<std::uint16_t>(bits));
    };
    for (int bits = 0; bits < 0x7bff; ++bits) {
        const double a = halfValue(static_cast<std::uint16_t>(bits));
        const double middle = (a + halfValue(static_cast<std::uint16_t>(bits + 1))) / 2;
        add(a, bits);
        add(middle, bits % 2 ? bits + 1 : bits);
        add(middle * (1 + 1e-6), bits + 1);
        add(middle * (1 - 1e-6), bits);
    }
    add(-0.0, 0);
    while (values.size() % 4 != 0) add(0, 0);
    const Texels texels =
        encode(values, static_cast<int>(values.size() / 4), 1, 1, Number::float16);
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::uint16_t bits = 0;
        std::memcpy(&bits, texels.bytes.data() + 2 * i, 2);
        ASSERT_EQ(bits, expected[i]) << values[i];
    }
}

TEST(Texels, NormalisedNumbersAreWithinHalfAStep) {
    std::vector<double> values(4 * 50 * 2);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = std::sin(0.37 * static_cast<double>(i * i % 977)) * static_cast<double>(i % 4);
    for (const auto& [number, steps] :
         {std::pair{Number::unorm8, 255.0}, {Number::unorm16, 65535.0}}) {
        const Texels texels = encode(values, 50, 1, 2, number);
        const std::vector<double> back = decode(texels);
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double range = 2.0 * static_cast<double>(i % 4);
            EXPECT_NEAR(back[i], values[i], range * (0.5 / steps + 2e-7));
        }
    }
    EXPECT_LE(largest(decode(encode(std::vector<double>(8, 0.0), 2, 1, 1, Number::unorm8))), 0);
}

TEST(Texels, SizesAreNotTrusted) {
    Texels texels = encode(std::vector<double>(16, 1.0), 2, 2, 1, Number::unorm8);
    texels.scales.pop_back();
    EXPECT_THROW(decode(texels), InputError);
    texels = encode(std::vector<double>(16, 1.0), 2, 2, 1, Number::float16);
    texels.layers = 2;
    EXPECT_THROW(decode(texels), InputError);
    EXPECT_THROW(parseNumber("float24"), UsageError);
}

}  // namespace
}  // namespace hshfit::gpu
