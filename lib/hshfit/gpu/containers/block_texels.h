#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hshfit::gpu::inline containers {

/// Compressed texels of 4 x 4 in 16 bytes, as every desktop GPU reads them (Khronos Data
/// Format 1.3, chapters RGTC and BPTC).
enum class Blocks {
    none,
    bc5,  ///< two channels, each with 8 values between two bounds of 8 bits
    bc7,  ///< RGBA; of the eight modes the sixth alone, 16 colours between two of 8 bits
};

/// A texel's channels from 0 to 1; of BC5 the first two count.
using BlockTexel = std::array<float, 4>;

/// A picture as rows of blocks, [row][column]. Beyond an edge that is no multiple of 4 its last
/// texels are repeated.
struct BlockPicture {
    std::vector<std::byte> bytes;
    std::vector<BlockTexel> decoded;  ///< [row][column], as a GPU reads it
};
BlockPicture encodeBlocks(Blocks blocks, std::span<const BlockTexel> texels, std::size_t width,
                          std::size_t height);

}  // namespace hshfit::gpu::inline containers
