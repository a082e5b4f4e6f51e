#include <hshfit/material_maps/material_map.h>

#include <hshfit/error.h>
#include <hshfit/material_maps/reduction.h>

#include <fmt/format.h>

#include <cmath>
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

MaterialMap::MaterialMap(const std::string& sidecar)
    : file_(sidecar), sidecar_(readMapSidecar(sidecar)), texture_(sidecar_.texture) {
    const auto require = [&](std::size_t at, std::size_t value, std::string_view field) {
        const std::uint64_t found = word(texture_, at, 4);
        if (found == value) return;
        throw InputError(
            fmt::format("{}: {} is {}; {} says {}", texture_.path(), field, found, sidecar, value));
    };
    if (std::memcmp(texture_.data(), "\xabKTX 20\xbb\r\n\x1a\n",
                    std::min<std::size_t>(texture_.size(), 12)) != 0)
        throw InputError(fmt::format("{}: is no KTX 2.0 file", texture_.path()));
    require(20, sidecar_.levels.front().width, "pixelWidth");
    require(24, sidecar_.levels.front().height, "pixelHeight");
    require(32, sidecar_.layers(), "layerCount");
    require(40, sidecar_.levels.size(), "levelCount");
    require(44, 0, "supercompressionScheme");
    for (std::size_t level = 0; level < sidecar_.levels.size(); ++level) {
        const LevelSize& size = sidecar_.levels[level];
        const std::size_t bytes =
            size.width * size.height * sidecar_.layers() * 4 * gpu::numberBytes(sidecar_.number);
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

std::vector<double> MaterialMap::numbers(std::size_t level, std::size_t column,
                                         std::size_t row) const {
    if (level >= sidecar_.levels.size()) {
        throw UsageError(fmt::format("{}: has levels 0 to {}, and no level {}", file_,
                                     sidecar_.levels.size() - 1, level));
    }
    const LevelSize& size = sidecar_.levels[level];
    if (column >= size.width || row >= size.height) {
        throw UsageError(fmt::format("{}: level {} has {} x {} texels, and none at ({}, {})", file_,
                                     level, size.width, size.height, column, row));
    }
    const std::size_t texel = 4 * gpu::numberBytes(sidecar_.number);
    gpu::Texels texels;
    texels.layers = sidecar_.layers();
    texels.number = sidecar_.number;
    for (std::size_t layer = 0; layer < texels.layers; ++layer) {
        const unsigned char* from = texture_.data() + offsets_[level] +
                                    ((layer * size.height + row) * size.width + column) * texel;
        for (std::size_t k = 0; k < texel; ++k)
            texels.bytes.push_back(static_cast<std::byte>(from[k]));
    }
    if (gpu::isNormalised(texels.number)) texels.scales.resize(texels.layers * 4);
    return gpu::decode(texels);
}

Coefficients MaterialMap::coefficients(std::size_t level, std::size_t column,
                                       std::size_t row) const {
    const std::vector<double> numbers = this->numbers(level, column, row);
    const TexelLayout& layout = sidecar_.layout;
    std::vector<float> texel(layout.floats());
    if (sidecar_.form == "outgoing") {
        for (std::size_t k = 0; k < texel.size(); ++k) texel[k] = static_cast<float>(numbers[k]);
    } else {
        const LowRank lowRank(layout, sidecar_.shapes);
        std::vector<float> weights(numbers.begin(), numbers.end());
        if (sidecar_.form == "clusters") {
            const auto cluster = static_cast<std::size_t>(std::lround(numbers[0] * 255) +
                                                          std::lround(numbers[1] * 255) * 256);
            const std::size_t count = lowRank.weightsOfTexel();
            if ((cluster + 1) * count > sidecar_.centres.size()) {
                throw InputError(fmt::format(
                    "{}: texel ({}, {}) of level {} has material {}; there are {}", texture_.path(),
                    column, row, level, cluster, sidecar_.centres.size() / count));
            }
            const float* centre = sidecar_.centres.data() + cluster * count;
            weights.assign(centre, centre + count);
        }
        lowRank.restore(weights.data(), texel.data());
    }
    Coefficients out;
    out.basis = sidecar_.basis;
    out.order = sidecar_.order;
    out.quantity = sidecar_.quantity;
    out.channels = sidecar_.channels;
    out.outgoing = layout.outgoing;
    out.isotropic = sidecar_.isotropic;
    out.bilateral = sidecar_.bilateral;
    out.source = fmt::format("{}:x={},y={},level={}", file_, column, row, level);
    out.generator = sidecar_.generator;
    out.values.assign(layout.outgoing.size() * layout.channels * out.slots(), 0.0);
    double energy = 0;
    for (std::size_t o = 0; o < layout.outgoing.size(); ++o) {
        for (std::size_t c = 0; c < layout.channels; ++c) {
            for (std::size_t s = 0; s < layout.slots.size(); ++s) {
                const auto value =
                    static_cast<double>(texel[o * layout.stride() + c * layout.slots.size() + s]);
                out.at(o, c)[layout.slots[s]] = value;
                energy += layout.weights()[o] * value * value;
            }
        }
    }
    out.energy.value = energy;
    return out;
}

}  // namespace hshfit::inline material_maps
