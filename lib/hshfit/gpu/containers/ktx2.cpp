// Khronos KTX File Format Specification 2.0, and its data format descriptor (KDF 1.3, basic block):
// an array of 2-D textures, one level, uncompressed or with Zstandard.

#include <hshfit/gpu/containers/internal/byte_fields.h>
#include <hshfit/gpu/containers/internal/container_files.h>
#include <hshfit/gpu/containers/internal/ktx2_formats.h>
#include <hshfit/gpu/containers/ktx2_image.h>

#include <algorithm>

#include <zstd.h>

namespace hshfit::gpu::inline containers {
namespace {

constexpr std::string_view sidecarKey = "hshfit:sidecar";
constexpr std::uint32_t zstdScheme = 2;
constexpr int zstdLevel = 19;  // the highest that needs no large window
/// Data that would shrink further are stored uncompressed, and readers refuse such a ratio, so
/// that a small file cannot make them allocate without bounds.
constexpr std::uint64_t maxInflation = 1000;

std::string compressed(const Texels& texels) {
    std::string out(ZSTD_compressBound(texels.bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compress(out.data(), out.size(), texels.bytes.data(), texels.bytes.size(), zstdLevel);
    if (ZSTD_isError(size)) {
        throw OutputError(fmt::format("cannot compress texels: {}", ZSTD_getErrorName(size)));
    }
    out.resize(size);
    return out;
}

void write(const TexelFile& file, AtomicFile& out) {
    const Texels& texels = file.texels;
    const std::string data = file.zstd ? compressed(texels) : std::string();
    const bool zstd = !data.empty() && texels.bytes.size() / data.size() < maxInflation;
    Ktx2Image image{.number = texels.number,
                    .width = static_cast<std::size_t>(texels.width),
                    .height = static_cast<std::size_t>(texels.height),
                    .layers = texels.layers,
                    .zstd = zstd,
                    .levels = {{.stored = zstd ? data.size() : texels.bytes.size(),
                                .uncompressed = texels.bytes.size()}}};
    for (const auto& [key, value] : file.facts) image.pairs["hshfit:" + key] = value;
    image.pairs[std::string(sidecarKey)] = file.sidecar;
    out.write(ktx2Head(image));
    if (zstd) {
        out.write(data);
    } else {
        out.write(texels.bytes);
    }
}

std::string sidecar(std::string_view bytes, const std::string& file) {
    const ByteFields fields(bytes, file);
    const auto offset = fields.get<std::uint32_t>(56, "kvdByteOffset");
    const auto length = fields.get<std::uint32_t>(60, "kvdByteLength");
    std::string_view pairs = fields.part(offset, length, "the key/value data");
    while (pairs.size() > 4) {
        const std::uint64_t at = static_cast<std::uint64_t>(pairs.data() - bytes.data());
        const auto size = fields.get<std::uint32_t>(at, "keyAndValueByteLength");
        if (size > pairs.size() - 4) {
            fields.fail("keyAndValueByteLength", at,
                        fmt::format("is {}; {} bytes are left", size, pairs.size() - 4));
        }
        const std::string_view entry = pairs.substr(4, size);
        const std::size_t split = entry.find('\0');
        if (split == sidecarKey.size() && entry.starts_with(sidecarKey)) {
            const std::string_view value = entry.substr(split + 1);
            return std::string(value.substr(0, value.find('\0')));
        }
        pairs.remove_prefix(
            std::min<std::size_t>(pairs.size(), 4 + (std::size_t{size} + 3) / 4 * 4));
    }
    fields.fail("the key/value data", offset, fmt::format("have no key '{}'", sidecarKey));
}

std::vector<std::byte> inflated(std::string_view data, std::size_t count, std::uint64_t offset,
                                const ByteFields& fields) {
    const auto stated = ZSTD_getFrameContentSize(data.data(), data.size());
    if (stated != count || count / maxInflation > data.size()) {
        fields.fail("the level", offset, fmt::format("is no Zstandard frame of {} bytes", count));
    }
    std::vector<std::byte> out(count);
    const std::size_t size = ZSTD_decompress(out.data(), count, data.data(), data.size());
    if (ZSTD_isError(size) || size != count) {
        fields.fail("the level", offset, "is a damaged Zstandard frame");
    }
    return out;
}

std::vector<std::byte> texels(std::string_view bytes, Role, const Texels& expected,
                              const std::string& file) {
    const ByteFields fields(bytes, file);
    fields.require(12, formatOf(expected.number).vulkan, "vkFormat");
    fields.require(20, static_cast<std::uint32_t>(expected.width), "pixelWidth");
    fields.require(24, static_cast<std::uint32_t>(expected.height), "pixelHeight");
    fields.require(28, 0, "pixelDepth");
    fields.require(32, static_cast<std::uint32_t>(expected.layers), "layerCount");
    fields.require(36, 1, "faceCount");
    fields.require(40, 1, "levelCount");
    const auto scheme = fields.get<std::uint32_t>(44, "supercompressionScheme");
    if (scheme != 0 && scheme != zstdScheme) {
        fields.fail("supercompressionScheme", 44,
                    fmt::format("is {}; it has to be 0 (none) or 2 (Zstandard)", scheme));
    }
    const auto offset = fields.get<std::uint64_t>(80, "the level's byteOffset");
    const auto length = fields.get<std::uint64_t>(88, "the level's byteLength");
    const std::string_view data = fields.part(offset, length, "the level");
    const std::size_t count = byteCount(expected);
    if (fields.get<std::uint64_t>(96, "uncompressedByteLength") != count) {
        fields.fail("uncompressedByteLength", 96, fmt::format("has to be {}", count));
    }
    if (scheme == zstdScheme) return inflated(data, count, offset, fields);
    if (data.size() != count) {
        fields.fail("the level's byteLength", 88, fmt::format("has to be {}", count));
    }
    return bytesOf(data);
}

}  // namespace

const Container& ktx2Container() {
    static const Container row{
        .name = "ktx2",
        .suffix = ".ktx2",
        .summary = "Khronos texture array, uncompressed or with Zstandard",
        .numbers = {Number::float16, Number::float32, Number::unorm16, Number::unorm8},
        .holdsSidecar = true,
        .write = write,
        .recognises = [](std::string_view bytes) { return bytes.starts_with(ktx2Magic); },
        .sidecar = sidecar,
        .texels = texels};
    return row;
}

}  // namespace hshfit::gpu::inline containers
