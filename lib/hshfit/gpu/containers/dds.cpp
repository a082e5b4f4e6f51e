// Microsoft's DDS with the DX10 header ("DDS_HEADER_DXT10 structure", Microsoft Learn), an array of
// 2-D textures without mip levels.

#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>

#include <array>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::string_view magic = "DDS ";
constexpr std::uint32_t headerSize = 124, pixelFormatSize = 32, fourCcDx10 = 0x30315844;
constexpr std::uint32_t pixelFormatHasFourCc = 0x4, textureCaps = 0x1000, texture2d = 3;
/// DDSD_CAPS | HEIGHT | WIDTH | PITCH | PIXELFORMAT
constexpr std::uint32_t flags = 0x1 | 0x2 | 0x4 | 0x8 | 0x1000;
constexpr std::size_t dataOffset = 4 + 124 + 20;

/// DXGI_FORMAT_R16G16B16A16_FLOAT and so on.
std::uint32_t dxgiFormat(Number number) {
    switch (number) {
        case Number::float16:
            return 10;
        case Number::float32:
            return 2;
        case Number::unorm16:
            return 11;
        case Number::unorm8:
            break;
    }
    return 28;
}

std::uint32_t pitch(const Texels& texels) {
    return static_cast<std::uint32_t>(texels.width) * 4 *
           static_cast<std::uint32_t>(numberBytes(texels.number));
}

/// The header words after the magic number, all of which our reader checks; reserved ones are 0.
std::array<std::uint32_t, 36> headerOf(const Texels& texels) {
    std::array<std::uint32_t, 36> words{};
    words[0] = headerSize;
    words[1] = flags;
    words[2] = static_cast<std::uint32_t>(texels.height);
    words[3] = static_cast<std::uint32_t>(texels.width);
    words[4] = pitch(texels);
    words[18] = pixelFormatSize;
    words[19] = pixelFormatHasFourCc;
    words[20] = fourCcDx10;
    words[26] = textureCaps;
    words[31] = dxgiFormat(texels.number);
    words[32] = texture2d;
    words[34] = static_cast<std::uint32_t>(texels.layers);
    return words;
}

void write(const TexelFile& file, AtomicFile& out) {
    std::string head(magic);
    for (const std::uint32_t word : headerOf(file.texels)) put(head, word);
    out.write(head);
    out.write(file.texels.bytes);
}

std::vector<std::byte> texels(std::string_view bytes, Role, const Texels& expected,
                              const std::string& file) {
    const ByteFields fields(bytes, file);
    const auto wanted = headerOf(expected);
    constexpr struct {
        std::size_t word;
        const char* name;
    } checked[] = {{0, "dwSize"},
                   {2, "dwHeight"},
                   {3, "dwWidth"},
                   {18, "ddspf.dwSize"},
                   {20, "dwFourCC"},
                   {31, "dxgiFormat"},
                   {32, "resourceDimension"},
                   {34, "arraySize"}};
    for (const auto& [word, name] : checked) fields.require(4 + 4 * word, wanted[word], name);
    // 0 and 1 both mean a single level
    if (fields.get<std::uint32_t>(4 + 4 * 6, "dwMipMapCount") > 1) {
        fields.fail("dwMipMapCount", 28, "is more than 1; coefficients have no mip levels");
    }
    if (bytes.size() != dataOffset + byteCount(expected)) {
        fields.fail("the texels", dataOffset,
                    fmt::format("have {} bytes; the sidecar says {}", bytes.size() - dataOffset,
                                byteCount(expected)));
    }
    return bytesOf(bytes.substr(dataOffset));
}

}  // namespace

const Container& ddsContainer() {
    static const Container row{
        .name = "dds",
        .suffix = ".dds",
        .summary = "DirectX texture array with the DX10 header; the sidecar beside it",
        .numbers = {Number::float16, Number::float32, Number::unorm16, Number::unorm8},
        .holdsSidecar = false,
        .write = write,
        .recognises = [](std::string_view bytes) { return bytes.starts_with(magic); },
        .sidecar = nullptr,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
