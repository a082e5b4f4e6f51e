#include <hshfit/byte_cursor.h>
#include <hshfit/error.h>
#include <hshfit/files/checksum.h>
#include <hshfit/files/exr_header.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/json_format.h>
#include <hshfit/files/made_from.h>

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

#include <fmt/format.h>

namespace hshfit::inline files {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::string_view member = "made_from", attribute = "hshfit:made_from";
constexpr std::string_view pngMagic("\x89PNG\r\n\x1a\n", 8);
constexpr std::size_t pngEnd = 12;                  // the chunk IEND
constexpr std::size_t most = std::size_t{1} << 20;  // bytes of a statement
constexpr int deepest = 4;

std::string textOf(const MadeFrom& made, std::string_view content) {
    ordered_json json = {
        {"command", made.command}, {"key", made.key}, {"content", sha256(content)}};
    if (made.exitCode != 0) json["exit_code"] = made.exitCode;
    if (!made.files.empty()) json["files"] = made.files;
    if (!made.sums.empty()) json["sums"] = made.sums;
    return jsonText(json);
}

std::optional<MadeFrom> parsed(std::string_view text, const std::string& path) {
    try {
        const nlohmann::json json = parseJson(text, path, deepest);
        MadeFrom made{.command = json.at("command"), .key = json.at("key")};
        made.exitCode = json.value("exit_code", 0);
        made.content = json.value("content", "");
        if (json.contains("files")) made.files = json["files"].get<std::vector<std::string>>();
        if (json.contains("sums")) made.sums = json["sums"].get<std::vector<std::string>>();
        return made;
    } catch (const Error&) {
        return std::nullopt;
    } catch (const nlohmann::json::exception&) {
        return std::nullopt;
    }
}

/// At most `count` bytes from `offset`.
std::string bytesAt(std::istream& file, std::uint64_t offset, std::size_t count) {
    std::string bytes(count, '\0');
    file.clear();
    file.seekg(static_cast<std::streamoff>(offset));
    file.read(bytes.data(), static_cast<std::streamsize>(count));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

void appendBigEndian(std::string& bytes, std::uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255U);
}

std::uint32_t bigEndian(std::string_view bytes) {
    std::uint32_t number = 0;
    for (const char byte : bytes.substr(0, 4))
        number = number << 8 | static_cast<unsigned char>(byte);
    return number;
}

/// A file open for changes; every failure of it is an OutputError.
class Changed {
public:
    explicit Changed(const std::string& path)
        : path_(path), file_(path, std::ios::in | std::ios::out | std::ios::binary) {
        if (!file_) fail();
    }
    std::istream& in() { return file_; }
    void write(std::uint64_t offset, std::string_view bytes) {
        file_.clear();
        file_.seekp(static_cast<std::streamoff>(offset));
        file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        file_.flush();
        if (!file_) fail();
    }

private:
    [[noreturn]] void fail() const {
        throw OutputError(fmt::format("cannot write '{}': {}", path_, std::strerror(errno)));
    }
    std::string path_;
    std::fstream file_;
};

// --- JSON: the last member of the root object ---------------------------------------------------

bool addToJson(const std::string& path, std::uint64_t size, const MadeFrom& made) {
    Changed file(path);
    constexpr std::size_t tail = 64;
    const std::uint64_t from = size - std::min<std::uint64_t>(size, tail);
    const std::string end = bytesAt(file.in(), from, tail);
    const std::size_t brace = end.find_last_not_of(" \t\r\n");
    if (brace == std::string::npos || end[brace] != '}' || brace == 0) return false;
    const std::size_t last = end.find_last_not_of(" \t\r\n", brace - 1);
    if (last == std::string::npos || end[last] == '{') return false;
    const bool lines = end.find('\n', last) < brace;  // an indented document stays so
    const std::string text = textOf(made, bytesAt(file.in(), 0, from + last + 1));
    file.write(from + last + 1, lines ? fmt::format(",\n  \"{}\": {}\n}}\n", member, text)
                                      : fmt::format(",\"{}\":{}}}\n", member, text));
    return true;
}

std::optional<MadeFrom> fromJson(std::istream& file, std::uint64_t size, const std::string& path) {
    for (std::size_t tail = 4096; tail <= most; tail *= 16) {
        const std::uint64_t from = size - std::min<std::uint64_t>(size, tail);
        const std::string end = bytesAt(file, from, tail);
        const std::size_t at = end.rfind(fmt::format("\"{}\":", member));
        if (at == std::string::npos) {
            if (from == 0) break;
            continue;
        }
        const std::size_t brace = end.rfind('}');
        const std::size_t begin = at + member.size() + 3;
        if (brace == std::string::npos || brace <= begin) return std::nullopt;
        auto made = parsed(std::string_view(end).substr(begin, brace - begin), path);
        // The comma that the statement brought stands before its name.
        const std::size_t comma = end.rfind(',', at);
        if (made && comma != std::string::npos)
            made->changed = sha256(bytesAt(file, 0, from + comma)) != made->content;
        return made;
    }
    return std::nullopt;
}

// --- PNG: a text chunk before the last ----------------------------------------------------------

bool addToPng(const std::string& path, std::uint64_t size, const MadeFrom& made) {
    Changed file(path);
    const std::string end = bytesAt(file.in(), size - pngEnd, pngEnd);
    if (end.substr(4, 4) != "IEND") return false;
    std::string content("tEXt");
    content += member;
    content += '\0';
    content += textOf(made, bytesAt(file.in(), 0, size - pngEnd));
    std::string chunk;
    appendBigEndian(chunk, static_cast<std::uint32_t>(content.size() - 4));
    chunk += content;
    appendBigEndian(
        chunk, static_cast<std::uint32_t>(::crc32(0, reinterpret_cast<const Bytef*>(content.data()),
                                                  static_cast<uInt>(content.size()))));
    file.write(size - pngEnd, chunk + end);
    return true;
}

std::optional<MadeFrom> fromPng(std::istream& file, std::uint64_t size, const std::string& path) {
    for (std::uint64_t at = pngMagic.size(); at + pngEnd <= size;) {
        const std::string head = bytesAt(file, at, 8);
        if (head.size() < 8) break;
        const std::uint32_t length = bigEndian(head);
        if (head.substr(4) == "tEXt" && length > member.size() && length < most) {
            const std::string content = bytesAt(file, at + 8, length);
            if (content.starts_with(member) && content[member.size()] == '\0') {
                auto made = parsed(std::string_view(content).substr(member.size() + 1), path);
                if (made) made->changed = sha256(bytesAt(file, 0, at)) != made->content;
                return made;
            }
        }
        at += pngEnd + length;
    }
    return std::nullopt;
}

// --- OpenEXR: an attribute, with the table of chunks moved ---------------------------------------

constexpr std::uint32_t severalParts = 0x1000;

struct ExrPlace {
    std::size_t end = 0;  ///< the byte that ends the header
    std::optional<std::string> made = {};
};

/// Walks the attributes of the header at the beginning of `bytes`.
std::optional<ExrPlace> placeIn(std::string_view bytes) {
    ByteCursor cursor(bytes);
    cursor.take(4);
    const auto flags = cursor.number<std::uint32_t>();
    if (!hasExrMagic(bytes) || !flags || (*flags & severalParts) != 0) return std::nullopt;
    ExrPlace place;
    for (;;) {
        const auto name = cursor.word(255);
        if (!name) return std::nullopt;
        if (name->empty()) {
            place.end = cursor.position() - 1;
            return place;
        }
        const auto type = cursor.word(255);
        const auto size = cursor.number<std::int32_t>();
        if (!type || !size || *size < 0) return std::nullopt;
        const auto value = cursor.take(static_cast<std::size_t>(*size));
        if (!value) return std::nullopt;
        if (*name == attribute) place.made = std::string(*value);
    }
}

/// The header of a file, which is as long as it is: read in growing pieces.
std::optional<ExrPlace> placeIn(std::istream& file, std::uint64_t size) {
    for (std::size_t head = 4096;; head *= 16) {
        const auto place = placeIn(bytesAt(file, 0, head));
        if (place || head >= size || head > most * 16) return place;
    }
}

/// Chunks lie behind the table of their offsets, whose least ends it; 0 where it does not hold.
std::size_t firstChunk(std::string_view bytes, std::size_t table) {
    std::uint64_t end = bytes.size();
    for (std::size_t at = table; at + 8 <= end; at += 8) {
        std::uint64_t offset = 0;
        std::memcpy(&offset, bytes.data() + at, sizeof offset);
        if (offset < at + 8 || offset >= bytes.size()) return 0;
        end = std::min(end, offset);
    }
    return end == bytes.size() ? 0 : static_cast<std::size_t>(end);
}

bool addToExr(const std::string& path, std::uint64_t size, const MadeFrom& made) {
    std::ifstream file(path, std::ios::binary);
    const auto place = placeIn(file, size);
    if (!place || place->made) return false;
    std::string bytes = bytesAt(file, 0, size);
    std::string added(attribute);
    added += '\0';
    added += "string";
    added += '\0';
    const std::size_t table = place->end + 1, end = firstChunk(bytes, table);
    if (end == 0) return false;
    const std::string text = textOf(made, std::string_view(bytes).substr(end));
    const auto length = static_cast<std::int32_t>(text.size());
    added.append(reinterpret_cast<const char*>(&length), sizeof length);
    added += text;
    for (std::size_t at = table; at + 8 <= end; at += 8) {
        std::uint64_t offset = 0;
        std::memcpy(&offset, bytes.data() + at, sizeof offset);
        offset += added.size();
        std::memcpy(bytes.data() + at, &offset, sizeof offset);
    }
    bytes.insert(place->end, added);
    Changed(path).write(0, bytes);
    return true;
}

std::optional<MadeFrom> fromExr(std::istream& file, std::uint64_t size, const std::string& path) {
    const auto place = placeIn(file, size);
    if (!place || !place->made) return std::nullopt;
    auto made = parsed(*place->made, path);
    const std::string bytes = bytesAt(file, 0, size);
    const std::size_t pixels = firstChunk(bytes, place->end + 1);
    if (made) made->changed = sha256(std::string_view(bytes).substr(pixels)) != made->content;
    return made;
}

enum class Kind { other, json, png, exr };

Kind kindOf(std::istream& file, std::uint64_t size) {
    const std::string head = bytesAt(file, 0, jsonStartBytes);
    if (hasExrMagic(head)) return Kind::exr;
    if (head.starts_with(pngMagic) && size > pngMagic.size() + pngEnd) return Kind::png;
    return beginsAsJson(head) ? Kind::json : Kind::other;
}

}  // namespace

std::string sumOfPart(const std::string& path) {
    constexpr std::uint64_t piece = std::uint64_t{1} << 20, pieces = 16;
    std::error_code error;
    const std::uint64_t size = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file) return "absent";
    if (size <= pieces * piece) return sha256(bytesAt(file, 0, size));
    std::string bytes = fmt::format("{}\n", size);
    for (std::uint64_t k = 0; k < pieces; ++k)
        bytes += bytesAt(file, (size - piece) * k / (pieces - 1), piece);
    return sha256(bytes);
}

bool canStateMadeFrom(const std::string& path) {
    constexpr std::array<std::string_view, 3> extensions{".json", ".exr", ".png"};
    return std::ranges::find(extensions, extensionOf(path)) != extensions.end();
}

bool addMadeFrom(const std::string& path, const MadeFrom& made) {
    std::error_code error;
    const std::uint64_t size = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file) return false;
    switch (kindOf(file, size)) {
        case Kind::json:
            return addToJson(path, size, made);
        case Kind::png:
            return addToPng(path, size, made);
        case Kind::exr:
            return addToExr(path, size, made);
        case Kind::other:
            return false;
    }
    return false;
}

std::optional<MadeFrom> madeFromOf(const std::string& path) {
    std::error_code error;
    if (!canStateMadeFrom(path) || !fs::is_regular_file(path, error)) return std::nullopt;
    const std::uint64_t size = fs::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    if (error || !file) return std::nullopt;
    switch (kindOf(file, size)) {
        case Kind::json:
            return fromJson(file, size, path);
        case Kind::png:
            return fromPng(file, size, path);
        case Kind::exr:
            return fromExr(file, size, path);
        case Kind::other:
            return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace hshfit::inline files
