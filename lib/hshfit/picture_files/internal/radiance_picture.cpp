#include <hshfit/picture_files/internal/radiance_picture.h>

#include <hshfit/files/printable.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <span>

namespace hshfit::inline picture_files {
namespace {

using Byte = unsigned char;
using Rgbe = std::array<Byte, 4>;

constexpr std::size_t mostSide = std::size_t{1} << 28;
/// Units of the mantissa by exponent, 2^(e - 136); 0 stands for black.
constexpr std::array<float, 256> scales = [] {
    std::array<float, 256> values{};
    float value = 0x1p-135F;
    for (std::size_t e = 1; e < values.size(); ++e, value *= 2) values[e] = value;
    return values;
}();
/// Scan lines of other lengths are not compressed by component.
constexpr std::size_t leastByComponent = 8, mostByComponent = 0x7fff;

/// The resolution string, "-Y 512 +X 1024": lines from the top, pixels from the left.
struct Resolution {
    std::size_t lines = 0, length = 0;
    bool columns = false;         ///< a line is a column of the picture
    bool backLines = false;       ///< lines from the bottom or from the right
    bool backWithinLine = false;  ///< pixels from the right or from the bottom
};

std::optional<Resolution> resolutionOf(std::string_view text) {
    struct Axis {
        char sign = 0, name = 0;
        std::size_t count = 0;
    };
    const auto next = [&]() -> std::optional<Axis> {
        if (text.size() < 4 || (text[0] != '-' && text[0] != '+') || text[2] != ' ') return {};
        Axis axis{text[0], text[1]};
        text.remove_prefix(3);
        const auto [end, error] =
            std::from_chars(text.data(), text.data() + text.size(), axis.count);
        if (error != std::errc() || axis.count < 1 || axis.count > mostSide) return {};
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        return axis;
    };
    const auto first = next(), second = next();
    if (!first || !second || !text.empty()) return {};
    const bool columns = first->name == 'X';
    if (columns ? second->name != 'Y' : first->name != 'Y' || second->name != 'X') return {};
    // Rows count from the top where Y is -, columns from the left where X is +.
    return Resolution{first->count, second->count, columns, first->sign == (columns ? '-' : '+'),
                      second->sign == (columns ? '+' : '-')};
}

/// Scan lines one after the other; each reader returns false where the bytes break off or run
/// beyond the line. `out` may be null, to find where a line ends.
class Lines {
public:
    Lines(std::span<const Byte> bytes, std::size_t length) : bytes_(bytes), length_(length) {}

    std::size_t place() const { return at_; }
    void moveTo(std::size_t place) { at_ = place; }

    bool next(Rgbe* out) {
        if (bytes_.size() - at_ < 4) return false;
        const Byte* head = bytes_.data() + at_;
        const bool byComponent = length_ >= leastByComponent && length_ <= mostByComponent &&
                                 head[0] == 2 && head[1] == 2 && head[2] < 0x80;
        if (!byComponent) return pixels(out);
        if ((std::size_t{head[2]} << 8 | head[3]) != length_) return false;
        at_ += 4;
        for (std::size_t c = 0; c < 4; ++c)
            if (!component(out, c)) return false;
        return true;
    }

private:
    bool component(Rgbe* out, std::size_t c) {
        constexpr Byte longestCopy = 128;
        for (std::size_t k = 0; k < length_;) {
            if (at_ >= bytes_.size()) return false;
            const Byte code = bytes_[at_++];
            const bool run = code > longestCopy;
            const std::size_t count = run ? code - longestCopy : code;
            if (count == 0 || count > length_ - k || bytes_.size() - at_ < (run ? 1 : count))
                return false;
            for (std::size_t j = 0; out && j < count; ++j)
                out[k + j][c] = bytes_[at_ + (run ? 0 : j)];
            at_ += run ? 1 : count;
            k += count;
        }
        return true;
    }

    /// Flat pixels and old runs: a run that follows a run counts in units 256 times as large.
    bool pixels(Rgbe* out) {
        unsigned shift = 0;
        for (std::size_t k = 0; k < length_;) {
            if (bytes_.size() - at_ < 4) return false;
            const Rgbe pixel{bytes_[at_], bytes_[at_ + 1], bytes_[at_ + 2], bytes_[at_ + 3]};
            at_ += 4;
            if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
                if (out) out[k] = pixel;
                ++k;
                shift = 0;
                continue;
            }
            constexpr unsigned mostShift = 24;
            const std::size_t count = shift > mostShift ? 0 : std::size_t{pixel[3]} << shift;
            if (k == 0 || count > length_ - k || shift > mostShift) return false;
            if (out) std::fill_n(out + k, count, out[k - 1]);
            k += count;
            shift += 8;
        }
        return true;
    }

    std::span<const Byte> bytes_;
    std::size_t length_, at_ = 0;
};

class RadiancePicture : public ImageModulePicture {
public:
    RadiancePicture(std::span<const Byte> bytes, const Resolution& resolution)
        : resolution_(resolution), lines_(bytes, resolution.length) {
        width = static_cast<int>(resolution.columns ? resolution.lines : resolution.length);
        height = static_cast<int>(resolution.columns ? resolution.length : resolution.lines);
        fullWidth = width, fullHeight = height;
        floating = true;
        number = "float";
        channels = {"R", "G", "B"};
        partNames = {""};
        partChannels = {channels};
        for (std::size_t line = 0; line < resolution.lines; ++line) {
            places_.push_back(lines_.place());
            if (!lines_.next(nullptr)) {
                fail(line);
                return;
            }
        }
    }

    bool read(int top, int bottom, int first, int last, float* values) override {
        const auto across = static_cast<std::size_t>(width);
        const auto stride = static_cast<std::size_t>(last - first);
        if (resolution_.columns && upright_.empty() && !standUp()) return false;
        for (int row = top; row < bottom; ++row) {
            const Rgbe* pixels = resolution_.columns
                                     ? upright_.data() + static_cast<std::size_t>(row) * across
                                     : lineOf(static_cast<std::size_t>(row));
            if (!pixels) return false;
            for (std::size_t k = 0; k < across; ++k, values += stride)
                for (int c = first; c < last; ++c)
                    values[c - first] = valueOf(pixels[k], static_cast<std::size_t>(c));
        }
        return true;
    }

private:
    static float valueOf(const Rgbe& pixel, std::size_t channel) {
        return static_cast<float>(pixel[channel]) * scales[pixel[3]];
    }

    void fail(std::size_t line) {
        error = fmt::format("breaks off or is damaged in {} {} of {}",
                            resolution_.columns ? "column" : "row", line, resolution_.lines);
    }

    /// Line k of the picture, from the top or from the left, in the order of its pixels; null where
    /// the file was changed since it was opened.
    const Rgbe* lineOf(std::size_t k) {
        line_.resize(resolution_.length);
        lines_.moveTo(places_[resolution_.backLines ? resolution_.lines - 1 - k : k]);
        if (!lines_.next(line_.data())) return nullptr;
        if (resolution_.backWithinLine) std::ranges::reverse(line_);
        return line_.data();
    }

    bool standUp() {
        const auto across = static_cast<std::size_t>(width);
        std::vector<Rgbe> upright(across * static_cast<std::size_t>(height));
        for (std::size_t column = 0; column < across; ++column) {
            const Rgbe* pixels = lineOf(column);
            if (!pixels) return false;
            for (std::size_t row = 0; row < resolution_.length; ++row)
                upright[row * across + column] = pixels[row];
        }
        upright_ = std::move(upright);
        return true;
    }

    Resolution resolution_;
    Lines lines_;
    std::vector<std::size_t> places_;  ///< of lines, in the order of the file
    std::vector<Rgbe> line_;
    std::vector<Rgbe> upright_;  ///< all pixels, where lines are columns
};

}  // namespace

std::unique_ptr<ImageModulePicture> openRadiance(const MappedFile& file, std::string& error) {
    const std::span<const Byte> bytes = file.bytes();
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t headEnd = text.find("\n\n");
    const std::string_view head = text.substr(0, headEnd);
    if (head.find("\nFORMAT=32-bit_rle_rgbe") == head.npos) {
        error = "no FORMAT=32-bit_rle_rgbe in its header";
        return nullptr;
    }
    const std::size_t begin = headEnd == text.npos ? text.size() : headEnd + 2;
    const std::size_t end = text.find('\n', begin);
    const std::string line(text.substr(begin, std::min<std::size_t>(end - begin, 60)));
    const auto resolution = end == text.npos ? std::nullopt : resolutionOf(line);
    if (!resolution) {
        error = fmt::format("its resolution is '{}'; it has to be such as '-Y 512 +X 1024'",
                            printable(line));
        return nullptr;
    }
    auto picture = std::make_unique<RadiancePicture>(bytes.subspan(end + 1), *resolution);
    error = picture->error;
    if (!error.empty()) return nullptr;
    return picture;
}

}  // namespace hshfit::inline picture_files
