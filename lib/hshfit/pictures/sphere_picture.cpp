#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/exr_picture.h>
#include <hshfit/files/extension.h>
#include <hshfit/pictures/rgb_picture.h>
#include <hshfit/pictures/sphere_picture.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace hshfit::inline pictures {
namespace {

/// The largest channel of every pixel of spheres.
std::vector<float> largestChannels(std::span<const SpherePicture> spheres) {
    std::vector<float> largest;
    for (const SpherePicture& sphere : spheres) {
        for (std::size_t i = 0; i < sphere.coverage.size(); ++i) {
            if (sphere.coverage[i] == 0) continue;
            const float* rgb = sphere.radiance.data() + 3 * i;
            largest.push_back(*std::max_element(rgb, rgb + 3));
        }
    }
    return largest;
}

/// The largest channel of every pixel of which `share` is at or below it; 0 without pixels.
double quantileOfPixels(std::span<const SpherePicture> spheres, double share) {
    std::vector<float> largest = largestChannels(spheres);
    if (largest.empty()) return 0;
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(largest.size() - 1));
    std::nth_element(largest.begin(), largest.begin() + at, largest.end());
    return largest[static_cast<std::size_t>(at)];
}

std::size_t columnsOf(const Sheet& sheet) {
    std::size_t columns = 0;
    for (const auto& row : sheet) columns = std::max(columns, row.size());
    return columns;
}

/// Calls `put(picture, pixel of it, row and column of the sheet)` for every pixel.
template <class Put>
void forEachPixel(const Sheet& sheet, std::size_t size, const Put& put) {
    for (std::size_t r = 0; r < sheet.size(); ++r) {
        for (std::size_t s = 0; s < sheet[r].size(); ++s) {
            assert(static_cast<std::size_t>(sheet[r][s].size) == size);
            for (std::size_t i = 0; i < size * size; ++i) {
                put(sheet[r][s], i, r * size + i / size, s * size + i % size);
            }
        }
    }
}

std::size_t sizeOf(const Sheet& sheet) {
    assert(!sheet.empty() && !sheet.front().empty());
    return static_cast<std::size_t>(sheet.front().front().size);
}

void requireFiniteSheet(const std::string& name, const Sheet& sheet) {
    for (const auto& row : sheet) {
        for (const SpherePicture& picture : row)
            requireFinite(name, static_cast<std::size_t>(picture.size), picture.radiance);
    }
}

ExrPicture exrOf(const Sheet& sheet) {
    const std::size_t size = sizeOf(sheet);
    ExrPicture exr{.width = size * columnsOf(sheet),
                   .height = size * sheet.size(),
                   .channels = {"R", "G", "B", "A"}};
    const bool errors = std::ranges::any_of(sheet, [](const auto& row) {
        return std::ranges::any_of(row, [](const SpherePicture& s) { return !s.error.empty(); });
    });
    if (errors) exr.channels.emplace_back("error.Y");
    exr.values.resize(exr.width * exr.height * exr.channels.size());
    forEachPixel(
        sheet, size,
        [&](const SpherePicture& sphere, std::size_t i, std::size_t row, std::size_t column) {
            const float coverage = sphere.coverage[i];
            for (std::size_t c = 0; c < 3; ++c) {
                exr.at(row, column, c) = coverage * sphere.radiance[3 * i + c];
            }
            exr.at(row, column, 3) = coverage;
            if (!sphere.error.empty()) exr.at(row, column, 4) = sphere.error[i];
        });
    return exr;
}

}  // namespace

double automaticExposure(std::span<const SpherePicture> spheres) {
    return automaticExposure(largestChannels(spheres));
}

SpherePicture sphereDifference(const SpherePicture& reference, const SpherePicture& approximation) {
    assert(reference.size == approximation.size);
    SpherePicture difference = approximation;
    difference.error.clear();
    for (std::size_t i = 0; i < difference.radiance.size(); ++i) {
        difference.radiance[i] -= reference.radiance[i];
    }
    return difference;
}

double meanSquare(const SpherePicture& sphere) {
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < sphere.radiance.size(); ++i) {
        const double value = sphere.radiance[i], covered = sphere.coverage[i / 3];
        sum += covered * value * value;
        weight += covered;
    }
    return weight > 0 ? sum / weight : 0;
}

SpherePicture amplified(const SpherePicture& difference, double factor) {
    SpherePicture shown = difference;
    for (float& value : shown.radiance) value = static_cast<float>(factor * std::abs(value));
    return shown;
}

double amplificationFor(const SpherePicture& difference, double stops) {
    const SpherePicture magnitude = amplified(difference, 1);
    const double large = quantileOfPixels({&magnitude, 1}, 0.98) * std::exp2(stops);
    double best = 1;
    if (large <= 0) return best;
    for (const double factor : {2, 5, 10, 20, 50, 100, 200, 500, 1000}) {
        if (factor * large <= shownAsWhite) best = factor;
    }
    return best;
}

std::string spheresPng(std::span<const SpherePicture> spheres, double stops) {
    return sheetPng({spheres}, stops);
}

std::string sheetPng(const Sheet& sheet, double stops) {
    requireFiniteSheet("a picture", sheet);
    const std::size_t size = sizeOf(sheet), width = size * columnsOf(sheet);
    const double scale = std::exp2(stops);
    std::vector<std::uint8_t> pixels(width * size * sheet.size() * 4);
    forEachPixel(
        sheet, size,
        [&](const SpherePicture& sphere, std::size_t i, std::size_t row, std::size_t column) {
            std::uint8_t* pixel = pixels.data() + 4 * (row * width + column);
            for (std::size_t c = 0; c < 3; ++c) {
                pixel[c] = encoded(scale * sphere.radiance[3 * i + c]);
            }
            pixel[3] = static_cast<std::uint8_t>(std::lround(255 * sphere.coverage[i]));
        });
    return pngOf(pixels, width, size * sheet.size());
}

void checkSpheresPath(const std::string& path) {
    if (extensionOf(path) == ".png" || extensionOf(path) == ".exr") return;
    throw UsageError(fmt::format("'{}': the picture's extension has to be .png or .exr", path));
}

void writeSpheres(std::span<const SpherePicture> spheres, double stops, const std::string& path,
                  const std::map<std::string, std::string>& attributes) {
    checkSpheresPath(path);
    AtomicFile file(path);
    writeSpheres(spheres, stops, file, attributes);
    file.commit();
}

void writeSpheres(std::span<const SpherePicture> spheres, double stops, AtomicFile& file,
                  const std::map<std::string, std::string>& attributes) {
    writeSheet({spheres}, stops, file, attributes);
}

void writeSheet(const Sheet& sheet, double stops, AtomicFile& file,
                const std::map<std::string, std::string>& attributes) {
    checkSpheresPath(file.path());
    requireFiniteSheet(file.path(), sheet);
    if (extensionOf(file.path()) == ".png") {
        file.write(sheetPng(sheet, stops));
        return;
    }
    ExrPicture exr = exrOf(sheet);
    exr.attributes = attributes;
    writeExrPicture(exr, ExrPixels::single, file);
}

}  // namespace hshfit::inline pictures
