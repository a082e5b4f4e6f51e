#include <hshfit/pictures/rgb_picture.h>

#include <hshfit/error.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/mapped_file.h>

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hshfit::inline pictures {
namespace {

constexpr std::array<const char*, 3> colours{"R", "G", "B"};
/// Linear sRGB of the first step of eight bits above black.
constexpr double firstStep = 1 / (255 * 12.92);

}  // namespace

unsigned char encoded(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    const double s = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    return static_cast<unsigned char>(std::lround(255 * s));
}

std::string pngOf(std::span<const unsigned char> rgba, std::size_t width, std::size_t height) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGBA;
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
    png_alloc_size_t length = bytes.size();
    if (!png_image_write_to_memory(&image, bytes.data(), &length, 0, rgba.data(), 0, nullptr)) {
        throw OutputError(fmt::format("the picture could not be encoded as PNG: {}",
                                      static_cast<const char*>(image.message)));
    }
    bytes.resize(length);
    return bytes;
}

double automaticExposure(const RgbPicture& picture) {
    std::vector<float> largest;
    for (std::size_t i = 0; i < picture.values.size(); i += 3)
        largest.push_back(*std::max_element(&picture.values[i], &picture.values[i] + 3));
    return automaticExposure(std::move(largest));
}

double automaticExposure(std::vector<float> largest) {
    if (largest.empty()) return 0;
    const auto at = largest.begin() +
                    static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(largest.size() - 1));
    std::nth_element(largest.begin(), at, largest.end());
    const double brightest = *std::max_element(at, largest.end());
    if (!(brightest > 0)) return 0;
    const double shown = std::max(static_cast<double>(*at), firstStep * brightest);
    return std::round(10 * std::log2(shownAsWhite / shown)) / 10 + 0.0;  // -0 is 0
}

void requireFinite(const std::string& name, std::size_t width, std::span<const float> rgb) {
    const auto bad = std::ranges::find_if_not(rgb, [](float v) { return std::isfinite(v); });
    if (bad == rgb.end()) return;
    const auto pixel = static_cast<std::size_t>(bad - rgb.begin()) / 3;
    throw NumericError(
        fmt::format("{}: the value {} of the pixel in column {}, row {} is not finite", name, *bad,
                    pixel % width, pixel / width));
}

std::string rgbPng(const RgbPicture& picture, double stops) {
    requireFinite("a picture", static_cast<std::size_t>(picture.width), picture.values);
    const double scale = std::exp2(stops);
    std::vector<unsigned char> pixels;
    pixels.reserve(picture.values.size() / 3 * 4);
    for (std::size_t i = 0; i < picture.values.size(); ++i) {
        pixels.push_back(encoded(scale * static_cast<double>(picture.values[i])));
        if (i % 3 == 2) pixels.push_back(255);
    }
    return pngOf(pixels, static_cast<std::size_t>(picture.width),
                 static_cast<std::size_t>(picture.height));
}

void writeRgbExr(const RgbPicture& picture, std::span<const NamedPicture> more, AtomicFile& file,
                 const std::map<std::string, std::string>& attributes) {
    requireFinite(file.path(), static_cast<std::size_t>(picture.width), picture.values);
    for (const NamedPicture& one : more)
        requireFinite(file.path() + ": " + one.name, static_cast<std::size_t>(picture.width),
                      one.picture->values);
    ExrPicture exr{.width = static_cast<std::size_t>(picture.width),
                   .height = static_cast<std::size_t>(picture.height),
                   .channels = {colours.begin(), colours.end()}};
    for (const NamedPicture& one : more)
        for (const char* colour : colours) exr.channels.push_back(one.name + "." + colour);
    for (std::size_t pixel = 0; pixel < exr.width * exr.height; ++pixel) {
        const auto put = [&](const RgbPicture& from) {
            exr.values.insert(exr.values.end(), &from.values[3 * pixel],
                              &from.values[3 * pixel] + 3);
        };
        put(picture);
        for (const NamedPicture& one : more) put(*one.picture);
    }
    exr.attributes = attributes;
    writeExrPicture(exr, ExrPixels::single, file);
}

RgbPicture readRgbExr(const std::string& path) {
    constexpr std::size_t mostValues = std::size_t{1} << 30;
    const MappedFile file(path);
    const ExrPicture exr =
        readExrPicture({reinterpret_cast<const char*>(file.data()), file.size()}, path, mostValues);
    std::array<std::size_t, 3> at{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto found = std::ranges::find(exr.channels, colours[c]);
        if (found == exr.channels.end())
            throw InputError(fmt::format("{}: it has no channel {}", path, colours[c]));
        at[c] = static_cast<std::size_t>(found - exr.channels.begin());
    }
    RgbPicture picture{static_cast<int>(exr.width), static_cast<int>(exr.height)};
    for (std::size_t row = 0; row < exr.height; ++row)
        for (std::size_t column = 0; column < exr.width; ++column)
            for (const std::size_t c : at) picture.values.push_back(exr.at(row, column, c));
    return picture;
}

}  // namespace hshfit::inline pictures
