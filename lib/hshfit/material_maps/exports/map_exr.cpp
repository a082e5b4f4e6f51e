#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/exr_stream.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/material_maps/exports/map_export.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>
#include <ImfTiledOutputPart.h>
#include <fmt/format.h>

#include <algorithm>

namespace hshfit::inline material_maps::inline exports {
namespace {

constexpr std::array channelNames{"R", "G", "B", "A"};

/// A level of a layer: texels of four halves or floats, row by row.
struct ExrLevel {
    std::size_t width = 1, height = 1;
    std::vector<std::byte> bytes = {};
};

/// The texels of a layer at `level`; beyond the last, its first texels again.
ExrLevel levelOf(const StoredLevels& s, std::size_t layer, std::size_t level) {
    const std::size_t stored = std::min(level, s.levels.size() - 1);
    const LevelSize& size = s.levels[stored];
    const std::size_t texel = 4 * gpu::numberBytes(s.number), count = size.width * size.height;
    const auto from = s.bytes(stored).subspan(layer * count * texel, count * texel);
    ExrLevel out{std::max<std::size_t>(s.levels.front().width >> level, 1),
                 std::max<std::size_t>(s.levels.front().height >> level, 1)};
    std::vector<std::byte> kept;
    for (std::size_t row = 0; row < out.height; ++row) {
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(row * size.width * texel);
        kept.insert(kept.end(), begin, begin + static_cast<std::ptrdiff_t>(out.width * texel));
    }
    if (!gpu::isNormalised(s.number)) {
        out.bytes = std::move(kept);
        return out;
    }
    // OpenEXR has no normalised integers: the codes become 0 to 1 in float32.
    const gpu::Texels codes{.width = static_cast<int>(out.width),
                            .height = static_cast<int>(out.height),
                            .layers = 1,
                            .number = s.number,
                            .bytes = std::move(kept),
                            .scales = std::vector<gpu::LaneScale>(4)};
    out.bytes =
        gpu::encode(gpu::decode(codes), codes.width, codes.height, 1, gpu::Number::float32).bytes;
    return out;
}

Imf::Header headerOf(int width, int height, bool half, std::size_t layer) {
    constexpr unsigned tile = 64;
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* name : channelNames)
        header.channels().insert(name, Imf::Channel(half ? Imf::HALF : Imf::FLOAT));
    header.setName(fmt::format("layer{:04}", layer));
    header.setType(Imf::TILEDIMAGE);
    header.setTileDescription(
        Imf::TileDescription(tile, tile, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN));
    return header;
}

Imf::FrameBuffer slicesOf(ExrLevel& level, bool half) {
    const std::size_t number = half ? 2 : 4;
    Imf::FrameBuffer buffer;
    for (std::size_t lane = 0; lane < channelNames.size(); ++lane) {
        buffer.insert(channelNames[lane],
                      Imf::Slice(half ? Imf::HALF : Imf::FLOAT,
                                 reinterpret_cast<char*>(level.bytes.data()) + lane * number,
                                 4 * number, 4 * number * level.width));
    }
    return buffer;
}

/// A file of `layers` parts whose levels `texels(layer, level)` gives.
template <class Levels>
MapTextureFile writeExr(std::string_view role, const std::string& name, std::size_t layers,
                        int width, int height, bool half, const Levels& texels, FileSet& files) {
    std::vector<Imf::Header> headers;
    for (std::size_t layer = 0; layer < layers; ++layer)
        headers.push_back(headerOf(width, height, half, layer));
    const AtomicFile& file = files.write(name, [&](AtomicFile& out) {
        try {
            ExrToFile stream(out);
            Imf::MultiPartOutputFile output(stream, headers.data(), static_cast<int>(layers), false,
                                            0);
            for (std::size_t layer = 0; layer < layers; ++layer) {
                Imf::TiledOutputPart part(output, static_cast<int>(layer));
                for (int level = 0; level < part.numLevels(); ++level) {
                    ExrLevel of = texels(layer, static_cast<std::size_t>(level));
                    part.setFrameBuffer(slicesOf(of, half));
                    part.writeTiles(0, part.numXTiles(level) - 1, 0, part.numYTiles(level) - 1,
                                    level);
                }
            }
        } catch (const Error&) {
            throw;
        } catch (const std::exception& error) {
            throw OutputError(fmt::format("cannot write the EXR file: {}", error.what()));
        }
    });
    const MappedFile made(file.temporaryPath());
    const auto bytes = std::as_bytes(std::span(made.data(), made.size()));
    return {std::string(role), "exr-parts", name, bytes.size(), sha256(bytes)};
}

}  // namespace

MapTextureFile writeTextureExr(std::string_view role, const std::string& name,
                               const StoredLevels& stored, FileSet& files) {
    const LevelSize& size = stored.levels.front();
    return writeExr(
        role, name, stored.layers, static_cast<int>(size.width), static_cast<int>(size.height),
        stored.number == gpu::Number::float16,
        [&](std::size_t layer, std::size_t level) { return levelOf(stored, layer, level); }, files);
}

MapTextureFile writeSharedExr(const std::string& name, const gpu::Texels& texels, FileSet& files) {
    const auto width = static_cast<std::size_t>(texels.width);
    const auto height = static_cast<std::size_t>(texels.height);
    return writeExr(
        "shared", name, 1, texels.width, texels.height, false,
        [&](std::size_t, std::size_t level) {
            // Level 0 alone is read.
            ExrLevel of{std::max<std::size_t>(width >> level, 1),
                        std::max<std::size_t>(height >> level, 1)};
            of.bytes.assign(of.width * of.height * 16, std::byte{0});
            if (level == 0) of.bytes = texels.bytes;
            return of;
        },
        files);
}

std::vector<MapTextureFile> writeMapExr(const MaterialMap& map, const std::string& name,
                                        FileSet& files) {
    const MapSidecar& s = map.sidecar();
    std::vector<MapTextureFile> made{
        writeTextureExr("map", name + ".map.exr",
                        {.levels = s.levels,
                         .layers = s.layers(),
                         .number = s.number,
                         .bytes = [&](std::size_t level) { return map.level(level); }},
                        files)};
    map.checkIntact();
    if (s.form != "outgoing")
        made.push_back(writeSharedExr(name + ".shared.exr", sharedNumbers(s).texels, files));
    return made;
}

}  // namespace hshfit::inline material_maps::inline exports
