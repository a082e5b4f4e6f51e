#pragma once

#include <hshfit/gpu/containers/block_texels.h>
#include <hshfit/gpu/texels.h>

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace hshfit::gpu::inline containers {

/// A texture as a KTX 2.0 file has it (Khronos KTX File Format Specification 2.0 and Data Format
/// 1.3): RGBA, two-dimensional, an array, or a cube map with levels.
struct Ktx2Image {
    Number number = Number::float16;
    Blocks blocks = Blocks::none;  ///< compressed texels, in place of numbers
    std::size_t width = 1, height = 1;
    std::size_t layers = 0;  ///< 0: no array
    std::size_t faces = 1;   ///< 6: a cube map, +x -x +y -y +z -z
    bool zstd = false;       ///< the levels are compressed with Zstandard
    struct Level {
        std::size_t stored = 0;        ///< bytes in the file
        std::size_t uncompressed = 0;  ///< of texels
    };
    std::vector<Level> levels = {};  ///< the largest first
    /// Beside KTXorientation and KTXwriter, which are set.
    std::map<std::string, std::string> pairs = {};
};

/// All of the file before its texels. The levels follow, the smallest first, each at the next
/// multiple of ktx2Alignment().
std::string ktx2Head(const Ktx2Image& image);
std::size_t ktx2Alignment(const Ktx2Image& image);

/// A file of levels without Zstandard, the largest first: [layer][face][row][column][RGBA], or
/// blocks in place of texels.
std::string ktx2File(Ktx2Image image, std::span<const std::vector<std::byte>> levels);

}  // namespace hshfit::gpu::inline containers
