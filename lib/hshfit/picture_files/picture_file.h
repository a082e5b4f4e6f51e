#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline picture_files {

/// The meaning of R, G and B in a file of floating-point numbers.
struct PictureColour {
    /// x and y of red, green, blue and white: `chromaticities` of OpenEXR, PRIMARIES of Radiance.
    std::optional<std::array<double, 8>> primaries = {};
    /// EXPOSURE and COLORCORR of Radiance, products over all lines of the header: radiance is the
    /// stored value divided by both.
    double exposure = 1;
    std::array<double, 3> correction{1, 1, 1};
};

/// A flat picture file through OpenImageIO, a few rows in memory at a time: OpenEXR, Radiance HDR,
/// PNG, JPEG, TIFF, BMP, PNM and PFM, told apart by their first bytes; at most 2^28 pixels,
/// upright. The picture is the display window of OpenEXR, all of which has to be stored; pixels
/// beside it are left out. Row 0 is at the top. One thread at a time.
///
/// Throws InputError that starts with the path for a file that is absent, of no known format, cut
/// short or damaged as far as its header, its checksums (PNG) and its end (JPEG) tell; `read`
/// finds the rest.
class PictureFile {
public:
    /// Part number `part` of an OpenEXR file of several.
    explicit PictureFile(const std::string& path, std::size_t part = 0);
    ~PictureFile();
    PictureFile(const PictureFile&) = delete;
    PictureFile& operator=(const PictureFile&) = delete;

    const std::string& path() const;
    std::size_t width() const;
    std::size_t height() const;
    std::string format() const;       ///< "OpenEXR", "Radiance HDR", "PNG", …
    std::string number() const;       ///< "half", "float", "uint8", …
    bool wholeNumbers() const;        ///< values are fractions of the largest code, 0 to 1
    std::string environment() const;  ///< of an OpenEXR environment map: the kind
    const std::vector<std::string>& channels() const;
    std::size_t parts() const;
    std::string partName(std::size_t part) const;  ///< "" where it has none
    const std::vector<std::string>& partChannels(std::size_t part) const;
    const PictureColour& colour() const { return colour_; }
    /// The mark of a gain map in a JPEG file, "hdrgm:Version" of Ultra HDR and so on: what is read
    /// is its base picture, which is made for ordinary screens. Empty without one.
    std::string gainMap() const;
    /// The index of a channel, by its name in any case or, for R, G, B and A, by "red", …; none
    /// where there is no such channel.
    int find(std::string_view channel) const;

    /// Rows to read at a time: the height of a tile, else as many as fit into 16 MiB for `channels`
    /// channels, at most 256.
    std::size_t blockRows(std::size_t channels) const;
    /// Rows [top, bottom) of channels [first, last): out[row][column][channel], values as stored.
    /// `top` and `bottom` lie on multiples of `blockRows` or at the end of the picture.
    void read(std::size_t top, std::size_t bottom, int first, int last, float* out);

    /// Throws InputError if the file was changed since it was opened.
    void checkIntact() const;
    [[noreturn]] void fail(const std::string& what) const;

private:
    struct State;
    std::unique_ptr<State> state_;
    PictureColour colour_;
};

/// Whether a file that starts with `head` is of a format that is read.
bool hasPictureMagic(std::string_view head);

}  // namespace hshfit::inline picture_files
