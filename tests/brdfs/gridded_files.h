#pragma once

// Files of gridded tables, written from the formats' descriptions and without the library.

#include <brdfs/measured_files.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <half.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace hshfit::test {

/// A UTIA `.bin` file: value(channel, theta_i, phi_i, theta_v, phi_v).
using UtiaCells = std::function<double(int, int, int, int, int)>;
inline std::string utiaFile(const UtiaCells& value) {
    std::string bytes(3 * 288 * 288 * 8, '\0');
    char* to = bytes.data();
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 288; ++i)
            for (int v = 0; v < 288; ++v, to += 8) {
                const double f = value(c, i / 48, i % 48, v / 48, v % 48);
                std::memcpy(to, &f, 8);
            }
    return bytes;
}

/// An MIT file: value(channel, theta_in, theta_out, phi_diff, phi_in) for these numbers of bins.
using MitCells = std::function<float(int, int, int, int, int)>;
inline std::array<std::int32_t, 16> mitHeader(const std::array<int, 4>& bins, bool half = false) {
    return {bins[0], bins[1], bins[2], bins[3], 0, 0, 1, 0, 0, half ? 1 : 0, 3, 0, 0, 0, 0, 0};
}
inline std::string mitFile(const std::array<int, 4>& bins, const MitCells& value,
                           bool half = false) {
    const auto header = mitHeader(bins, half);
    std::string bytes(reinterpret_cast<const char*>(header.data()), sizeof header);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < bins[0]; ++i)
            for (int o = 0; o < bins[1]; ++o)
                for (int d = 0; d < bins[2]; ++d)
                    for (int p = 0; p < bins[3]; ++p) {
                        const float f = value(c, i, o, d, p);
                        bytes.append(reinterpret_cast<const char*>(&f), sizeof f);
                    }
    return bytes;
}

/// A MERL `.slice` file: value(channel, theta_h, theta_d).
using SliceCells = std::function<float(int, int, int)>;
inline std::string merlSliceFile(const SliceCells& value) {
    std::string bytes;
    for (int d = 0; d < 90; ++d)
        for (int h = 0; h < 90; ++h)
            for (int c = 0; c < 3; ++c) {
                const float f = value(c, h, d);
                bytes.append(reinterpret_cast<const char*>(&f), sizeof f);
            }
    return bytes;
}

/// A picture by OpenEXR itself; the values are by column and row from the top.
using ExrPlanes = std::map<std::string, std::function<double(int, int)>>;
inline void writeExr(const std::string& path, int width, int height, Imf::PixelType type,
                     Imf::Compression compression, const ExrPlanes& planes) {
    Imf::Header header(width, height);
    header.compression() = compression;
    std::map<std::string, std::vector<float>> floats;
    std::map<std::string, std::vector<half>> halves;
    Imf::FrameBuffer buffer;
    const auto columns = static_cast<std::size_t>(width);
    for (const auto& [name, value] : planes) {
        header.channels().insert(name, Imf::Channel(type));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                floats[name].push_back(static_cast<float>(value(x, y)));
                halves[name].push_back(half(floats[name].back()));
            }
        buffer.insert(
            name,
            type == Imf::HALF
                ? Imf::Slice(type, reinterpret_cast<char*>(halves[name].data()), 2, 2 * columns)
                : Imf::Slice(type, reinterpret_cast<char*>(floats[name].data()), 4, 4 * columns));
    }
    Imf::OutputFile file(path.c_str(), header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
}

}  // namespace hshfit::test
