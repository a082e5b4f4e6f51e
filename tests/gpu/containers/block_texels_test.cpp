// Compressed texels: blocks read again by decoders that are written here after the Khronos Data
// Format Specification (RGTC, BPTC), and heads of KTX 2.0 files.
#include <hshfit/gpu/containers/block_texels.h>
#include <hshfit/gpu/containers/ktx2_image.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>

namespace hshfit::gpu {
namespace {

unsigned bitsAt(const std::byte* block, std::size_t first, int count) {
    unsigned value = 0;
    for (int k = 0; k < count; ++k) {
        const std::size_t at = first + static_cast<std::size_t>(k);
        value |= (std::to_integer<unsigned>(block[at / 8]) >> at % 8 & 1U) << k;
    }
    return value;
}

/// A texel of an 8-byte block of RGTC, from 0 to 1.
double rgtc(const std::byte* block, std::size_t texel) {
    const double a = bitsAt(block, 0, 8), b = bitsAt(block, 8, 8);
    const unsigned code = bitsAt(block, 16 + 3 * texel, 3);
    if (code == 0) return a / 255;
    if (code == 1) return b / 255;
    if (a > b) return ((8.0 - code) * a + (code - 1.0) * b) / 7 / 255;
    if (code == 6) return 0;
    if (code == 7) return 1;
    return ((6.0 - code) * a + (code - 1.0) * b) / 5 / 255;
}

/// A texel of a block of BPTC, mode 6: RGBA from 0 to 1.
std::array<double, 4> bptc(const std::byte* block, std::size_t texel) {
    static constexpr int weights[] = {0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};
    EXPECT_EQ(bitsAt(block, 0, 7), 64U) << "mode 6";
    const unsigned lowest[] = {bitsAt(block, 63, 1), bitsAt(block, 64, 1)};
    // The first index has no highest bit.
    const int weight =
        weights[texel == 0 ? bitsAt(block, 65, 3) : bitsAt(block, 64 + 4 * texel, 4)];
    std::array<double, 4> result{};
    for (std::size_t c = 0; c < 4; ++c) {
        const int a = static_cast<int>(2 * bitsAt(block, 7 + 14 * c, 7) + lowest[0]),
                  b = static_cast<int>(2 * bitsAt(block, 14 + 14 * c, 7) + lowest[1]);
        result[c] = ((64 - weight) * a + weight * b + 32) / 64 / 255.0;
    }
    return result;
}

/// 10 x 7 texels: smooth in the first block, random in others.
std::vector<BlockTexel> picture() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    std::vector<BlockTexel> texels;
    for (int row = 0; row < 7; ++row)
        for (int column = 0; column < 10; ++column) {
            const float smooth = static_cast<float>(row + column) / 20;
            if (row < 4 && column < 4)
                texels.push_back({smooth, 1 - smooth, smooth / 2, 1});
            else
                texels.push_back(
                    {uniform(random), uniform(random), uniform(random), uniform(random)});
        }
    return texels;
}

TEST(BlockTexels, AreDecodedAsTheSpecificationSays) {
    const std::vector<BlockTexel> texels = picture();
    for (const Blocks blocks : {Blocks::bc5, Blocks::bc7}) {
        const BlockPicture made = encodeBlocks(blocks, texels, 10, 7);
        ASSERT_EQ(made.bytes.size(), 3U * 2 * 16);
        for (std::size_t row = 0; row < 7; ++row)
            for (std::size_t column = 0; column < 10; ++column) {
                const std::byte* block = &made.bytes[16 * (row / 4 * 3 + column / 4)];
                const std::size_t texel = 4 * (row % 4) + column % 4;
                const BlockTexel& found = made.decoded[row * 10 + column];
                if (blocks == Blocks::bc5) {
                    EXPECT_NEAR(found[0], rgtc(block, texel), 1e-6);
                    EXPECT_NEAR(found[1], rgtc(block + 8, texel), 1e-6);
                } else {
                    const auto expected = bptc(block, texel);
                    for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(found[c], expected[c], 1e-6);
                }
                // Smooth texels lie on a line of colours, and between bounds 6/20 apart.
                if (row < 4 && column < 4) {
                    for (std::size_t c = 0; c < 2; ++c)
                        EXPECT_NEAR(found[c], texels[row * 10 + column][c], 0.6 * 0.3 / 7);
                }
            }
    }
}

TEST(BlockTexels, OneColourIsKeptToAStep) {
    // Channels of BC7 share their lowest bit.
    for (const float value : {0.F, 0.25F, 0.5F, 1.F}) {
        const std::vector<BlockTexel> texels(16, BlockTexel{value, 1 - value, value, 1});
        for (const Blocks blocks : {Blocks::bc5, Blocks::bc7})
            for (const BlockTexel& found : encodeBlocks(blocks, texels, 4, 4).decoded)
                for (std::size_t c = 0; c < 2; ++c)
                    EXPECT_NEAR(found[c], texels[0][c], (blocks == Blocks::bc5 ? 0.51 : 1.01) / 255)
                        << value;
    }
}

std::uint32_t wordAt(const std::string& file, std::size_t offset) {
    std::uint32_t word = 0;
    std::memcpy(&word, file.data() + offset, sizeof word);
    return word;
}

TEST(BlockTexels, FilesSayFormatAndLevels) {
    const std::vector<std::byte> levels[] = {
        std::vector<std::byte>(6 * 16), std::vector<std::byte>(2 * 16), std::vector<std::byte>(16)};
    for (const Blocks blocks : {Blocks::bc5, Blocks::bc7}) {
        const bool two = blocks == Blocks::bc5;
        const std::string file = ktx2File({.blocks = blocks, .width = 10, .height = 7}, levels);
        EXPECT_EQ(wordAt(file, 12), two ? 141U : 145U);  // VK_FORMAT_BC…_UNORM_BLOCK
        EXPECT_EQ(wordAt(file, 16), 1U);                 // typeSize
        EXPECT_EQ(wordAt(file, 20), 10U);
        EXPECT_EQ(wordAt(file, 24), 7U);
        EXPECT_EQ(wordAt(file, 40), 3U);  // levels
        const std::size_t descriptor = wordAt(file, 48);
        EXPECT_EQ(wordAt(file, descriptor), 4U + 24 + (two ? 32 : 16));
        EXPECT_EQ(wordAt(file, descriptor + 12) & 0xff, two ? 132U : 134U);  // colour model
        EXPECT_EQ(wordAt(file, descriptor + 16), 0x0303U);
        EXPECT_EQ(wordAt(file, descriptor + 20), 16U);
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(wordAt(file, 80 + 24 * k) % 16, 0U);
            EXPECT_EQ(wordAt(file, 80 + 24 * k + 8), levels[k].size());
        }
        EXPECT_EQ(wordAt(file, 80) + levels[0].size(), file.size());
    }
}

}  // namespace
}  // namespace hshfit::gpu
