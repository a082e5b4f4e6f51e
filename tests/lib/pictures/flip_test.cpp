#include <hshfit/error.h>
#include <hshfit/pictures/flip.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hshfit {
namespace {

RgbPicture uniform(float r, float g, float b, int size = 24) {
    RgbPicture picture{size, size};
    for (int k = 0; k < size * size; ++k) picture.values.insert(picture.values.end(), {r, g, b});
    return picture;
}

/// The published CIE L*a*b* of the sRGB primaries, D65, 2 degrees (Lindbloom).
constexpr std::array<double, 3> greenLab{87.7347, -86.1827, 83.1793},
    blueLab{32.2970, 79.1875, -107.8602}, redLab{53.2408, 80.0925, 67.2032};

double adjustedDistance(std::array<double, 3> a, std::array<double, 3> b) {
    for (auto* lab : {&a, &b})
        for (int i = 1; i < 3; ++i) (*lab)[i] *= 0.01 * (*lab)[0];
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// Section 4.3 of the paper for pictures without edges.
double expected(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    const double most = std::pow(adjustedDistance(greenLab, blueLab), 0.7),
                 error = std::pow(adjustedDistance(a, b), 0.7);
    return error < 0.4 * most ? 0.95 * error / (0.4 * most)
                              : 0.95 + 0.05 * (error - 0.4 * most) / (0.6 * most);
}

TEST(Flip, OfUniformPicturesIsTheDistanceOfTheirColours) {
    struct Case {
        RgbPicture a, b;
        double value;
    };
    const std::array<double, 3> white{100, 0, 0}, black{0, 0, 0};
    for (const Case& own : {Case{uniform(1, 1, 1), uniform(0, 0, 0), expected(white, black)},
                            Case{uniform(0, 1, 0), uniform(0, 0, 1), 1.0},
                            Case{uniform(1, 0, 0), uniform(0, 0, 1), expected(redLab, blueLab)},
                            Case{uniform(1, 0, 0), uniform(1, 1, 1), expected(redLab, white)}}) {
        for (const float value : flip(own.a, own.b)) EXPECT_NEAR(value, own.value, 2e-4);
        for (const float value : flip(own.b, own.a)) EXPECT_NEAR(value, own.value, 2e-4);
    }
}

TEST(Flip, OfAPictureAndItselfIsZero) {
    RgbPicture picture = uniform(0, 0, 0);
    for (std::size_t k = 0; k < picture.values.size(); ++k)
        picture.values[k] = static_cast<float>(k * 7919 % 101) / 100;
    for (const float value : flip(picture, picture)) EXPECT_EQ(value, 0);
}

/// Values that a screen cannot show are clamped.
TEST(Flip, ClampsToWhatIsShown) {
    for (const float value : flip(uniform(1, 1, 1), uniform(7, 2, 1))) EXPECT_EQ(value, 0);
    for (const float value : flip(uniform(0, 0, 0), uniform(-1, 0, 0))) EXPECT_EQ(value, 0);
}

/// The eye sees fine patterns less: a chequered picture of single pixels is nearly its mean, one of
/// wide squares is not.
TEST(Flip, FinePatternsAreSeenLess) {
    constexpr int size = 96;
    const auto chequered = [&](int width) {
        RgbPicture picture{size, size};
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const float value = (x / width + y / width) % 2 == 0 ? 0.3f : 0.5f;
                picture.values.insert(picture.values.end(), {value, value, value});
            }
        return picture;
    };
    const RgbPicture mean = uniform(0.4f, 0.4f, 0.4f, size);
    const auto meanFlip = [&](int width) {
        double sum = 0;
        for (const float value : flip(mean, chequered(width))) sum += value;
        return sum / (size * size);
    };
    const double fine = meanFlip(1), wide = meanFlip(16);
    EXPECT_LT(fine, 0.02);
    EXPECT_GT(wide, 3 * fine);
}

/// Where contrast is the same, an edge that is in one picture only adds to the error.
TEST(Flip, AnEdgeAddsToTheError) {
    constexpr int size = 64;
    RgbPicture edge{size, size};
    for (int k = 0; k < size * size; ++k) {
        const float value = k % size < size / 2 ? 0.2f : 0.6f;
        edge.values.insert(edge.values.end(), {value, value, value});
    }
    const RgbPicture flat = uniform(0.2f, 0.2f, 0.2f, size);
    const std::vector<float> error = flip(flat, edge);
    const std::size_t row = static_cast<std::size_t>(size) * (size / 2);
    EXPECT_LT(error[row + 2], 1e-3);
    EXPECT_GT(error[row + size / 2 + 1], error[row + size - 2]);
}

TEST(Flip, RefusesPicturesOfOtherSizes) {
    EXPECT_THROW(flip(uniform(1, 1, 1, 8), uniform(1, 1, 1, 9)), UsageError);
}

}  // namespace
}  // namespace hshfit
