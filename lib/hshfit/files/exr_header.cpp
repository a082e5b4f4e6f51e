#include <hshfit/byte_cursor.h>
#include <hshfit/checked_product.h>
#include <hshfit/error.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/printable.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <optional>
#include <set>

#include <fmt/format.h>

static_assert(std::endian::native == std::endian::little, "EXR integers are little-endian");

namespace hshfit::inline files {
namespace {

constexpr std::string_view magic("\x76\x2f\x31\x01", 4);
constexpr std::uint32_t versionMask = 0xff, longNames = 0x400;
constexpr std::uint32_t tiled = 0x200, deep = 0x800, multiPart = 0x1000;
constexpr std::int32_t halfPixels = 1, floatPixels = 2;
constexpr int zipCompression = 3, pizCompression = 4;  // before them: none, RLE, ZIPS
constexpr std::int32_t maxSide = 1 << 16;
constexpr std::uint64_t maxInflation = 1032;
constexpr std::size_t maxName = 255;

/// Bytes of the attribute types that are let through, besides string and chlist. OpenEXR reads as
/// many as the type has, even if the file states another size, and would then lose its place.
struct TypeSize {
    std::string_view type;
    std::size_t bytes;
};
constexpr TypeSize typeSizes[] = {
    {"box2f", 16},      {"box2i", 16}, {"chromaticities", 32},
    {"compression", 1}, {"double", 8}, {"envmap", 1},
    {"float", 4},       {"int", 4},    {"keycode", 28},
    {"lineOrder", 1},   {"m33d", 72},  {"m33f", 36},
    {"m44d", 128},      {"m44f", 64},  {"rational", 8},
    {"timecode", 8},    {"v2d", 16},   {"v2f", 8},
    {"v2i", 8},         {"v3d", 24},   {"v3f", 12},
    {"v3i", 12},
};

struct Attribute {
    std::string_view name, type, value;
};

/// The next attribute; an empty name at the end of the header, nothing where the file breaks off.
std::optional<Attribute> nextAttribute(ByteCursor& cursor) {
    const auto name = cursor.word(maxName);
    if (!name) return std::nullopt;
    if (name->empty()) return Attribute{};
    const auto type = cursor.word(maxName);
    if (!type) return std::nullopt;
    const auto size = cursor.number<std::int32_t>();
    if (!size || *size < 0) return std::nullopt;
    const auto value = cursor.take(static_cast<std::size_t>(*size));
    if (!value) return std::nullopt;
    return Attribute{*name, *type, *value};
}

class Checker {
public:
    Checker(std::string_view bytes, const std::string& file, const ExrRules& rules)
        : bytes_(bytes), file_(file), rules_(rules) {}

    ExrHeader check() {
        ByteCursor cursor(bytes_);
        cursor.take(magic.size());
        checkFlags(cursor, false);
        const ExrHeader header = checkHeader(cursor, false);
        checkInflation(header, 1);
        return header;
    }

    std::vector<ExrHeader> checkParts(std::size_t most) {
        ByteCursor cursor(bytes_);
        cursor.take(magic.size());
        checkFlags(cursor, true);
        std::vector<ExrHeader> headers;
        while (!cursor.startsWith('\0')) {
            if (headers.size() == most) fail(fmt::format("it has more than {} parts", most));
            headers.push_back(checkHeader(cursor, true));
            checkInflation(headers.back(), headers.size());
        }
        if (headers.empty()) fail("it has no parts");
        return headers;
    }

private:
    [[noreturn]] void fail(std::string_view what) const {
        throw InputError(fmt::format("{}: invalid OpenEXR data: {}", file_, printable(what)));
    }

    ExrHeader checkHeader(ByteCursor& cursor, bool ofSeveral) {
        header_ = {};
        chunks_ = compression_ = 0;
        std::set<std::string_view> seen;
        for (;;) {
            const auto attribute = nextAttribute(cursor);
            if (!attribute) fail("the header breaks off or an attribute is longer than the file");
            if (attribute->name.empty()) break;
            if (!seen.insert(attribute->name).second) {
                fail(
                    fmt::format("the attribute '{}' appears twice", attribute->name.substr(0, 40)));
            }
            checkSize(*attribute);
            if (attribute->type == "chlist") countChannels(attribute->value);
            if (attribute->name == "dataWindow") measure(attribute->value);
            if (attribute->name == "compression") checkCompression(attribute->value);
            if (attribute->name == "chunkCount") {
                chunks_ = ByteCursor(attribute->value).number<std::int32_t>().value_or(0);
            }
            if (ofSeveral && attribute->name == "type" && attribute->value != "scanlineimage") {
                fail(fmt::format("a part is no scan-line image; {} have these", rules_.files));
            }
        }
        if (header_.channels == 0) fail("the header names no channels");
        if (header_.width == 0) fail("the header has no data window");
        if (ofSeveral) checkChunks();
        return header_;
    }

    /// OpenEXR makes the table of a part as long as it is said to be.
    void checkChunks() const {
        constexpr std::size_t lines[] = {1, 1, 1, 16, 32};  // by method
        const std::size_t perChunk = lines[compression_];
        const std::size_t chunks = (header_.height + perChunk - 1) / perChunk;
        if (chunks_ < 0 || static_cast<std::size_t>(chunks_) != chunks) {
            fail(fmt::format("a part of {} lines states {} chunks; it has {}", header_.height,
                             chunks_, chunks));
        }
    }

    void checkInflation(const ExrHeader& header, std::size_t parts) const {
        const auto inflated =
            checkedProduct({header.width, header.height, header.channels, sizeof(float), parts});
        if (!inflated || *inflated / maxInflation > bytes_.size()) {
            fail(fmt::format("{} x {} pixels of {} channels cannot come out of {} bytes",
                             header.width, header.height, header.channels, bytes_.size()));
        }
    }

    void checkFlags(ByteCursor& cursor, bool severalParts) const {
        const auto version = cursor.number<std::uint32_t>();
        if (!version) fail("the header breaks off");
        if (!severalParts && (*version & multiPart) != 0)
            fail(fmt::format("it has several parts; {} have one", rules_.files));
        if (severalParts && (*version & multiPart) == 0) fail("it has one part only");
        if (*version & deep) fail(fmt::format("it is a deep image; {} are flat", rules_.files));
        if (*version & tiled) fail(fmt::format("it is tiled; {} have scan lines", rules_.files));
        if ((*version & versionMask) != 2 ||
            (*version & ~(versionMask | longNames | multiPart)) != 0) {
            fail(fmt::format("unknown version field {:#x}", *version));
        }
    }

    void checkSize(const Attribute& attribute) const {
        if (attribute.type == "string") return;
        if (attribute.type == "chlist" && attribute.name == "channels") return;
        const auto known =
            std::find_if(std::begin(typeSizes), std::end(typeSizes),
                         [&](const TypeSize& row) { return row.type == attribute.type; });
        if (known == std::end(typeSizes)) {
            fail(fmt::format("the attribute '{}' has a type that {} do not use",
                             attribute.name.substr(0, 40), rules_.files));
        }
        if (attribute.value.size() != known->bytes) {
            fail(fmt::format("the attribute '{}' has {} bytes; its type has {}",
                             attribute.name.substr(0, 40), attribute.value.size(), known->bytes));
        }
    }

    void countChannels(std::string_view list) {
        ByteCursor cursor(list);
        for (;;) {
            const auto name = cursor.word(maxName);
            if (!name) fail("the channel list breaks off");
            if (name->empty()) {
                if (cursor.left() > 0) fail("the channel list ends before its stated size");
                return;
            }
            const auto type = cursor.number<std::int32_t>();
            cursor.take(4);
            const auto x = cursor.number<std::int32_t>(), y = cursor.number<std::int32_t>();
            if (!type || !x || !y) fail("the channel list breaks off");
            if (*type != floatPixels && !(rules_.picture && *type == halfPixels)) {
                fail(fmt::format("channel '{}' is not of type {}", name->substr(0, 40),
                                 rules_.picture ? "half or float" : "float"));
            }
            if (*x != 1 || *y != 1) {
                fail(fmt::format("channel '{}' is subsampled", name->substr(0, 40)));
            }
            ++header_.channels;
        }
    }

    void measure(std::string_view box) {
        ByteCursor cursor(box);
        const auto left = cursor.number<std::int32_t>(), top = cursor.number<std::int32_t>();
        const auto right = cursor.number<std::int32_t>(), bottom = cursor.number<std::int32_t>();
        if (!bottom) fail("the data window breaks off");
        if (*left != 0 || *top != 0 || *right < 0 || *bottom < 0 || *right >= maxSide ||
            *bottom >= maxSide) {
            fail(
                fmt::format("the data window ({}, {}) - ({}, {}) has to start at (0, 0) and be at "
                            "most {} pixels a side",
                            *left, *top, *right, *bottom, maxSide));
        }
        header_.width = static_cast<std::size_t>(*right) + 1;
        header_.height = static_cast<std::size_t>(*bottom) + 1;
    }

    void checkCompression(std::string_view value) {
        const auto method = ByteCursor(value).number<std::uint8_t>();
        if (!method || *method > (rules_.picture ? pizCompression : zipCompression)) {
            fail(fmt::format("the compression has to be none, RLE, ZIPS{}",
                             rules_.picture ? ", ZIP or PIZ" : " or ZIP"));
        }
        compression_ = *method;
    }

    std::string_view bytes_;
    const std::string& file_;
    const ExrRules& rules_;
    ExrHeader header_;  ///< what was found of the header so far
    std::int32_t chunks_ = 0;
    int compression_ = 0;
};

}  // namespace

bool hasExrMagic(std::string_view bytes) {
    return bytes.starts_with(magic);
}

ExrHeader checkExrHeader(std::string_view bytes, const std::string& file, const ExrRules& rules) {
    if (!hasExrMagic(bytes)) {
        throw InputError(
            fmt::format("{}: is not an OpenEXR file: the first four bytes have to be "
                        "76 2f 31 01",
                        file));
    }
    return Checker(bytes, file, rules).check();
}

std::vector<ExrHeader> checkExrParts(std::string_view bytes, const std::string& file,
                                     const ExrRules& rules, std::size_t mostParts) {
    if (!hasExrMagic(bytes)) {
        throw InputError(fmt::format("{}: is not an OpenEXR file", file));
    }
    return Checker(bytes, file, rules).checkParts(mostParts);
}

bool exrHasParts(std::string_view bytes) {
    ByteCursor cursor(bytes);
    cursor.take(magic.size());
    return hasExrMagic(bytes) && (cursor.number<std::uint32_t>().value_or(0) & multiPart) != 0;
}

bool exrHeadersAreWhole(std::string_view bytes) {
    ByteCursor cursor(bytes);
    cursor.take(magic.size() + sizeof(std::uint32_t));
    const bool severalParts = exrHasParts(bytes);
    do {
        for (bool more = true; more;) {
            const auto attribute = nextAttribute(cursor);
            if (!attribute) return false;
            more = !attribute->name.empty();
        }
    } while (severalParts && cursor.left() > 0 && !cursor.startsWith('\0'));
    return true;
}

bool exrHasAttribute(std::string_view bytes, std::string_view name) {
    if (!hasExrMagic(bytes)) return false;
    ByteCursor cursor(bytes);
    cursor.take(magic.size() + sizeof(std::uint32_t));
    for (;;) {
        const auto attribute = nextAttribute(cursor);
        if (!attribute || attribute->name.empty()) return false;
        if (attribute->name == name) return true;
    }
}

bool exrSaysCoefficients(std::string_view bytes) {
    return exrHasAttribute(bytes, "hshfit:format");
}

std::optional<std::array<std::size_t, 2>> exrSize(std::string_view bytes) {
    if (!hasExrMagic(bytes)) return std::nullopt;
    ByteCursor cursor(bytes);
    cursor.take(magic.size() + sizeof(std::uint32_t));
    for (;;) {
        const auto attribute = nextAttribute(cursor);
        if (!attribute || attribute->name.empty()) return std::nullopt;
        if (attribute->name != "dataWindow") continue;
        ByteCursor box(attribute->value);
        const auto left = box.number<std::int32_t>(), top = box.number<std::int32_t>();
        const auto right = box.number<std::int32_t>(), bottom = box.number<std::int32_t>();
        if (!bottom || *left != 0 || *top != 0 || *right < 0 || *bottom < 0) return std::nullopt;
        return std::array{static_cast<std::size_t>(*right) + 1,
                          static_cast<std::size_t>(*bottom) + 1};
    }
}

std::optional<std::array<std::size_t, 2>> exrDisplaySize(std::string_view bytes) {
    if (!hasExrMagic(bytes)) return std::nullopt;
    ByteCursor cursor(bytes);
    cursor.take(magic.size() + sizeof(std::uint32_t));
    for (;;) {
        const auto attribute = nextAttribute(cursor);
        if (!attribute || attribute->name.empty()) return std::nullopt;
        if (attribute->name != "displayWindow") continue;
        ByteCursor box(attribute->value);
        const auto left = box.number<std::int32_t>(), top = box.number<std::int32_t>();
        const auto right = box.number<std::int32_t>(), bottom = box.number<std::int32_t>();
        if (!bottom || *right < *left || *bottom < *top) return std::nullopt;
        const auto length = [](std::int32_t from, std::int32_t to) {
            return static_cast<std::size_t>(std::int64_t{to} - from + 1);
        };
        return std::array{length(*left, *right), length(*top, *bottom)};
    }
}

bool exrSaysSize(std::string_view bytes, std::int32_t width, std::int32_t height) {
    return exrSize(bytes) ==
           std::array{static_cast<std::size_t>(width), static_cast<std::size_t>(height)};
}

}  // namespace hshfit::inline files
