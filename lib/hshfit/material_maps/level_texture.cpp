#include <hshfit/material_maps/level_texture.h>

#include <hshfit/error.h>
#include <hshfit/material_maps/level_file.h>

#include <fmt/format.h>

#include <algorithm>
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

/// Whether a level follows another one: half a side is rounded down, and at least 1.
bool isHalf(const LevelSize& size, const LevelSize& before) {
    const auto half = [](std::size_t side) { return std::max<std::size_t>(side / 2, 1); };
    return before != LevelSize{1, 1} && size == LevelSize{half(before.width), half(before.height)};
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
        if (level > 0 && !isHalf(size, levels_[level - 1])) {
            throw InputError(
                fmt::format("{}: level {} of {} x {} texels is not half of the one before", sidecar,
                            level, size.width, size.height));
        }
        const auto bytes = levelBytes(size, layers_, number_);
        if (!bytes) {
            throw InputError(
                fmt::format("{}: {} x {} texels in {} layers are more than a file holds", sidecar,
                            size.width, size.height, layers_));
        }
        const std::uint64_t offset = word(texture_, levelIndex + level * indexEntry, 8);
        const std::uint64_t length = word(texture_, levelIndex + level * indexEntry + 8, 8);
        if (length != *bytes || offset > texture_.size() || length > texture_.size() - offset) {
            throw InputError(fmt::format("{}: level {} has {} bytes at {} of {}; {} are wanted",
                                         texture_.path(), level, length, offset, texture_.size(),
                                         *bytes));
        }
        offsets_.push_back(offset);
        lengths_.push_back(length);
    }
}

std::span<const std::byte> LevelTexture::file() const {
    return std::as_bytes(std::span(texture_.data(), texture_.size()));
}

std::span<const std::byte> LevelTexture::level(std::size_t level) const {
    return file().subspan(offsets_.at(level), lengths_[level]);
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
