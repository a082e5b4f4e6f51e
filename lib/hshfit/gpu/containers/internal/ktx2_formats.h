#pragma once

#include <hshfit/gpu/texels.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string_view>

namespace hshfit::gpu::inline containers {

inline constexpr std::string_view ktx2Magic("\xabKTX 20\xbb\r\n\x1a\n", 12);

/// The formats of texels that the program writes to KTX 2.0.
struct PixelFormat {
    Number number;
    std::uint32_t vulkan;  ///< VkFormat
    bool floating;
    std::uint32_t lower, upper;  ///< of the samples
};
inline constexpr std::array pixelFormats{
    PixelFormat{Number::float16, 97, true, std::bit_cast<std::uint32_t>(-1.0F),
                std::bit_cast<std::uint32_t>(1.0F)},
    PixelFormat{Number::float32, 109, true, std::bit_cast<std::uint32_t>(-1.0F),
                std::bit_cast<std::uint32_t>(1.0F)},
    PixelFormat{Number::unorm16, 91, false, 0, 65535},
    PixelFormat{Number::unorm8, 37, false, 0, 255},
};
inline const PixelFormat& formatOf(Number number) {
    return *std::find_if(pixelFormats.begin(), pixelFormats.end(),
                         [&](const PixelFormat& row) { return row.number == number; });
}

}  // namespace hshfit::gpu::inline containers
