#include <hshfit/light/picture_reader.h>

#include <hshfit/error.h>
#include <hshfit/picture_files/picture_file.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

namespace hshfit::inline light {
namespace {

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

/// A file with the channels of a picture of light.
class PictureReader::File {
public:
    explicit File(const std::string& path) : picture_(path) {
        // ImfEnvmap.h turns the faces in another way.
        if (picture_.environment() == "CubeFace Environment") {
            picture_.fail(
                "is an OpenEXR cube, whose faces are turned otherwise; make it latlong with "
                "exrenvmap");
        }
        chooseChannels();
    }

    const PictureFile& picture() const { return picture_; }

    void forEachRow(std::size_t firstRow, TransferCurve curve, const RowVisitor& visit) {
        const std::vector<float> table = codes(curve);
        const std::size_t stride = static_cast<std::size_t>(last_ - first_);
        const std::size_t width = picture_.width(), height = picture_.height();
        const std::size_t rows = picture_.blockRows(stride);
        std::vector<float> block(rows * width * stride), rgb(3 * width);
        for (std::size_t top = 0; top < height; top += rows) {
            const std::size_t bottom = std::min(top + rows, height);
            picture_.read(top, bottom, first_, last_, block.data());
            for (std::size_t row = top; row < bottom; ++row) {
                const float* values = block.data() + (row - top) * width * stride;
                for (std::size_t column = 0; column < width; ++column) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        const float value = values[column * stride + channels_[c]];
                        rgb[3 * column + c] = table.empty() ? value : lookedUp(table, value);
                    }
                }
                visit(firstRow + row, rgb);
            }
        }
        picture_.checkIntact();
    }

private:
    /// R, G and B, or the one channel of a grey picture.
    void chooseChannels() {
        int found[3];
        for (std::size_t c = 0; c < 3; ++c)
            found[c] = picture_.find(std::string_view("RGB").substr(c, 1));
        const auto& names = picture_.channels();
        const bool noColour = found[0] < 0 && found[1] < 0 && found[2] < 0;
        const bool grey = noColour && (names.size() == 1 || (names.size() == 2 && hasGreyFirst()));
        for (int c = 0; c < 3; ++c) {
            if (grey) found[c] = 0;
            if (found[c] < 0) {
                picture_.fail(
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

    /// Beside alpha.
    bool hasGreyFirst() const {
        return std::ranges::any_of(std::array{"y", "i", "l", "channel0"},
                                   [&](const char* name) { return picture_.find(name) == 0; });
    }

    /// Linear values of the codes of 8 or 16 bits, or of fractions of 1 for other whole numbers;
    /// empty for linear values.
    std::vector<float> codes(TransferCurve curve) const {
        if (curve == TransferCurve::linear) return {};
        std::vector<float> table(picture_.number() == "uint8" ? 256 : 65536);
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

    PictureFile picture_;
    int first_ = 0, last_ = 0;  ///< channels that are read
    std::array<std::size_t, 3> channels_{};
};

PictureReader::PictureReader(const std::string& path, const PictureOptions& options) : path_(path) {
    for (const std::string& file : filesOf(path)) files_.push_back(std::make_unique<File>(file));
    const File& first = *files_.front();
    const std::size_t width = first.picture().width(),
                      height = first.picture().height() * files_.size();
    for (const auto& file : files_) {
        if (file->picture().width() != file->picture().height() && files_.size() > 1) {
            throw InputError(fmt::format("{}: a face of {} x {} pixels is not square", path,
                                         file->picture().width(), file->picture().height()));
        }
        if (file->picture().width() != width) {
            throw InputError(
                fmt::format("{}: faces of {} and {} pixels; all six have to have one size", path,
                            width, file->picture().width()));
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
    const bool whole =
        std::ranges::any_of(files_, [](const auto& f) { return f->picture().wholeNumbers(); });
    if (whole && !options.curve) {
        throw InputError(
            fmt::format("{}: its {} values are codes; state their curve, such as srgb or linear",
                        path, first.picture().number()));
    }
    if (!whole && options.curve.value_or(TransferCurve::linear) != TransferCurve::linear) {
        throw InputError(fmt::format("{}: its {} values are linear, not coded by {}", path,
                                     first.picture().number(), curveName(*options.curve)));
    }
    facts_ = {.format = first.picture().format(),
              .number = first.picture().number(),
              .curve = options.curve.value_or(TransferCurve::linear),
              .geometry = {*layout, width, height}};
}

PictureReader::~PictureReader() = default;

void PictureReader::forEachRow(const RowVisitor& visit) {
    std::size_t row = 0;
    for (const auto& file : files_) {
        file->forEachRow(row, facts_.curve, visit);
        row += file->picture().height();
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

bool isPicturePath(std::string_view text) {
    if (isFile(text)) return true;
    if (facePlace(text).second == 0) return false;
    return std::ranges::any_of(faces, [&](const FaceNames& names) {
        return std::ranges::any_of(
            names, [&](std::string_view name) { return isFile(facePath(text, name)); });
    });
}

}  // namespace hshfit::inline light
