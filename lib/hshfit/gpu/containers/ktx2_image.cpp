// Khronos KTX File Format Specification 2.0, and its data format descriptor (KDF 1.3, basic block).

#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/ktx2_formats.h>
#include <hshfit/gpu/containers/ktx2_image.h>
#include <hshfit/version.h>

#include <algorithm>
#include <cassert>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::uint32_t zstdScheme = 2;
constexpr std::size_t headerBytes = 80, levelIndexBytes = 24;

constexpr std::size_t blockSize = 16;  // bytes

/// Samples are the two channels of BC5 or the colour of BC7.
std::string blockDescriptor(Blocks blocks) {
    const bool two = blocks == Blocks::bc5;
    const std::uint32_t samples = two ? 2 : 1, blockBytes = 24 + samples * 16;
    constexpr std::uint8_t modelBc5 = 132, modelBc7 = 134;
    std::string out;
    put(out, std::uint32_t{4 + blockBytes});
    put(out, std::uint32_t{0});  // Khronos, basic descriptor
    put(out, std::uint16_t{2});  // KDF 1.3
    put(out, static_cast<std::uint16_t>(blockBytes));
    // primaries unspecified, transfer linear, alpha straight
    for (const int octet : {int{two ? modelBc5 : modelBc7}, 0, 1, 0})
        put(out, static_cast<std::uint8_t>(octet));
    put(out, std::uint32_t{0x0303});  // texel block 4 x 4 x 1 x 1
    put(out, std::uint64_t{blockSize});
    for (std::uint32_t i = 0; i < samples; ++i) {
        put(out, static_cast<std::uint16_t>(i * 64));
        put(out, static_cast<std::uint8_t>(two ? 63 : 127));
        put(out, static_cast<std::uint8_t>(i));
        put(out, std::uint32_t{0});
        put(out, std::uint32_t{0});
        put(out, std::uint32_t{0xffffffff});
    }
    return out;
}

std::string dataFormatDescriptor(Number number) {
    const PixelFormat& format = formatOf(number);
    const auto bytes = static_cast<std::uint32_t>(numberBytes(number));
    constexpr std::uint32_t blockBytes = 24 + 4 * 16;
    std::string out;
    put(out, std::uint32_t{4 + blockBytes});
    put(out, std::uint32_t{0});  // Khronos, basic descriptor
    put(out, std::uint16_t{2});  // KDF 1.3
    put(out, static_cast<std::uint16_t>(blockBytes));
    for (const int octet : {1, 0, 1, 0}) put(out, static_cast<std::uint8_t>(octet));
    // model RGBSDA, primaries unspecified, transfer linear, alpha straight
    put(out, std::uint32_t{0});                         // texel block 1 x 1 x 1 x 1
    put(out, std::uint64_t{bytes * 4});                 // bytes of plane 0
    constexpr std::uint8_t channels[] = {0, 1, 2, 15};  // R, G, B, A
    for (std::uint32_t i = 0; i < 4; ++i) {
        put(out, static_cast<std::uint16_t>(i * bytes * 8));
        put(out, static_cast<std::uint8_t>(bytes * 8 - 1));
        put(out, static_cast<std::uint8_t>(channels[i] | (format.floating ? 0xc0 : 0)));
        put(out, std::uint32_t{0});
        put(out, format.lower);
        put(out, format.upper);
    }
    return out;
}

/// Ascending keys, every value ended by NUL, entries padded to 4 bytes.
std::string keyValueData(const Ktx2Image& image) {
    std::map<std::string, std::string> pairs = image.pairs;
    pairs["KTXorientation"] = "rd";
    pairs["KTXwriter"] = std::string("hshfit ") + version;
    std::string out;
    for (const auto& [key, value] : pairs) {
        put(out, static_cast<std::uint32_t>(key.size() + 1 + value.size() + 1));
        out += key + '\0' + value + '\0';
        out.resize((out.size() + 3) / 4 * 4, '\0');
    }
    return out;
}

std::size_t aligned(std::size_t offset, std::size_t alignment) {
    return (offset + alignment - 1) / alignment * alignment;
}

}  // namespace

std::size_t ktx2Alignment(const Ktx2Image& image) {
    if (image.blocks != Blocks::none) return blockSize;
    // the least common multiple of 4 and the bytes of a texel, which is a power of two
    return image.zstd ? 1 : std::max<std::size_t>(4, numberBytes(image.number) * 4);
}

std::string ktx2Head(const Ktx2Image& image) {
    const bool texels = image.blocks == Blocks::none;
    constexpr std::size_t vulkanBc5 = 141, vulkanBc7 = 145;
    const std::size_t vulkan = texels ? std::size_t{formatOf(image.number).vulkan}
                               : image.blocks == Blocks::bc5 ? vulkanBc5
                                                             : vulkanBc7;
    const std::string descriptor =
        texels ? dataFormatDescriptor(image.number) : blockDescriptor(image.blocks);
    const std::string pairs = keyValueData(image);
    const std::size_t descriptorOffset = headerBytes + image.levels.size() * levelIndexBytes;
    const std::size_t pairsOffset = descriptorOffset + descriptor.size();
    const std::size_t alignment = ktx2Alignment(image);
    const std::size_t dataOffset = aligned(pairsOffset + pairs.size(), alignment);
    std::string head(ktx2Magic);
    for (const std::size_t word :
         {vulkan, texels ? numberBytes(image.number) : 1, image.width, image.height, std::size_t{0},
          image.layers, image.faces, image.levels.size(), std::size_t{image.zstd ? zstdScheme : 0},
          descriptorOffset, descriptor.size(), pairsOffset, pairs.size()}) {
        put(head, static_cast<std::uint32_t>(word));
    }
    for (const std::size_t word : {std::size_t{0}, std::size_t{0}}) put(head, std::uint64_t{word});
    // The smallest level comes first.
    std::vector<std::size_t> offsets(image.levels.size());
    std::size_t offset = dataOffset;
    for (std::size_t k = image.levels.size(); k-- > 0;) {
        offsets[k] = aligned(offset, alignment);
        offset = offsets[k] + image.levels[k].stored;
    }
    for (std::size_t k = 0; k < image.levels.size(); ++k)
        for (const std::size_t word :
             {offsets[k], image.levels[k].stored, image.levels[k].uncompressed})
            put(head, std::uint64_t{word});
    head += descriptor + pairs;
    head.resize(dataOffset, '\0');
    return head;
}

std::string ktx2File(Ktx2Image image, std::span<const std::vector<std::byte>> levels) {
    assert(!image.zstd);
    image.levels.clear();
    for (const auto& level : levels) image.levels.push_back({level.size(), level.size()});
    std::string out = ktx2Head(image);
    const std::size_t alignment = ktx2Alignment(image);
    for (std::size_t k = levels.size(); k-- > 0;) {
        out.resize(aligned(out.size(), alignment), '\0');
        out += textOf(levels[k]);
    }
    return out;
}

}  // namespace hshfit::gpu::inline containers
