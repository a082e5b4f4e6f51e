// Errors of texels: the norm of a layout, what an encoder states, and the rank that suffices.

#include <hshfit/bases/catalog.h>
#include <hshfit/material_maps/texel_errors.h>

#include <gtest/gtest.h>

#include <cmath>

namespace hshfit {
namespace {

/// Two outgoing directions of unequal solid angles, one function and one channel.
TexelLayout smallLayout() {
    TexelLayout layout{.outgoing = OutgoingSet::elevations(2), .slots = {0}, .channels = 1};
    layout.outgoing.solidAngles = {1, 3};
    return layout;
}

/// Stores nothing and states its only number as the error.
class Stating final : public TexelEncoder {
public:
    std::string form() const override { return "stating"; }
    gpu::Number number() const override { return gpu::Number::float32; }
    std::size_t layers() const override { return 1; }
    std::size_t linear() const override { return 1; }
    void reduce(const float* texel, float* linear) const override { *linear = *texel; }
    EncodedRange encode(std::size_t, std::span<const float> linear,
                        const EncodedTexels& to) const override {
        *to.errors = linear.front();
        return {};
    }
};

TEST(TexelErrors, DistanceWeighsSquaresBySolidAngles) {
    const TexelLayout layout = smallLayout();
    ASSERT_EQ(layout.stride(), 4U);
    const std::vector<double> b{2, 0, 0, 0, 1, 0, 0, 0}, a{2, 0, 0, 0, 2, 0, 0, 0}, none(8, 0);
    // Off: 3 (2 - 1)^2. Whole: 1 * 2^2 + 3 * 1^2.
    EXPECT_NEAR(relativeDistance(layout, a, b), std::sqrt(3.0 / 7), 1e-15);
    EXPECT_EQ(relativeDistance(layout, b, b), 0);
    EXPECT_NEAR(relativeDistance(layout, a, none), 4, 1e-15);
}

TEST(TexelErrors, AreThoseThatTheEncoderStates) {
    const std::vector<float> linear{0.25F, 0.5F, 0.125F, 0.125F};
    const TexelErrors errors = errorsOf(Stating(), linear);
    EXPECT_NEAR(errors.mean, 0.25, 1e-7);
    EXPECT_EQ(errors.maximum, 0.5);
}

TEST(TexelErrors, LeastRankKeepsTheLargestErrorWithinTheBound) {
    const std::vector<TexelErrors> errors{
        {.maximum = 0.5}, {.maximum = 0.25}, {.mean = 0.25, .maximum = 0.25}};
    EXPECT_EQ(leastRank(errors, 0.6), 1U);
    EXPECT_EQ(leastRank(errors, 0.25), 2U);
    EXPECT_EQ(leastRank(errors, 0.1), 3U);
}

}  // namespace
}  // namespace hshfit
