#include <hshfit/picture_files/picture_file.h>

#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/printable.h>
#include <hshfit/picture_files/internal/image_module.h>
#include <hshfit/picture_files/internal/radiance_picture.h>

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

namespace hshfit::inline picture_files {
namespace {

constexpr std::uint64_t mostPixels = std::uint64_t{1} << 28;
constexpr std::size_t blockBytes = std::size_t{1} << 24;
constexpr std::size_t mostTileBytes = std::size_t{1} << 28;
constexpr std::size_t mostBlockRows = 256;  // as many as any compression of OpenEXR joins

struct PictureFormat {
    const char* plugin;  ///< of OpenImageIO; none for what is read here
    std::string_view name;
    std::string_view start;
};
constexpr PictureFormat formats[] = {
    {"openexr", "OpenEXR", {"\x76\x2f\x31\x01", 4}},
    {"", "Radiance HDR", "#?"},
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

bool isText(std::string_view text) {
    return std::ranges::all_of(
        text, [](unsigned char c) { return c >= ' ' || (c >= '\t' && c <= '\r'); });
}

/// The first numbers of a table can begin like a picture, so that what has to follow two or three
/// bytes is asked for: the width or a line of text after the bytes of PNM, a program and a
/// line of text in Radiance HDR, a marker in JPEG, zeros and the size of a header in BMP.
bool starts(std::string_view head, const PictureFormat& format) {
    if (!head.starts_with(format.start)) return false;
    const std::string_view rest = head.substr(format.start.size());
    if (format.start[0] == 'P') {
        const std::size_t first = rest.find_first_not_of(" \t\r\n");
        if (first == 0 || first >= rest.size()) return false;
        const bool remark = rest[first] == '#', digit = rest[first] >= '0' && rest[first] <= '9';
        const std::size_t end = rest.find_first_of(remark ? "\n" : " \t\r\n", first);
        return (remark || digit) && end != rest.npos && isText(rest.substr(0, end));
    }
    if (format.start == "#?") {
        const std::size_t end = rest.find('\n');
        return end != rest.npos && end > 0 && rest[end - 1] != '\r' &&
               isText(rest.substr(0, rest.find("\n\n")));
    }
    if (format.start == "\xff\xd8\xff")
        return !rest.empty() && static_cast<unsigned char>(rest[0]) >= 0xc0;
    if (format.start == "BM") {
        constexpr std::string_view zeros("\0\0\0\0", 4), sizes = "\x0c\x10\x28\x34\x38\x40\x6c\x7c";
        return head.size() > 17 && head.substr(6, 4) == zeros &&
               sizes.find(head[14]) != sizes.npos && head.substr(15, 3) == zeros.substr(1);
    }
    return true;
}

std::string_view textOf(const MappedFile& file) {
    return {reinterpret_cast<const char*>(file.data()), file.size()};
}

const PictureFormat& formatOf(const MappedFile& file) {
    const std::string_view head = textOf(file);
    for (const PictureFormat& format : formats) {
        if (starts(head, format)) return format;
    }
    if (head.starts_with("#?") && head.substr(0, head.find('\n')).ends_with('\r'))
        throw InputError(
            fmt::format("{}: the lines of its Radiance header end in CR LF, expected LF; a copy in "
                        "text mode may have changed the pixels too: copy the file as binary",
                        file.path()));
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

/// The next word of the head of a PNM file, with its comments left out.
std::string_view nextWord(std::string_view& head) {
    while (!head.empty() && std::string_view(" \t\r\n#").find(head[0]) != std::string_view::npos)
        head.remove_prefix(head[0] == '#' ? std::min(head.find('\n'), head.size()) : 1);
    const std::string_view word = head.substr(0, head.find_first_of(" \t\r\n#"));
    head.remove_prefix(word.size());
    return word;
}

/// Whether a word is one number of the kind of `least`, not beyond the bounds.
template <class Number>
bool isNumber(std::string_view word, Number least, Number most) {
    Number value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size() && value >= least &&
           value <= most;
}

/// The wrong number in the head of a PNM or PFM file; empty without one. OpenImageIO takes a
/// largest value of 0 or 70000 and a scale of 0 or NaN.
std::string wrongNumber(std::string_view head, bool floating) {
    constexpr int mostSide = 1 << 28, mostCode = 65535;
    constexpr float mostScale = std::numeric_limits<float>::max();
    head.remove_prefix(2);
    for (const char* side : {"width", "height"}) {
        if (const std::string_view word = nextWord(head); !isNumber(word, 1, mostSide))
            return fmt::format("its {} is '{}'; it has to be from 1 to {}", side,
                               word.substr(0, 20), mostSide);
    }
    const std::string_view word = nextWord(head);
    if (!floating && !isNumber(word, 1, mostCode))
        return fmt::format("its largest value is '{}'; it has to be from 1 to {}",
                           word.substr(0, 20), mostCode);
    constexpr float leastScale = std::numeric_limits<float>::min();
    if (floating && !isNumber(word.substr(word.starts_with('-') ? 1 : 0), leastScale, mostScale))
        return fmt::format("its scale is '{}'; it has to be a number other than 0",
                           word.substr(0, 20));
    return {};
}

/// The tag RowsPerStrip (TIFF 6.0) of the first picture; 0 where it is not stated or stands for
/// all. OpenImageIO makes room for as many rows.
std::uint32_t stripRows(std::span<const unsigned char> bytes) {
    const bool little = bytes[0] == 'I';
    const auto number = [&](std::uint64_t at, std::size_t size) {
        std::uint32_t value = 0;
        for (std::size_t k = 0; k < size && at + size <= bytes.size(); ++k)
            value |= std::uint32_t{bytes[at + k]} << 8 * (little ? k : size - 1 - k);
        return value;
    };
    constexpr std::uint32_t rowsPerStrip = 278, shortType = 3, all = 0xffffffff;
    const std::uint64_t directory = number(4, 4);
    for (std::uint64_t k = 0, at = directory + 2; k < number(directory, 2); ++k, at += 12) {
        if (number(at, 2) != rowsPerStrip) continue;
        const std::uint32_t rows = number(at + 8, number(at + 2, 2) == shortType ? 2 : 4);
        return rows == all ? 0 : rows;
    }
    return 0;
}

/// All numbers of a text, or none where it holds anything else.
std::vector<double> numbersIn(std::string_view text) {
    std::vector<double> numbers;
    for (;;) {
        const std::size_t begin = text.find_first_not_of(" \t\r");
        if (begin == text.npos) return numbers;
        text.remove_prefix(begin);
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc()) return {};
        numbers.push_back(value);
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
}

/// The lines of a Radiance header that change the meaning of the pixels. Returns the first one that
/// cannot be followed, with the reason.
std::string readRadianceHeader(std::string_view text, PictureColour& colour) {
    text = text.substr(0, text.find("\n\n"));
    const auto positive = [](const std::vector<double>& values) {
        return std::ranges::all_of(values, [](double v) { return v > 0 && v < 1e30; });
    };
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        const std::size_t equals = line.find('=');
        if (equals == line.npos) continue;
        const std::string_view key = line.substr(0, equals);
        if (key == "FORMAT" && line.find("32-bit_rle_xyze") != line.npos)
            return "holds CIE XYZ (FORMAT=32-bit_rle_xyze), expected 32-bit_rle_rgbe; convert it "
                   "with Radiance's ra_xyze -r";
        const bool primaries = key == "PRIMARIES", each = key == "COLORCORR";
        if (!primaries && !each && key != "EXPOSURE") continue;
        const std::vector<double> values = numbersIn(line.substr(equals + 1));
        const std::size_t expected = primaries ? 8 : each ? 3 : 1;
        if (values.size() != expected || (!primaries && !positive(values)))
            return fmt::format("has {} '{}' in its header, expected {} {}", key,
                               printable(std::string(line.substr(equals + 1)).substr(0, 60)),
                               expected, expected == 1 ? "number above 0" : "numbers");
        if (primaries) {
            colour.primaries.emplace();
            std::ranges::copy(values, colour.primaries->begin());
        }
        if (each)
            for (std::size_t c = 0; c < 3; ++c) colour.correction[c] *= values[c];
        if (!primaries && !each) colour.exposure *= values[0];
    }
    return {};
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

}  // namespace

struct PictureFile::State {
    explicit State(const std::string& path) : mapped(path) {}
    MappedFile mapped;
    std::string_view format;
    std::unique_ptr<ImageModulePicture> image;
    int left = 0, above = 0;         ///< stored columns and rows before the picture's
    std::vector<float> stored = {};  ///< of some rows, where more is stored than the picture
};

PictureFile::PictureFile(const std::string& path, std::size_t part)
    : state_(std::make_unique<State>(path)) {
    const PictureFormat& format = formatOf(state_->mapped);
    state_->format = format.name;
    if (format.name == "JPEG" && !jpegIsWhole(state_->mapped.bytes())) fail("breaks off");
    if (format.name == "OpenEXR" && !exrHeadersAreWhole(textOf(state_->mapped)))
        fail("breaks off in its header, or an attribute is longer than the file");
    if (format.name == "PNG" && !pngIsWhole(state_->mapped.bytes()))
        fail("breaks off or is damaged");
    if (format.plugin == std::string_view("pnm")) {
        const std::string wrong = wrongNumber(textOf(state_->mapped), format.name == "PFM");
        if (!wrong.empty()) fail(wrong);
    }
    if (format.name == "Radiance HDR") {
        const std::string wrong = readRadianceHeader(textOf(state_->mapped), colour_);
        if (!wrong.empty()) fail(wrong);
    }
    std::string error;
    if (format.name == "Radiance HDR")
        state_->image = openRadiance(state_->mapped, error);
    else
        state_->image.reset(
            imageModule()(format.plugin, path.c_str(), static_cast<int>(part), error));
    if (!state_->image) {
        fail(fmt::format("is no valid {} file{}{}", format.name, error.empty() ? "" : ": ",
                         firstLine(error)));
    }
    const ImageModulePicture& i = *state_->image;
    if (i.deep) fail("holds deep data; the picture has to be flat");
    if (i.width < 1 || i.height < 1 || i.depth > 1) fail("holds no flat picture");
    const auto pixels = static_cast<std::uint64_t>(i.width) * static_cast<std::uint64_t>(i.height);
    if (pixels > mostPixels) {
        fail(fmt::format("has {} x {} pixels; at most {} are read", i.width, i.height, mostPixels));
    }
    state_->left = i.fullX - i.x;
    state_->above = i.fullY - i.y;
    const bool covered = state_->left >= 0 && state_->above >= 0 && i.fullWidth >= 1 &&
                         i.fullHeight >= 1 && i.width - state_->left >= i.fullWidth &&
                         i.height - state_->above >= i.fullHeight;
    if (!covered) {
        fail(
            fmt::format("holds {} x {} pixels from ({}, {}) of a picture of {} x {} from ({}, "
                        "{}); all have to be there",
                        i.width, i.height, i.x, i.y, i.fullWidth, i.fullHeight, i.fullX, i.fullY));
    }
    if (i.chromaticities.size() == 8) {
        colour_.primaries.emplace();
        std::ranges::copy(i.chromaticities, colour_.primaries->begin());
    }
    const std::uint64_t rowBytes =
        static_cast<std::uint64_t>(i.width) * i.channels.size() * sizeof(float);
    const std::uint64_t strip = format.name == "TIFF" ? stripRows(state_->mapped.bytes()) : 0;
    if (strip > static_cast<std::uint64_t>(i.height) && strip > mostTileBytes / rowBytes) {
        fail(fmt::format("has strips of {} rows; its picture has {}", strip, i.height));
    }
    const auto tile = static_cast<std::uint64_t>(i.tileWidth) *
                      static_cast<std::uint64_t>(i.tileHeight) * i.channels.size() * sizeof(float);
    if (i.tileHeight > 0 && tile > mostTileBytes) {
        fail(fmt::format("has tiles of {} x {} pixels; at most {} bytes of a tile are read",
                         i.tileWidth, i.tileHeight, mostTileBytes));
    }
    if (i.orientation != 1) {
        fail(fmt::format("is stored turned or mirrored (orientation {}); save it upright",
                         i.orientation));
    }
}

PictureFile::~PictureFile() = default;

const std::string& PictureFile::path() const {
    return state_->mapped.path();
}
std::size_t PictureFile::width() const {
    return static_cast<std::size_t>(state_->image->fullWidth);
}
std::size_t PictureFile::height() const {
    return static_cast<std::size_t>(state_->image->fullHeight);
}
std::string PictureFile::format() const {
    return std::string(state_->format);
}
std::string PictureFile::number() const {
    return state_->image->number;
}
bool PictureFile::wholeNumbers() const {
    return !state_->image->floating;
}
std::string PictureFile::environment() const {
    return state_->image->environment;
}
std::string PictureFile::gainMap() const {
    // Adobe's and Google's metadata, ISO 21496-1, Apple's auxiliary picture.
    constexpr std::string_view marks[] = {"hdrgm:Version", "urn:iso:std:iso:ts:21496:-1",
                                          "urn:com:apple:photo:2020:aux:hdrgainmap"};
    if (state_->format != "JPEG") return {};
    for (const std::string_view mark : marks)
        if (textOf(state_->mapped).find(mark) != std::string_view::npos) return std::string(mark);
    return {};
}
const std::vector<std::string>& PictureFile::channels() const {
    return state_->image->channels;
}

std::size_t PictureFile::parts() const {
    return std::max<std::size_t>(state_->image->partNames.size(), 1);
}
std::string PictureFile::partName(std::size_t part) const {
    return part < state_->image->partNames.size() ? state_->image->partNames[part] : std::string();
}
const std::vector<std::string>& PictureFile::partChannels(std::size_t part) const {
    return part < state_->image->partChannels.size() ? state_->image->partChannels[part]
                                                     : state_->image->channels;
}

int PictureFile::find(std::string_view channel) const {
    constexpr std::array<std::string_view, 4> colours{"red", "green", "blue", "alpha"};
    const std::string wanted = lower(std::string(channel));
    const auto& names = channels();
    for (std::size_t k = 0; k < names.size(); ++k) {
        const std::string name = lower(names[k]);
        const bool colour =
            std::ranges::find(colours, name) != colours.end() && name.substr(0, 1) == wanted;
        if (name == wanted || colour) return static_cast<int>(k);
    }
    return -1;
}

std::size_t PictureFile::blockRows(std::size_t channels) const {
    const std::size_t rowBytes = width() * channels * sizeof(float);
    const int tile = state_->image->tileHeight;
    if (tile == 0) return std::clamp(blockBytes / rowBytes, std::size_t{1}, mostBlockRows);
    const auto rows = std::min(static_cast<std::size_t>(tile), height());
    if (rows * rowBytes > mostTileBytes) {
        fail(fmt::format("has tiles of {} rows, too many for rows of {} pixels", tile, width()));
    }
    return rows;
}

void PictureFile::read(std::size_t top, std::size_t bottom, int first, int last, float* out) {
    ImageModulePicture& image = *state_->image;
    const auto stride = static_cast<std::size_t>(last - first);
    const auto storedWidth = static_cast<std::size_t>(image.width);
    const auto left = static_cast<std::size_t>(state_->left);
    // Stored rows; tiles are read whole.
    auto from = static_cast<int>(top) + state_->above,
         to = static_cast<int>(bottom) + state_->above;
    const int asked = from;
    if (image.tileHeight > 0 && state_->above > 0) {
        from -= from % image.tileHeight;
        to = std::min((to + image.tileHeight - 1) / image.tileHeight * image.tileHeight,
                      image.height);
    }
    const bool same =
        from == asked && storedWidth == width() && to - from == static_cast<int>(bottom - top);
    float* values = out;
    if (!same) {
        state_->stored.resize(static_cast<std::size_t>(to - from) * storedWidth * stride);
        values = state_->stored.data();
    }
    if (!image.read(from, to, first, last, values)) {
        const std::string message = firstLine(image.error);
        fail(fmt::format("breaks off or is damaged in rows {} to {}{}{}", top, bottom - 1,
                         message.empty() ? "" : ": ", message));
    }
    if (same) return;
    for (std::size_t row = 0; row < bottom - top; ++row) {
        const std::size_t at = row + static_cast<std::size_t>(asked - from);
        const float* begin = values + (at * storedWidth + left) * stride;
        std::copy_n(begin, width() * stride, out + row * width() * stride);
    }
}

void PictureFile::checkIntact() const {
    state_->mapped.checkIntact();
}

void PictureFile::fail(const std::string& what) const {
    throw InputError(fmt::format("{}: {}", path(), what));
}

bool hasPictureMagic(std::string_view head) {
    return std::ranges::any_of(formats, [&](const auto& f) { return starts(head, f); });
}

}  // namespace hshfit::inline picture_files
