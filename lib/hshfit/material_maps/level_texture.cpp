#include <hshfit/material_maps/level_texture.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <cstring>

namespace hshfit::inline material_maps {
namespace {

/// The level index of KTX 2.0 begins here, with an offset, a length and an uncompressed length of
/// eight bytes each.
constexpr std::size_t levelIndex = 80, indexEntry = 24;

std::uint64_t word(const MappedFile& file, std::size_t at, std::size_t bytes) {
    std::uint64_t value = 0;
    if (at + bytes > file.size()) throw InputError(fmt::format("{}: breaks off", file.path()));
    std::memcpy(&value, file.data() + at, bytes);  // little-endian, as this program needs
    return value;
}

}  // namespace

LevelTexture::LevelTexture(const std::string& path, std::vector<LevelSize> levels,
                           std::size_t layers, gpu::Number number, const std::string& sidecar)
    : sidecar_(sidecar),
      texture_(path),
      levels_(std::move(levels)),
      layers_(layers),
      number_(number) {
    const auto require = [&](std::size_t at, std::size_t value, std::string_view field) {
        const std::uint64_t found = word(texture_, at, 4);
        if (found == value) return;
        throw InputError(
            fmt::format("{}: {} is {}; {} says {}", texture_.path(), field, found, sidecar, value));
    };
    if (std::memcmp(texture_.data(), "\xabKTX 20\xbb\r\n\x1a\n",
                    std::min<std::size_t>(texture_.size(), 12)) != 0)
        throw InputError(fmt::format("{}: is no KTX 2.0 file", texture_.path()));
    require(20, levels_.front().width, "pixelWidth");
    require(24, levels_.front().height, "pixelHeight");
    require(32, layers_, "layerCount");
    require(40, levels_.size(), "levelCount");
    require(44, 0, "supercompressionScheme");
    for (std::size_t level = 0; level < levels_.size(); ++level) {
        const LevelSize& size = levels_[level];
        const std::size_t bytes =
            size.width * size.height * layers_ * 4 * gpu::numberBytes(number_);
        const std::uint64_t offset = word(texture_, levelIndex + level * indexEntry, 8);
        const std::uint64_t length = word(texture_, levelIndex + level * indexEntry + 8, 8);
        if (length != bytes || offset > texture_.size() || length > texture_.size() - offset) {
            throw InputError(fmt::format("{}: level {} has {} bytes at {} of {}; {} are wanted",
                                         texture_.path(), level, length, offset, texture_.size(),
                                         bytes));
        }
        offsets_.push_back(offset);
    }
}

std::span<const std::byte> LevelTexture::file() const {
    return std::as_bytes(std::span(texture_.data(), texture_.size()));
}

std::span<const std::byte> LevelTexture::level(std::size_t level) const {
    const LevelSize& size = levels_.at(level);
    return file().subspan(offsets_[level],
                          size.width * size.height * layers_ * 4 * gpu::numberBytes(number_));
}

std::vector<double> LevelTexture::numbers(std::size_t level, std::size_t column,
                                          std::size_t row) const {
    if (level >= levels_.size()) {
        throw UsageError(fmt::format("{}: has levels 0 to {}, and no level {}", sidecar_,
                                     levels_.size() - 1, level));
    }
    const LevelSize& size = levels_[level];
    if (column >= size.width || row >= size.height) {
        throw UsageError(fmt::format("{}: level {} has {} x {} texels, and none at ({}, {})",
                                     sidecar_, level, size.width, size.height, column, row));
    }
    const std::size_t texel = 4 * gpu::numberBytes(number_);
    gpu::Texels texels;
    texels.layers = layers_;
    texels.number = number_;
    for (std::size_t layer = 0; layer < texels.layers; ++layer) {
        const unsigned char* from = texture_.data() + offsets_[level] +
                                    ((layer * size.height + row) * size.width + column) * texel;
        for (std::size_t k = 0; k < texel; ++k)
            texels.bytes.push_back(static_cast<std::byte>(from[k]));
    }
    if (gpu::isNormalised(texels.number)) texels.scales.resize(texels.layers * 4);
    return gpu::decode(texels);
}

}  // namespace hshfit::inline material_maps
