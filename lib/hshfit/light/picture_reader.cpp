#include <hshfit/light/picture_reader.h>

#include <hshfit/error.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/light/internal/image_module.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace hshfit::inline light {
namespace {

constexpr std::uint64_t mostPixels = std::uint64_t{1} << 28;
constexpr std::size_t blockBytes = std::size_t{1} << 24;
constexpr std::size_t mostTileBytes = std::size_t{1} << 28;
constexpr std::size_t mostBlockRows = 256;  // as many as any compression of OpenEXR joins

constexpr CurveName curves[] = {
    {TransferCurve::linear, "linear", "values are radiance"},
    {TransferCurve::srgb, "srgb", "IEC 61966-2-1"},
    {TransferCurve::rec709, "rec709", "the inverse of the camera curve of ITU-R BT.709"},
    {TransferCurve::gamma18, "gamma1.8", "value to the power of 1.8"},
    {TransferCurve::gamma22, "gamma2.2", "value to the power of 2.2"},
    {TransferCurve::gamma24, "gamma2.4", "value to the power of 2.4"},
};

constexpr FaceNames faces[] = {
    {"px", "nx", "py", "ny", "pz", "nz"},
    {"posx", "negx", "posy", "negy", "posz", "negz"},
    {"right", "left", "top", "bottom", "front", "back"},
    {"right", "left", "up", "down", "front", "back"},
};

// --- formats --------------------------------------------------------------------------------

struct PictureFormat {
    const char* plugin;  ///< of OpenImageIO
    std::string_view name;
    std::string_view start;
};
constexpr PictureFormat formats[] = {
    {"openexr", "OpenEXR", {"\x76\x2f\x31\x01", 4}},
    {"hdr", "Radiance HDR", "#?"},
    {"png", "PNG", {"\x89PNG\r\n\x1a\n", 8}},
    {"jpeg", "JPEG", "\xff\xd8\xff"},
    {"tiff", "TIFF", {"II*\0", 4}},
    {"tiff", "TIFF", {"MM\0*", 4}},
    {"bmp", "BMP", "BM"},
    {"pnm", "PNM", "P5"},
    {"pnm", "PNM", "P6"},
    {"pnm", "PFM", "PF"},
    {"pnm", "PFM", "Pf"},
};

/// Two letters say little: white space follows those of PNM, and zeros the length in a BMP file.
bool starts(std::string_view head, const PictureFormat& format) {
    if (!head.starts_with(format.start)) return false;
    if (format.start[0] == 'P') return head.size() > 2 && (head[2] == '\n' || head[2] == ' ');
    if (format.start == "BM")
        return head.size() > 9 && head.substr(6, 4) == std::string_view("\0\0\0\0", 4);
    return true;
}

const PictureFormat& formatOf(const MappedFile& file) {
    const std::string_view head(reinterpret_cast<const char*>(file.data()), file.size());
    for (const PictureFormat& format : formats) {
        if (starts(head, format)) return format;
    }
    throw InputError(
        fmt::format("{}: of no known picture format; known: OpenEXR, Radiance HDR, "
                    "PNG, JPEG, TIFF, BMP, PNM, PFM",
                    file.path()));
}

/// Whether compressed data reach the marker of the end: libjpeg makes up what is missing.
bool jpegIsWhole(std::span<const unsigned char> bytes) {
    std::size_t at = 2;  // the segments before the first scan
    while (at + 4 <= bytes.size() && bytes[at] == 0xff && bytes[at + 1] != 0xda) {
        at += 2 + 256 * std::size_t{bytes[at + 2]} + bytes[at + 3];
    }
    for (; at + 1 < bytes.size(); ++at) {
        if (bytes[at] == 0xff && bytes[at + 1] == 0xd9) return true;
    }
    return false;
}

/// Whether the chunks reach the last one and keep their checksums: libpng prints what is wrong.
bool pngIsWhole(std::span<const unsigned char> bytes) {
    const auto number = [&](std::size_t at) {
        return std::size_t{bytes[at]} << 24 | std::size_t{bytes[at + 1]} << 16 |
               std::size_t{bytes[at + 2]} << 8 | std::size_t{bytes[at + 3]};
    };
    constexpr std::size_t around = 12;  // length, name, checksum
    for (std::size_t at = 8; at + around <= bytes.size();) {
        const std::size_t length = number(at);
        if (length > bytes.size() - at - around) return false;
        const unsigned char* name = bytes.data() + at + 4;
        if (crc32(0, name, static_cast<uInt>(length + 4)) != number(at + 8 + length)) return false;
        if (std::equal(name, name + 4, "IEND")) return true;
        at += around + length;
    }
    return false;
}

std::string firstLine(std::string text) {
    return text.substr(0, text.find('\n'));
}

std::string lower(std::string text) {
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return text;
}

// --- six files ------------------------------------------------------------------------------

/// {position, length} of "{face}" or "%s".
std::pair<std::size_t, std::size_t> facePlace(std::string_view path) {
    for (const std::string_view mark : {"{face}", "%s"}) {
        if (const std::size_t at = path.find(mark); at != std::string_view::npos) {
            return {at, mark.size()};
        }
    }
    return {std::string_view::npos, 0};
}

std::string facePath(std::string_view path, std::string_view name) {
    const auto [at, length] = facePlace(path);
    return fmt::format("{}{}{}", path.substr(0, at), name, path.substr(at + length));
}

bool isFile(std::string_view path) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
}

/// The files of a path: itself, or those of the first names of which one exists.
std::vector<std::string> filesOf(const std::string& path) {
    if (isFile(path) || facePlace(path).second == 0) return {path};
    for (const FaceNames& names : faces) {
        std::vector<std::string> paths;
        for (const std::string_view name : names) paths.push_back(facePath(path, name));
        if (std::ranges::any_of(paths, isFile)) return paths;
    }
    std::vector<std::string> known;
    for (const FaceNames& names : faces) known.push_back(fmt::format("{}", fmt::join(names, " ")));
    throw InputError(
        fmt::format("{}: no such files; names of faces: {}", path, fmt::join(known, ", ")));
}

}  // namespace

// --- one file -------------------------------------------------------------------------------

/// One file, opened, its header checked.
class PictureReader::File {
public:
    explicit File(const std::string& path) : mapped_(path) {
        const PictureFormat& format = formatOf(mapped_);
        format_ = format.name;
        if (format_ == "JPEG" && !jpegIsWhole(mapped_.bytes())) fail("breaks off");
        if (format_ == "PNG" && !pngIsWhole(mapped_.bytes())) fail("breaks off or is damaged");
        std::string error;
        image_.reset(imageModule()(format.plugin, path.c_str(), error));
        if (!image_) fail(why(error));
        checkSpec();
        chooseChannels();
    }

    std::size_t width() const { return static_cast<std::size_t>(image_->width); }
    std::size_t height() const { return static_cast<std::size_t>(image_->height); }
    const std::string& format() const { return format_; }
    std::string number() const { return image_->number; }
    bool wholeNumbers() const { return !image_->floating; }

    void forEachRow(std::size_t firstRow, TransferCurve curve, const RowVisitor& visit) {
        const std::vector<float> table = codes(curve);
        const std::size_t stride = static_cast<std::size_t>(last_ - first_);
        std::vector<float> block(blockRows() * width() * stride), rgb(3 * width());
        for (std::size_t top = 0; top < height(); top += blockRows()) {
            const std::size_t bottom = std::min(top + blockRows(), height());
            readBlock(static_cast<int>(top), static_cast<int>(bottom), block.data());
            for (std::size_t row = top; row < bottom; ++row) {
                const float* values = block.data() + (row - top) * width() * stride;
                for (std::size_t column = 0; column < width(); ++column) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        const float value = values[column * stride + channels_[c]];
                        rgb[3 * column + c] = table.empty() ? value : lookedUp(table, value);
                    }
                }
                visit(firstRow + row, rgb);
            }
        }
        mapped_.checkIntact();
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("{}: {}", mapped_.path(), what));
    }
    std::string why(const std::string& message) const {
        return message.empty()
                   ? fmt::format("is no valid {} file", format_)
                   : fmt::format("is no valid {} file: {}", format_, firstLine(message));
    }

    void checkSpec() {
        const ImageModulePicture& i = *image_;
        if (i.deep) fail("holds deep data; a picture of light is flat");
        if (i.width < 1 || i.height < 1 || i.depth > 1) fail("holds no flat picture");
        const auto pixels =
            static_cast<std::uint64_t>(i.width) * static_cast<std::uint64_t>(i.height);
        if (pixels > mostPixels) {
            fail(fmt::format("has {} x {} pixels; at most {} are read", i.width, i.height,
                             mostPixels));
        }
        if (i.width != i.fullWidth || i.height != i.fullHeight || i.x != i.fullX ||
            i.y != i.fullY) {
            fail(fmt::format("holds {} x {} pixels of a picture of {} x {}; all have to be there",
                             i.width, i.height, i.fullWidth, i.fullHeight));
        }
        if (i.orientation != 1) {
            fail(fmt::format("is stored turned or mirrored (orientation {}); save it upright",
                             i.orientation));
        }
        // ImfEnvmap.h turns the faces in another way.
        if (i.environment == "CubeFace Environment") {
            fail(
                "is an OpenEXR cube, whose faces are turned otherwise; make it latlong with "
                "exrenvmap");
        }
    }

    /// R, G and B, or the one channel of a grey picture.
    void chooseChannels() {
        int found[3] = {-1, -1, -1};
        const auto& names = image_->channels;
        for (std::size_t k = 0; k < names.size(); ++k) {
            const std::string name = lower(names[k]);
            for (int c = 0; c < 3; ++c) {
                constexpr std::string_view wanted[] = {"red", "green", "blue"};
                if (name == wanted[c].substr(0, 1) || name == wanted[c]) {
                    found[c] = static_cast<int>(k);
                }
            }
        }
        const auto greyName = [](const std::string& name) {
            return name == "y" || name == "i" || name == "l" || name == "channel0";
        };
        const bool grey = found[0] < 0 && found[1] < 0 && found[2] < 0 && !names.empty() &&
                          names.size() <= 2 && (names.size() == 1 || greyName(lower(names[0])));
        for (int c = 0; c < 3; ++c) {
            if (grey) found[c] = 0;
            if (found[c] < 0) {
                fail(
                    fmt::format("has no channel {}; channels: {}; a picture of light has R, G and "
                                "B, or Y alone",
                                "RGB"[c], fmt::join(names, ", ")));
            }
        }
        first_ = *std::ranges::min_element(found);
        last_ = *std::ranges::max_element(found) + 1;
        for (std::size_t c = 0; c < 3; ++c)
            channels_[c] = static_cast<std::size_t>(found[c] - first_);
    }

    std::size_t blockRows() const {
        const std::size_t rowBytes =
            width() * static_cast<std::size_t>(last_ - first_) * sizeof(float);
        if (image_->tileHeight > 0) {
            const auto rows = std::min(static_cast<std::size_t>(image_->tileHeight), height());
            if (rows * rowBytes > mostTileBytes) {
                fail(fmt::format("has tiles of {} rows, too many for rows of {} pixels",
                                 image_->tileHeight, image_->width));
            }
            return rows;
        }
        return std::clamp(blockBytes / rowBytes, std::size_t{1}, mostBlockRows);
    }

    void readBlock(int top, int bottom, float* values) {
        if (image_->read(top, bottom, first_, last_, values)) return;
        const std::string message = firstLine(image_->error);
        fail(fmt::format("breaks off or is damaged in rows {} to {}{}{}", top, bottom - 1,
                         message.empty() ? "" : ": ", message));
    }

    /// Linear values of the codes of 8 or 16 bits, or of fractions of 1 for other whole numbers;
    /// empty for linear values.
    std::vector<float> codes(TransferCurve curve) const {
        if (curve == TransferCurve::linear) return {};
        std::vector<float> table(image_->number == "uint8" ? 256 : 65536);
        for (std::size_t k = 0; k < table.size(); ++k) {
            table[k] = static_cast<float>(
                decoded(curve, static_cast<double>(k) / static_cast<double>(table.size() - 1)));
        }
        return table;
    }
    static float lookedUp(const std::vector<float>& table, float value) {
        const auto most = static_cast<float>(table.size() - 1);
        return table[static_cast<std::size_t>(std::clamp(value * most + 0.5F, 0.0F, most))];
    }

    MappedFile mapped_;
    std::string format_;
    std::unique_ptr<ImageModulePicture> image_;
    int first_ = 0, last_ = 0;  ///< channels that are read
    std::array<std::size_t, 3> channels_{};
};

PictureReader::PictureReader(const std::string& path, const PictureOptions& options) : path_(path) {
    for (const std::string& file : filesOf(path)) files_.push_back(std::make_unique<File>(file));
    const File& first = *files_.front();
    const std::size_t width = first.width(), height = first.height() * files_.size();
    for (const auto& file : files_) {
        if (file->width() != file->height() && files_.size() > 1) {
            throw InputError(fmt::format("{}: a face of {} x {} pixels is not square", path,
                                         file->width(), file->height()));
        }
        if (file->width() != width) {
            throw InputError(
                fmt::format("{}: faces of {} and {} pixels; all six have to have one size", path,
                            width, file->width()));
        }
    }
    const auto layout = options.layout ? options.layout : layoutOfSize(width, height);
    if (!layout) {
        std::vector<std::string> known;
        for (const LayoutName& row : layoutNames()) {
            known.push_back(fmt::format("{} {}", row.name, layoutSizes(row.layout)));
        }
        throw InputError(fmt::format("{}: {} x {} pixels do not tell a layout; state one: {}", path,
                                     width, height, fmt::join(known, ", ")));
    }
    if (!layoutFits(*layout, width, height)) {
        throw InputError(fmt::format("{}: is {} x {} pixels; the layout {} has to be {}", path,
                                     width, height, layoutName(*layout), layoutSizes(*layout)));
    }
    const bool whole = std::ranges::any_of(files_, [](const auto& f) { return f->wholeNumbers(); });
    if (whole && !options.curve) {
        throw InputError(
            fmt::format("{}: its {} values are codes; state their curve, such as srgb or linear",
                        path, first.number()));
    }
    if (!whole && options.curve.value_or(TransferCurve::linear) != TransferCurve::linear) {
        throw InputError(fmt::format("{}: its {} values are linear, not coded by {}", path,
                                     first.number(), curveName(*options.curve)));
    }
    facts_ = {.format = first.format(),
              .number = first.number(),
              .curve = options.curve.value_or(TransferCurve::linear),
              .geometry = {*layout, width, height}};
}

PictureReader::~PictureReader() = default;

void PictureReader::forEachRow(const RowVisitor& visit) {
    std::size_t row = 0;
    for (const auto& file : files_) {
        file->forEachRow(row, facts_.curve, visit);
        row += file->height();
    }
}

std::span<const CurveName> curveNames() {
    return curves;
}

std::string_view curveName(TransferCurve curve) {
    return std::ranges::find(curves, curve, &CurveName::curve)->name;
}

double decoded(TransferCurve curve, double v) {
    switch (curve) {
        case TransferCurve::linear:
            return v;
        case TransferCurve::srgb:
            return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
        case TransferCurve::rec709:
            return v < 0.081 ? v / 4.5 : std::pow((v + 0.099) / 1.099, 1 / 0.45);
        case TransferCurve::gamma18:
            return std::pow(v, 1.8);
        case TransferCurve::gamma22:
            return std::pow(v, 2.2);
        case TransferCurve::gamma24:
            return std::pow(v, 2.4);
    }
    return v;
}

std::span<const FaceNames> faceNames() {
    return faces;
}

bool hasPictureMagic(std::string_view head) {
    return std::ranges::any_of(formats, [&](const auto& f) { return starts(head, f); });
}

bool isPicturePath(std::string_view text) {
    if (isFile(text)) return true;
    if (facePlace(text).second == 0) return false;
    return std::ranges::any_of(faces, [&](const FaceNames& names) {
        return std::ranges::any_of(
            names, [&](std::string_view name) { return isFile(facePath(text, name)); });
    });
}

}  // namespace hshfit::inline light
