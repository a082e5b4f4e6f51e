#include <hshfit/files/printable.h>

#include <cstdint>

#include <fmt/format.h>

namespace hshfit::inline files {
namespace {

/// The bytes of the UTF-8 character at the beginning of `text`, 0 if there is none (RFC 3629: no
/// surrogates, nothing overlong, nothing beyond U+10FFFF), and its code point.
std::size_t decode(std::string_view text, std::uint32_t& point) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    point = first;
    if (first < 0x80) return 1;
    const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 0;
    if (length == 0 || length > text.size() || first > 0xf4) return 0;
    point = first & (0x7fU >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0U) != 0x80) return 0;
        point = point << 6 | (byte(i) & 0x3fU);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = point >= 0xd800 && point <= 0xdfff;
    return point >= least[length] && point <= 0x10ffff && !surrogate ? length : 0;
}

/// Unicode's category Cc, the separators of lines and paragraphs, and the marks, embeddings and
/// isolates of bidirectional text.
bool isControl(std::uint32_t point) {
    return point < ' ' || (point >= 0x7f && point <= 0x9f) || point == 0x61c ||
           (point >= 0x200e && point <= 0x200f) || (point >= 0x2028 && point <= 0x202e) ||
           (point >= 0x2066 && point <= 0x2069);
}

/// Replaces what `replacement`, of a code point that is a control character, gives a text for.
template <class Replace>
std::string replaced(std::string_view text, Replace replacement) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        std::uint32_t point = 0;
        const std::size_t length = decode(text, point);
        if (length == 0) {
            out += '?';
            text.remove_prefix(1);
            continue;
        }
        if (isControl(point))
            out += replacement(point);
        else
            out += text.substr(0, length);
        text.remove_prefix(length);
    }
    return out;
}

}  // namespace

std::string printable(std::string_view text) {
    return replaced(text, [](std::uint32_t) { return std::string("?"); });
}

std::string printableLines(std::string_view text) {
    return replaced(text, [](std::uint32_t point) -> std::string {
        return point == '\n' || point == '\t' ? std::string(1, static_cast<char>(point)) : "?";
    });
}

std::string printableJson(std::string_view json) {
    return replaced(json, [](std::uint32_t point) -> std::string {
        return point == '\n' ? "\n" : fmt::format("\\u{:04x}", point);
    });
}

std::string shortened(std::string_view text, std::size_t limit) {
    if (text.size() <= limit) return std::string(text);
    constexpr std::string_view gap = "…";
    const auto continues = [&](std::size_t at) { return (text[at] & 0xc0) == 0x80; };
    const std::size_t kept = limit - gap.size();
    std::size_t head = kept / 2, tail = text.size() - (kept - kept / 2);
    while (head > 0 && continues(head)) --head;
    while (tail < text.size() && continues(tail)) ++tail;
    return fmt::format("{}{}{}", text.substr(0, head), gap, text.substr(tail));
}

}  // namespace hshfit::inline files
