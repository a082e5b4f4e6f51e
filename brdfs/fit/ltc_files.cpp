#include <brdfs/fit/ltc_files.h>

#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <half.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cstdint>
#include <filesystem>

namespace hshfit::brdfs {
namespace {

using Json = nlohmann::ordered_json;

Json rowsOf(const LtcTable& table, const auto& valueOf) {
    Json rows = Json::array();
    for (int row = 0; row < table.size; ++row) {
        Json values = Json::array();
        for (int column = 0; column < table.size; ++column) values.push_back(valueOf(row, column));
        rows.push_back(std::move(values));
    }
    return rows;
}

std::string ltcJson(const LtcTable& table) {
    const auto pictures = ltcPictures(table);
    const auto texel = [&](int picture) {
        return [&table, &values = pictures[picture]](int row, int column) {
            const float* from = values.data() + 4 * (row * table.size + column);
            return Json(std::vector<float>(from, from + 4));
        };
    };
    const LtcTable::Summary summary = table.summary();
    Json document = {
        {"format", "hshfit-ltc"},
        {"version", 1},
        {"generator", std::string("hshfit ") + version},
        {"brdf", table.spec},
        {"parameter", table.parameter},
        {"size", table.size},
        {"values", table.values},
        {"cosines", table.cosines},
        {"summary",
         {{"mean_error", summary.meanError},
          {"largest_error", summary.largestError},
          {"mean_misplaced", summary.meanMisplaced},
          {"largest_uncertainty", summary.largestUncertainty},
          {"unsettled", summary.unsettled}}},
        {"ltc_1", rowsOf(table, texel(0))},
        {"ltc_2", rowsOf(table, texel(1))},
        {"error", rowsOf(table, [&](int y, int x) { return table.cell(y, x).error; })},
        {"misplaced", rowsOf(table, [&](int y, int x) { return table.cell(y, x).misplaced; })}};
    return jsonText(document) + "\n";
}

void writeExr(const LtcTable& table, const std::vector<float>& values, AtomicFile& file) {
    const auto size = static_cast<std::size_t>(table.size);
    writeExrPicture({.width = size,
                     .height = size,
                     .channels = {"R", "G", "B", "A"},
                     .values = values,
                     .attributes = {{"hshfit:format", "hshfit-ltc"},
                                    {"hshfit:brdf", table.spec},
                                    {"hshfit:parameter", table.parameter}}},
                    ExrPixels::single, file);
}

/// Microsoft's DDS header with a numeric FourCC, as in the published files: flags CAPS | HEIGHT |
/// WIDTH | PITCH | PIXELFORMAT, DDPF_FOURCC, 113 = D3DFMT_A16B16G16R16F, DDSCAPS_TEXTURE.
void writeDds(const LtcTable& table, const std::vector<float>& values, AtomicFile& file) {
    static_assert(std::endian::native == std::endian::little);
    const auto size = static_cast<std::uint32_t>(table.size);
    std::array<std::uint32_t, 32> header{};
    header[0] = 0x20534444;  // "DDS "
    header[1] = 124;
    header[2] = 0x100f;
    header[3] = header[4] = size;
    header[5] = size * 8;       // bytes of a row
    header[6] = header[7] = 1;  // depth, levels
    header[19] = 32;            // size of the pixel format
    header[20] = 4;             // has a FourCC
    header[21] = 113;
    header[27] = 0x1000;
    file.write(std::as_bytes(std::span(header)));
    std::vector<std::uint16_t> halves;
    constexpr float most = 65504;
    for (const float value : values) halves.push_back(half(std::min(value, most)).bits());
    file.write(std::as_bytes(std::span(halves)));
}

}  // namespace

std::array<std::vector<float>, 2> ltcPictures(const LtcTable& table) {
    std::array<std::vector<float>, 2> pictures;
    const double last = table.size - 1;
    for (int row = 0; row < table.size; ++row)
        for (int column = 0; column < table.size; ++column) {
            const LtcLobe& lobe = table.cell(row, column);
            const Ltc& ltc = lobe.ltc;
            for (const double value : {ltc.a, ltc.c, ltc.b, ltc.d})
                pictures[0].push_back(static_cast<float>(value));
            const double sphere = sphereAboveHorizon(2 * column / last - 1, row / last);
            for (const double value : {lobe.magnitude, lobe.fresnel, 0.0, sphere})
                pictures[1].push_back(static_cast<float>(value));
        }
    return pictures;
}

std::vector<std::string> ltcOutputs(const std::string& path) {
    const std::string extension = extensionOf(path);
    if (extension == ".json") return {path};
    if (extension != ".exr" && extension != ".dds")
        throw UsageError(fmt::format("{}: tables are written as .json, .exr or .dds", path));
    const std::string stem = path.substr(0, path.size() - extension.size());
    return {stem + "_1" + extension, stem + "_2" + extension};
}

std::vector<std::string> writeLtcTable(const LtcTable& table, const std::string& path) {
    FileSet files(".", true);
    std::vector<std::string> outputs = writeLtcTable(table, path, files);
    files.commit();
    return outputs;
}

std::vector<std::string> writeLtcTable(const LtcTable& table, const std::string& path,
                                       FileSet& files) {
    std::vector<std::string> outputs = ltcOutputs(path);
    if (outputs.size() == 1) {
        files.write(path, ltcJson(table));
        return outputs;
    }
    const auto pictures = ltcPictures(table);
    const auto write = extensionOf(path) == ".exr" ? writeExr : writeDds;
    for (std::size_t i = 0; i < outputs.size(); ++i)
        files.write(outputs[i], [&](AtomicFile& file) { write(table, pictures[i], file); });
    return outputs;
}

}  // namespace hshfit::brdfs
