#include <hshfit/representation/stored_array.h>

#include <hshfit/error.h>

#include <gtest/gtest.h>
#include <zstd.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace hshfit {
namespace {

const Precision precisions[] = {Precision::float64, Precision::float32, Precision::half,
                                Precision::unorm16, Precision::unorm8};

StoredArray randomArray(std::vector<std::size_t> shape, unsigned seed) {
    StoredArray array{.shape = std::move(shape), .values = {}};
    std::size_t count = 1;
    for (std::size_t side : array.shape) count *= side;
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < count; ++i) array.values.push_back(normal(engine));
    return array;
}

/// Largest error that a precision may make, for a value of a group with this range.
double bound(Precision precision, double value, double range) {
    switch (precision) {
        case Precision::float64:
            return 0;
        case Precision::float32:
            return std::abs(value) * std::ldexp(1.0, -24) + std::ldexp(1.0, -149);
        case Precision::half:
            return std::abs(value) * std::ldexp(1.0, -11) + std::ldexp(1.0, -25);
        case Precision::unorm16:
            return range / 65535 / 2 + 1e-6 * range;  // ends of the range are float32
        case Precision::unorm8:
            break;
    }
    return range / 255 / 2 + 1e-6 * range;
}

TEST(StoredArray, RoundsWithinHalfAStep) {
    for (Precision precision : precisions) {
        for (std::vector<std::size_t> shape :
             {std::vector<std::size_t>{40, 3, 7}, {3, 140}, {1, 5}}) {
            const StoredArray exact = randomArray(shape, 1);
            StoredArray rounded = exact;
            quantise(rounded, precision);
            const std::size_t columns = exact.columns(), group = exact.groupColumns();
            for (std::size_t i = 0; i < exact.values.size(); ++i) {
                double low = exact.values[i], high = low;
                for (std::size_t k = 0; k < exact.values.size(); ++k) {
                    if (k % columns / group != i % columns / group) continue;
                    low = std::min(low, exact.values[k]);
                    high = std::max(high, exact.values[k]);
                }
                EXPECT_NEAR(rounded.values[i], exact.values[i],
                            bound(precision, exact.values[i], high - low))
                    << precisionName(precision);
            }
        }
    }
}

TEST(StoredArray, PacksToItsLengthAndComesBackToTheBit) {
    for (Precision precision : precisions) {
        for (std::size_t keep : {std::size_t{0}, std::size_t{1}, std::size_t{50}}) {
            StoredArray array = randomArray({12, 3, 9}, 2);
            if (keep > 0) keepLargest(array, keep);
            quantise(array, precision);
            const std::vector<std::byte> bytes = packed(array);
            EXPECT_EQ(bytes.size(), storedBytes(array));
            StoredArray back{.shape = array.shape, .precision = precision, .values = {}};
            unpackInto(back, bytes, keep > 0, "here");
            EXPECT_EQ(back.values, array.values) << precisionName(precision) << ' ' << keep;
            EXPECT_EQ(back.kept, array.kept);
            EXPECT_EQ(packed(back), bytes);
        }
    }
}

TEST(StoredArray, CountsBytesAsTheFormatSays) {
    StoredArray array = randomArray({32, 10}, 3);
    quantise(array, Precision::unorm8);
    EXPECT_EQ(storedBytes(array), 10 * 8 + 320);  // a scale and an offset per column
    quantise(array, Precision::half);
    EXPECT_EQ(storedBytes(array), 640);
    keepLargest(array, 17);
    EXPECT_EQ(storedBytes(array), 40 + 2 * 17);  // one bit per value
    StoredArray few = randomArray({2, 10}, 3);   // groups of 8 columns make 16 numbers
    quantise(few, Precision::unorm8);
    EXPECT_EQ(storedBytes(few), 2 * 8 + 20);
}

TEST(StoredArray, KeepsTheLargest) {
    StoredArray array = randomArray({20, 20}, 4);
    const std::vector<double> before = array.values;
    keepLargest(array, 37);
    double smallestKept = std::numeric_limits<double>::infinity(), largestDropped = 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (array.kept[i]) {
            ++kept;
            EXPECT_EQ(array.values[i], before[i]);
            smallestKept = std::min(smallestKept, std::abs(before[i]));
        } else {
            EXPECT_EQ(array.values[i], 0);
            largestDropped = std::max(largestDropped, std::abs(before[i]));
        }
    }
    EXPECT_EQ(kept, 37U);
    EXPECT_GE(smallestKept, largestDropped);
}

TEST(StoredArray, WeightsDecideWhatIsLarge) {
    StoredArray array{.shape = {1, 3}, .values = {3, 2, 1}};
    const double weights[] = {0.1, 1, 4};
    keepLargest(array, 1, weights);
    EXPECT_EQ(array.values, (std::vector<double>{0, 0, 1}));
}

TEST(StoredArray, EntropyIsAZstandardFrameOfThePackedBytes) {
    StoredArray array{.shape = {1000, 1}, .values = std::vector<double>(1000, 0.5)};
    quantise(array, Precision::float32);
    const std::vector<std::byte> bytes = packed(array);
    std::vector<std::byte> out(ZSTD_compressBound(bytes.size()));
    EXPECT_EQ(entropyBytes(array),
              ZSTD_compress(out.data(), out.size(), bytes.data(), bytes.size(), ZSTD_maxCLevel()));
    EXPECT_LT(entropyBytes(array), 100U);  // all the same
}

TEST(StoredArray, RefusesWhatANumberCannotHold) {
    for (Precision precision : precisions) {
        for (double bad :
             {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
            StoredArray array{.shape = {1, 1}, .values = {bad}};
            EXPECT_THROW(quantise(array, precision), NumericError);
        }
    }
    StoredArray array{.shape = {1, 1}, .values = {65536}};
    EXPECT_THROW(quantise(array, Precision::half), NumericError);
    EXPECT_NO_THROW(quantise(array, Precision::unorm8));
}

TEST(StoredArray, RefusesBytesOfAnotherLength) {
    for (Precision precision : precisions) {
        StoredArray array = randomArray({4, 6}, 5);
        keepLargest(array, 7);
        quantise(array, precision);
        const std::vector<std::byte> bytes = packed(array);
        for (std::size_t length = 0; length <= bytes.size() + 3; ++length) {
            if (length == bytes.size()) continue;
            std::vector<std::byte> cut = bytes;
            cut.resize(length);
            StoredArray back{.shape = {4, 6}, .precision = precision, .values = {}};
            EXPECT_THROW(unpackInto(back, cut, true, "here"), InputError) << length;
        }
        StoredArray huge{.shape = {std::size_t{1} << 40, std::size_t{1} << 40},
                         .precision = precision,
                         .values = {}};
        EXPECT_THROW(unpackInto(huge, bytes, true, "here"), InputError);
        EXPECT_TRUE(huge.values.empty());
    }
}

TEST(StoredArray, NamesRoundTripAndUnknownOnesAreListed) {
    for (Precision precision : precisions) {
        EXPECT_EQ(parsePrecision(precisionName(precision)), precision);
    }
    EXPECT_THROW(parsePrecision("float16"), UsageError);
}

}  // namespace
}  // namespace hshfit
