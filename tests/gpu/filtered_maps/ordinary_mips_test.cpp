// Filtered texels in the parameters of glTF's GGX with anisotropy.
#include <hshfit/filtered_maps/exports/ordinary_mips.h>
#include <hshfit/normal_filtering/mip_layout.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

/// Moments of a texel: the mean of the plane, squares about it, and the squares of the lobe's
/// widths along x and y.
std::vector<double> numbersOf(std::array<double, 2> mean, std::array<double, 3> variance,
                              std::array<double, 3> widths) {
    std::vector<double> numbers(MipLayout{}.size());
    numbers[MipLayout::normal + 2] = 0.9;
    numbers[MipLayout::plane] = mean[0];
    numbers[MipLayout::plane + 1] = mean[1];
    const double squares[] = {mean[0] * mean[0], mean[0] * mean[1], mean[1] * mean[1]};
    for (std::size_t k = 0; k < 3; ++k) {
        numbers[MipLayout::planeSquares + k] = variance[k] + squares[k];
        numbers[MipLayout::widths + k] = widths[k];
    }
    return numbers;
}

TEST(OrdinaryMips, LobesKeepTheirWidths) {
    const OrdinaryTexel texel = ordinaryTexel(numbersOf({0, 0}, {0, 0, 0}, {0.04, 0, 0.09}));
    EXPECT_NEAR(texel.shorter, 0.2, 1e-12);
    EXPECT_NEAR(texel.longer, 0.3, 1e-12);
    EXPECT_NEAR(std::abs(texel.direction[1]), 1, 1e-12);
    EXPECT_NEAR(texel.normal.z, 1, 1e-12);
    // glTF: the roughness squared across, and along it what the strength adds.
    const double across = std::pow(texel.roughness(), 2), s = texel.strength();
    EXPECT_NEAR(across, 0.2, 1e-12);
    EXPECT_NEAR(across + (1 - across) * s * s, 0.3, 1e-12);
}

TEST(OrdinaryMips, SpreadNormalsWidenLobesAlongTheirSlopes) {
    // Half of the normals lean by 0.1 along an axis at 30 degrees, half against it.
    const double slope = 0.1, c = std::cos(radians(30)), s = std::sin(radians(30));
    const OrdinaryTexel texel = ordinaryTexel(numbersOf(
        {0.05, -0.02}, {slope * slope * c * c, slope * slope * c * s, slope * slope * s * s},
        {0.01, 0, 0.01}));
    EXPECT_NEAR(texel.shorter, 0.1, 1e-9);
    EXPECT_NEAR(texel.longer, std::sqrt(0.01 + 2 * slope * slope), 1e-9);
    EXPECT_NEAR(std::abs(texel.direction[0] * c + texel.direction[1] * s), 1, 1e-9);
}

TEST(OrdinaryMips, WidthsEndAtOne) {
    const OrdinaryTexel texel = ordinaryTexel(numbersOf({0, 0}, {2, 0, 0.1}, {0.5, 0, 0.5}));
    EXPECT_EQ(texel.longer, 1);
    EXPECT_NEAR(texel.shorter, std::sqrt(0.7), 1e-12);
    EXPECT_EQ(ordinaryTexel(numbersOf({0, 0}, {1, 0, 1}, {1, 0, 1})).strength(), 0);
}

}  // namespace
}  // namespace hshfit
