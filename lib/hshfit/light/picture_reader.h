#pragma once

#include <hshfit/light/picture_layout.h>
#include <hshfit/picture_files/picture_file.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::inline light {

/// A code of values and its name in specifications.
struct CurveName {
    TransferCurve curve;
    std::string_view name, help;
};
std::span<const CurveName> curveNames();
std::string_view curveName(TransferCurve curve);

/// The linear value of a code value: both 0 to 1 for whole-number formats.
double decoded(TransferCurve curve, double value);

/// Facts that a file may not tell.
struct PictureOptions {
    std::optional<PictureLayout> layout = {};  ///< none: by the size
    std::optional<TransferCurve> curve = {};   ///< none: linear, for floating-point files only
    /// For an OpenEXR file: the name or the number, from 1, of a part, and the words before ".R" of
    /// its channels. Empty: the only one with R, G and B; of several, the one without such words.
    std::string part = {}, layer = {};
};

/// A part of a picture file and its channels.
struct PicturePart {
    std::string name;
    std::vector<std::string> channels;
};

struct PictureFacts {
    std::string format;  ///< "OpenEXR", "Radiance HDR", "PNG", …
    std::string number;  ///< "half", "float", "uint8", …
    TransferCurve curve = TransferCurve::linear;
    /// The geometry of the rows that are given. A dome of rows is given as the latlong picture of
    /// both hemispheres, with black rows below the horizon.
    PictureGeometry geometry;
    PictureLayout layout = PictureLayout::latlong;  ///< of the file
    std::size_t fileHeight = 0;                     ///< rows of the file
    /// Parts of the file, or of the first of six.
    std::vector<PicturePart> parts = {};
    std::size_t part = 0;  ///< the one that is read
    std::string layer = {};
    PictureColour colour = {};  ///< of the file; the rows have it taken into account
};

/// Rows of a picture, [column][R, G, B].
using RowVisitor = std::function<void(std::size_t row, std::span<const float> rgb)>;

/// A picture file through OpenImageIO, a few rows in memory at a time: OpenEXR, Radiance HDR, PNG,
/// JPEG, TIFF, BMP, PNM and PFM, told apart by their first bytes; colour, or grey for all three
/// channels; at most 2^28 pixels. Six files are one picture of faces in a column: `path` with
/// "{face}" or "%s" for the names of one of `faceNames()`. Row 0 is at the top; alpha is ignored.
/// Primaries other than Rec. 709 are converted, EXPOSURE and COLORCORR divided out.
///
/// Throws InputError that starts with the path for a file that is absent, broken or of no known
/// format, a size that fits no layout, or not the one asked for, and whole numbers without a curve.
class PictureReader {
public:
    PictureReader(const std::string& path, const PictureOptions& options);
    ~PictureReader();
    PictureReader(const PictureReader&) = delete;
    PictureReader& operator=(const PictureReader&) = delete;

    const std::string& path() const { return path_; }
    const PictureFacts& facts() const { return facts_; }

    /// Each row from the top, in linear values that are not checked. Once.
    void forEachRow(const RowVisitor& visit);

private:
    class File;
    std::string path_;
    PictureFacts facts_;
    std::vector<std::unique_ptr<File>> files_;  ///< one, or six below each other
};

/// Names of the faces in order: right, left, top, bottom, front, back.
using FaceNames = std::array<std::string_view, 6>;
std::span<const FaceNames> faceNames();

/// Whether a text is the path of a file, or of six with "{face}" or "%s".
bool isPicturePath(std::string_view text);

}  // namespace hshfit::inline light
