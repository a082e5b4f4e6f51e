#include <hshfit/gpu/shader_text.h>

#include <hshfit/brdf/transmission.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace hshfit::gpu {

std::string commentText(std::string text) {
    for (char& c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 32 || code > 126 || c == '\\') c = '?';
    }
    return text;
}

std::string backquoted(std::string_view text) {
    std::string result;
    for (const char c : text) {
        if (c == '\\' || c == '`' || c == '$') result += '\\';
        result += c;
    }
    return result;
}

std::string sourceComment(const std::string& specification) {
    const std::string comment = commentText(specification);
    if (transmissionSide(specification).empty()) return comment;
    return comment + "; a transmission: wo = (x, y, z) stands for (x, y, -z) below the lit side";
}

void checkPrefix(const std::string& prefix) {
    const auto isLetter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; };
    bool good = !prefix.empty() && isLetter(prefix[0]) && prefix.back() != '_' &&
                prefix.find("__") == std::string::npos && prefix.substr(0, 3) != "gl_";
    for (const char c : prefix) {
        good = good && (isLetter(c) || (c >= '0' && c <= '9') || c == '_');
    }
    if (!good) {
        throw UsageError(fmt::format(
            "shader prefix '{}'; it has to be letters, digits and single underscores, begin with a "
            "letter, not end with '_' and not begin with 'gl_'",
            commentText(prefix)));
    }
}

std::string withoutGaps(const std::string& text) {
    std::string result;
    bool gap = false;
    for (std::size_t first = 0; first < text.size();) {
        const std::size_t end = std::min(text.find('\n', first), text.size());
        const std::string line = text.substr(first, end - first);
        first = end + 1;
        if (line.find_first_not_of(' ') == std::string::npos) {
            gap = true;
            continue;
        }
        if (gap && line[0] != ' ' && line[0] != '}') result += '\n';
        gap = false;
        result += line + '\n';
    }
    return result;
}

}  // namespace hshfit::gpu
