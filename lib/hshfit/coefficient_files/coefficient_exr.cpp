#include <hshfit/coefficient_files/coefficient_formats.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/exr_stream.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/printable.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::inline coefficient_files {
namespace {

constexpr std::string_view prefix = "hshfit:";
/// More channels than this take OpenEXR minutes to write.
constexpr std::size_t maxChannels = 100'000;

/// Keys whose attribute holds the bare string; the others hold JSON text.
constexpr std::array<std::string_view, 5> stringKeys{"format", "generator", "quantity",
                                                     "channel_kind", "energy_reason"};

/// The suffix of each channel in an EXR channel name: "Y"; "R", "G", "B"; "550,5nm", "m01_550,5nm"
/// (a decimal comma, because a point separates layers).
std::vector<std::string> suffixes(const Channels& channels) {
    if (channels.kind == Channels::Kind::grey) return {"Y"};
    if (channels.kind == Channels::Kind::rgb) return {"R", "G", "B"};
    std::vector<std::string> names = channels.names();
    for (std::string& name : names) std::replace(name.begin(), name.end(), '.', ',');
    return names;
}

/// [channel * slots + slot]: "c007.R", with the digits that the last slot needs, at least three.
std::vector<std::string> channelNames(const Channels& channels, std::size_t slots) {
    const std::size_t digits = std::max<std::size_t>(3, std::to_string(slots - 1).size());
    std::vector<std::string> names;
    for (const auto& suffix : suffixes(channels)) {
        for (std::size_t slot = 0; slot < slots; ++slot) {
            names.push_back(fmt::format("c{:0{}}.{}", slot, digits, suffix));
        }
    }
    return names;
}

/// Every channel as a slice of `pixels`, [row][column][channel * slots + slot].
Imf::FrameBuffer slices(const std::vector<std::string>& names, std::vector<float>& pixels,
                        int width) {
    const std::size_t step = names.size() * sizeof(float);
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < names.size(); ++i) {
        buffer.insert(names[i], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&pixels[i]), step,
                                           step * static_cast<std::size_t>(width)));
    }
    return buffer;
}

std::vector<float> rounded(const Coefficients& c) {
    std::vector<float> pixels(c.values.size());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (std::abs(c.values[i]) > double{std::numeric_limits<float>::max()}) {
            throw NumericError(fmt::format(
                "coefficient {:g} is beyond float32, which is what .exr holds; write .json",
                c.values[i]));
        }
        pixels[i] = static_cast<float>(c.values[i]);
    }
    return pixels;
}

/// The `hshfit:` attributes as the JSON object that the other form starts with.
std::string metadataText(const Imf::Header& header, const std::string& file) {
    std::string text = "{";
    for (auto i = header.begin(); i != header.end(); ++i) {
        const std::string_view name = i.name();
        if (!name.starts_with(prefix)) continue;
        const auto* attribute = dynamic_cast<const Imf::StringAttribute*>(&i.attribute());
        if (!attribute) {
            throw InputError(
                fmt::format("{}: the attribute '{}' has to be a string", file, printable(name)));
        }
        const std::string key(name.substr(prefix.size()));
        const bool bare = std::find(stringKeys.begin(), stringKeys.end(), key) != stringKeys.end();
        using Json = nlohmann::json;
        const auto quote = [](const std::string& word) { return jsonText(Json(word)); };
        const std::string value = bare ? quote(attribute->value()) : attribute->value();
        if (!Json::accept(value)) {
            throw InputError(
                fmt::format("{}: the attribute '{}' is not valid JSON", file, printable(name)));
        }
        text += fmt::format("{}{}:{}", text.size() > 1 ? "," : "", quote(key), value);
    }
    return text + "}";
}

Coefficients readChecked(std::string_view bytes, const ExrHeader& size, const std::string& file) {
    ExrFromMemory stream(bytes);
    Imf::InputFile input(stream, 0);
    const std::size_t count = size.width * size.height;
    const auto metadata = parseJson(metadataText(input.header(), file), file, deepestJson);
    Coefficients c{readHead(JsonFields(metadata, "", file), count)};
    if (static_cast<std::size_t>(c.outgoing.width) != size.width) {
        throw InputError(fmt::format("{}: is {} x {} pixels; its outgoing directions are {} x {}",
                                     file, size.width, size.height, c.outgoing.width,
                                     c.outgoing.height));
    }
    const std::size_t layers = c.channels.count() * c.slots();
    if (size.channels != layers) {
        throw InputError(fmt::format("{}: has {} channels; order {} and {} colour channels need {}",
                                     file, size.channels, c.order, c.channels.count(), layers));
    }
    const auto names = channelNames(c.channels, c.slots());
    for (const auto& name : names) {
        if (!input.header().channels().findChannel(name)) {
            throw InputError(fmt::format("{}: has no channel '{}'", file, name));
        }
    }
    std::vector<float> pixels(count * layers);
    input.setFrameBuffer(slices(names, pixels, c.outgoing.width));
    input.readPixels(0, static_cast<int>(size.height) - 1);
    const auto bad = std::find_if_not(pixels.begin(), pixels.end(),
                                      [](float value) { return std::isfinite(value); });
    if (bad != pixels.end()) {
        const auto at = static_cast<std::size_t>(bad - pixels.begin());
        throw InputError(fmt::format("{}: channel '{}' is not finite at column {}, row {}", file,
                                     names[at % layers], at / layers % size.width,
                                     at / layers / size.width));
    }
    c.values.assign(pixels.begin(), pixels.end());
    return c;
}

}  // namespace

void coefficientsToExr(const Coefficients& c, AtomicFile& file) {
    requireFinite(c);
    const std::size_t layers = c.channels.count() * c.slots();
    if (layers > maxChannels) {
        throw UsageError(fmt::format(
            "an .exr of {} channels is out of reach of its readers (at most {}); write .json",
            layers, maxChannels));
    }
    std::vector<float> pixels = rounded(c);
    Imf::Header header(c.outgoing.width, c.outgoing.height);
    header.compression() = Imf::RLE_COMPRESSION;
    for (const auto& [key, text] : metadataOf(c)) {
        const bool bare = std::find(stringKeys.begin(), stringKeys.end(), key) != stringKeys.end();
        const std::string value = bare ? nlohmann::json::parse(text).get<std::string>() : text;
        header.insert(std::string(prefix) + key, Imf::StringAttribute(value));
    }
    const auto names = channelNames(c.channels, c.slots());
    for (const auto& name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    try {
        ExrToFile stream(file);
        Imf::OutputFile output(stream, header, 0);
        output.setFrameBuffer(slices(names, pixels, c.outgoing.width));
        output.writePixels(c.outgoing.height);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw OutputError(fmt::format("cannot write the EXR file: {}", error.what()));
    }
}

Coefficients coefficientsFromExr(std::string_view bytes, const std::string& file) {
    const ExrHeader size = checkExrHeader(bytes, file);
    try {
        return readChecked(bytes, size, file);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(
            fmt::format("{}: invalid OpenEXR data: {}", file, printable(error.what())));
    }
}

}  // namespace hshfit::inline coefficient_files
