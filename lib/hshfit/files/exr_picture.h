#pragma once

#include <hshfit/files/atomic_file.h>

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline files {

/// A flat OpenEXR picture: numbers in named channels, and words about them.
struct ExrPicture {
    std::size_t width = 0, height = 0;
    std::vector<std::string> channels = {};
    std::vector<float> values = {};  ///< [row][column][channel], row 0 at the top
    std::map<std::string, std::string> attributes = {};  ///< the attributes of type string

    float& at(std::size_t row, std::size_t column, std::size_t channel) {
        return values[(row * width + column) * channels.size() + channel];
    }
    float at(std::size_t row, std::size_t column, std::size_t channel) const {
        return values[(row * width + column) * channels.size() + channel];
    }
};

/// The number type of the pixels. half: 11 significant bits, magnitudes up to 65504.
enum class ExrPixels { half, single };

/// One scan-line part with ZIP compression. Throws OutputError.
void writeExrPicture(const ExrPicture& picture, ExrPixels pixels, AtomicFile& file);

/// Reads a file that checkExrHeader lets through as a picture; values are not checked. Throws
/// InputError that starts with `file`, also if there are more than `most` values.
ExrPicture readExrPicture(std::string_view bytes, const std::string& file, std::size_t most);

}  // namespace hshfit::inline files
