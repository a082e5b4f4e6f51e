#include <hshfit/light/picture_reader.h>

#include <hshfit/error.h>
#include <hshfit/light/internal/primaries.h>

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
    {"rt", "lf", "up", "dn", "ft", "bk"},
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

/// The files of a path: the path itself, or six faces by the names of which most files exist.
std::vector<std::string> filesOf(const std::string& path) {
    if (isFile(path) || facePlace(path).second == 0) return {path};
    std::vector<std::string> best;
    std::ptrdiff_t most = 0;
    for (const FaceNames& names : faces) {
        std::vector<std::string> paths;
        for (const std::string_view name : names) paths.push_back(facePath(path, name));
        const auto count = std::ranges::count_if(paths, isFile);
        if (count > most) most = count, best = paths;
    }
    if (most > 0) return best;
    std::vector<std::string> known;
    for (const FaceNames& names : faces) known.push_back(fmt::format("{}", fmt::join(names, " ")));
    throw InputError(
        fmt::format("{}: no such files; names of faces: {}", path, fmt::join(known, ", ")));
}

// --- channels -------------------------------------------------------------------------------

/// Channels that make a picture of light: R, G and B with the same words before them, or a grey one
/// for all three.
struct ChannelGroup {
    std::size_t part = 0;
    std::string layer = {};
    std::array<int, 3> channels{};
};

std::string lower(std::string_view text) {
    std::string out(text);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

/// The colour of a channel's last word: 0 for "R" or "red", and so on; -1 for any other.
int colourOf(std::string_view word) {
    constexpr std::string_view letters[] = {"r", "g", "b"}, words[] = {"red", "green", "blue"};
    const std::string name = lower(word);
    for (int c = 0; c < 3; ++c)
        if (name == letters[c] || name == words[c]) return c;
    return -1;
}

/// Groups of R, G and B in one part; V-Ray writes ".R", Blender "ViewLayer.Combined.R".
std::vector<ChannelGroup> colourGroups(const PictureFile& file, std::size_t part) {
    std::vector<ChannelGroup> groups;
    const auto& names = file.partChannels(part);
    for (std::size_t k = 0; k < names.size(); ++k) {
        const std::size_t dot = names[k].rfind('.');
        const std::string layer = dot == std::string::npos ? "" : names[k].substr(0, dot);
        const int colour = colourOf(dot == std::string::npos ? names[k] : names[k].substr(dot + 1));
        if (colour < 0) continue;
        auto group = std::ranges::find(groups, layer, &ChannelGroup::layer);
        if (group == groups.end()) group = groups.insert(groups.end(), {part, layer, {-1, -1, -1}});
        group->channels[static_cast<std::size_t>(colour)] = static_cast<int>(k);
    }
    std::erase_if(groups, [](const ChannelGroup& group) {
        return std::ranges::any_of(group.channels, [](int channel) { return channel < 0; });
    });
    return groups;
}

/// The grey channel of a part, alone or beside alpha; of OpenEXR it has to be named as luminance,
/// since Z or an identifier stands alone as well.
std::optional<ChannelGroup> greyGroup(const PictureFile& file, std::size_t part) {
    const auto& names = file.partChannels(part);
    if (names.empty() || names.size() > 2) return {};
    const bool named =
        std::ranges::any_of(std::array{"y", "i", "l", "luminance", "grey", "gray", "channel0"},
                            [&](const char* name) { return lower(names[0]) == name; });
    const bool alone = names.size() == 1 && file.format() != "OpenEXR";
    if (!named && !alone) return {};
    return ChannelGroup{part, "", {0, 0, 0}};
}

std::string described(const PictureFile& file, const ChannelGroup& group) {
    std::string text;
    if (file.parts() > 1)
        text = file.partName(group.part).empty()
                   ? fmt::format("part={}", group.part + 1)
                   : fmt::format("part={}", file.partName(group.part));
    if (!group.layer.empty()) text += (text.empty() ? "layer=" : ",layer=") + group.layer;
    return text.empty() ? "the channels R, G, B without a layer" : text;
}

std::string contentsOf(const PictureFile& file) {
    std::vector<std::string> parts;
    for (std::size_t k = 0; k < file.parts(); ++k) {
        const std::string names = fmt::format("{}", fmt::join(file.partChannels(k), ", "));
        parts.push_back(file.parts() == 1
                            ? names
                            : fmt::format("part {} '{}': {}", k + 1, file.partName(k), names));
    }
    return fmt::format("{}", fmt::join(parts, "; "));
}

/// The channels that a file is read by.
ChannelGroup chosenGroup(const PictureFile& file, const PictureOptions& options) {
    std::vector<ChannelGroup> groups;
    const auto wanted = [&](std::size_t part) {
        return options.part.empty() || options.part == file.partName(part) ||
               options.part == std::to_string(part + 1);
    };
    for (std::size_t part = 0; part < file.parts(); ++part) {
        if (!wanted(part)) continue;
        for (ChannelGroup& group : colourGroups(file, part))
            if (options.layer.empty() || options.layer == group.layer)
                groups.push_back(std::move(group));
    }
    for (std::size_t part = 0; groups.empty() && options.layer.empty() && part < file.parts();
         ++part) {
        if (!wanted(part)) continue;
        if (const auto grey = greyGroup(file, part)) groups.push_back(*grey);
    }
    if (groups.empty()) {
        const std::string chosen = options.part.empty() && options.layer.empty()
                                       ? "no R, G and B, nor Y alone"
                                       : fmt::format("no R, G and B in part '{}', layer '{}'",
                                                     options.part, options.layer);
        file.fail(fmt::format("has {}; channels: {}; a picture of light has R, G and B, or Y alone",
                              chosen, contentsOf(file)));
    }
    const auto plain = [](const ChannelGroup& group) { return group.layer.empty(); };
    if (groups.size() > 1 && std::ranges::count_if(groups, plain) == 1)
        return *std::ranges::find_if(groups, plain);
    if (groups.size() > 1) {
        std::vector<std::string> known;
        for (const ChannelGroup& group : groups) known.push_back(described(file, group));
        file.fail(
            fmt::format("has {} pictures; choose one: {}", groups.size(), fmt::join(known, "; ")));
    }
    return groups.front();
}

/// The layouts that a picture of this size may have, ready to be typed; all of them with their
/// sizes where none fits.
std::string layoutsFor(const std::string& path, std::size_t width, std::size_t height) {
    std::vector<std::string> fitting, all;
    for (const LayoutName& row : layoutNames()) {
        all.push_back(fmt::format("{} {}", row.name, layoutSizes(row.layout)));
        if (layoutFits(row.layout, width, height))
            fitting.push_back(fmt::format("{}:layout={}", path, row.name));
    }
    return fmt::format("{}", fmt::join(fitting.empty() ? all : fitting, ", "));
}

}  // namespace

// --- one file -------------------------------------------------------------------------------

/// A file with the channels of a picture of light.
class PictureReader::File {
public:
    File(const std::string& path, const PictureOptions& options)
        : picture_(std::make_unique<PictureFile>(path)) {
        group_ = chosenGroup(*picture_, options);
        if (group_.part > 0) picture_ = std::make_unique<PictureFile>(path, group_.part);
        // ImfEnvmap.h turns the faces in another way.
        if (picture_->environment() == "CubeFace Environment") {
            picture_->fail(
                "is an OpenEXR cube, whose faces are turned otherwise; make it latlong with "
                "exrenvmap");
        }
        if (const std::string mark = picture_->gainMap(); !mark.empty())
            picture_->fail(fmt::format(
                "has a gain map ({}): its base picture is made for ordinary screens and is not the "
                "light; decode both to OpenEXR or Radiance HDR, for example with libultrahdr",
                mark));
        first_ = *std::ranges::min_element(group_.channels);
        last_ = *std::ranges::max_element(group_.channels) + 1;
        const PictureColour& colour = picture_->colour();
        // Photoshop writes eight zeros where it states none.
        const auto isZero = [](double value) { return value == 0; };
        if (colour.primaries && !std::ranges::all_of(*colour.primaries, isZero)) {
            const auto matrix = toRec709(*colour.primaries);
            if (!matrix)
                picture_->fail(fmt::format("has primaries that span no colours: {}",
                                           fmt::join(*colour.primaries, " ")));
            matrix_ = *matrix;
        }
        for (std::size_t c = 0; c < 3; ++c)
            for (auto& row : matrix_) row[c] /= colour.exposure * colour.correction[c];
    }

    const PictureFile& picture() const { return *picture_; }
    const ChannelGroup& group() const { return group_; }

    void forEachRow(std::size_t firstRow, TransferCurve curve, const RowVisitor& visit) {
        const std::vector<float> table = codes(curve);
        const std::size_t stride = static_cast<std::size_t>(last_ - first_);
        const std::size_t width = picture_->width(), height = picture_->height();
        const std::size_t rows = picture_->blockRows(stride);
        std::vector<float> block(rows * width * stride), rgb(3 * width);
        for (std::size_t top = 0; top < height; top += rows) {
            const std::size_t bottom = std::min(top + rows, height);
            picture_->read(top, bottom, first_, last_, block.data());
            for (std::size_t row = top; row < bottom; ++row) {
                const float* values = block.data() + (row - top) * width * stride;
                for (std::size_t column = 0; column < width; ++column) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        const float value = values[column * stride + offset(c)];
                        rgb[3 * column + c] = table.empty() ? value : lookedUp(table, value);
                    }
                }
                if (!isUnit(matrix_)) convert(rgb);
                visit(firstRow + row, rgb);
            }
        }
        picture_->checkIntact();
    }

private:
    /// Linear values of the codes of 8 or 16 bits, or of fractions of 1 for other whole numbers;
    /// empty for linear values.
    std::vector<float> codes(TransferCurve curve) const {
        if (curve == TransferCurve::linear) return {};
        std::vector<float> table(picture_->number() == "uint8" ? 256 : 65536);
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

    std::size_t offset(std::size_t c) const {
        return static_cast<std::size_t>(group_.channels[c] - first_);
    }
    void convert(std::vector<float>& rgb) const {
        for (std::size_t k = 0; k + 2 < rgb.size(); k += 3) {
            const double from[] = {rgb[k], rgb[k + 1], rgb[k + 2]};
            for (std::size_t c = 0; c < 3; ++c)
                rgb[k + c] = static_cast<float>(matrix_[c][0] * from[0] + matrix_[c][1] * from[1] +
                                                matrix_[c][2] * from[2]);
        }
    }

    std::unique_ptr<PictureFile> picture_;
    ChannelGroup group_;
    int first_ = 0, last_ = 0;  ///< channels that are read
    ColourMatrix matrix_{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

PictureReader::PictureReader(const std::string& path, const PictureOptions& options) : path_(path) {
    for (const std::string& file : filesOf(path))
        files_.push_back(std::make_unique<File>(file, options));
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
        throw InputError(fmt::format("{}: {} x {} pixels do not tell a layout; state one: {}", path,
                                     width, height, layoutsFor(path, width, height)));
    }
    // A panorama whose layout is stated may have any proportion: pixels are as wide and as high as
    // they follow from its size.
    const bool stated =
        options.layout == PictureLayout::latlong || options.layout == PictureLayout::dome;
    if (!stated && !layoutFits(*layout, width, height)) {
        throw InputError(fmt::format("{}: is {} x {} pixels; the layout {} has to be {}", path,
                                     width, height, layoutName(*layout), layoutSizes(*layout)));
    }
    const bool whole =
        std::ranges::any_of(files_, [](const auto& f) { return f->picture().wholeNumbers(); });
    if (whole && !options.curve) {
        throw InputError(
            fmt::format("{0}: its {1} values are codes; state their curve, srgb for most pictures: "
                        "{0}:curve=srgb",
                        path, first.picture().number()));
    }
    if (!whole && options.curve.value_or(TransferCurve::linear) != TransferCurve::linear) {
        throw InputError(fmt::format("{}: its {} values are linear, not coded by {}", path,
                                     first.picture().number(), curveName(*options.curve)));
    }
    facts_ = {.format = first.picture().format(),
              .number = first.picture().number(),
              .curve = options.curve.value_or(TransferCurve::linear),
              .geometry = {*layout, width, height},
              .layout = *layout,
              .fileHeight = height,
              .part = first.group().part,
              .layer = first.group().layer,
              .colour = first.picture().colour()};
    if (layout == PictureLayout::dome && width != height)
        facts_.geometry = {PictureLayout::latlong, width, 2 * height};
    for (std::size_t k = 0; k < first.picture().parts(); ++k)
        facts_.parts.push_back({first.picture().partName(k), first.picture().partChannels(k)});
}

PictureReader::~PictureReader() = default;

void PictureReader::forEachRow(const RowVisitor& visit) {
    std::size_t row = 0;
    for (const auto& file : files_) {
        file->forEachRow(row, facts_.curve, visit);
        row += file->picture().height();
    }
    const std::vector<float> below(row < facts_.geometry.height ? 3 * facts_.geometry.width : 0);
    for (; row < facts_.geometry.height; ++row) visit(row, below);
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
