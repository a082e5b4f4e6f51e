#include <hshfit/pages/page_figures.h>

#include <fstream>
#include <iterator>
#include <regex>

#include <fmt/format.h>

namespace hshfit::embedded {
extern const std::string_view page_css;
}

namespace hshfit::inline pages {

std::string fileContent(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string inlinedFigure(std::string svg, std::size_t index) {
    svg.erase(0, svg.find("<svg"));
    // Only the tag itself: std::regex recurses over the pictures that an SVG may hold.
    const std::size_t end = std::min(svg.find('>'), svg.size());
    std::string tag =
        std::regex_replace(svg.substr(0, end), std::regex(R"re(\s(width|height)="\d+")re"), "");
    tag = std::regex_replace(tag, std::regex("<svg"), "<svg role=\"img\"");
    svg = tag + svg.substr(end);
    svg = std::regex_replace(svg, std::regex("<title>[^<]*</title>"), "");
    const std::string own = fmt::format("f{}-", index);
    svg = std::regex_replace(svg, std::regex(R"re(( id=["'])(?=[A-Za-z]))re"), "$1" + own);
    return std::regex_replace(svg, std::regex(R"re((href=["']#|url\(#))re"), "$1" + own);
}

std::string plotterOf(const std::string& svg) {
    std::smatch match;
    const bool found =
        std::regex_search(svg, match, std::regex("(?:GNUPLOT) (\\d[^<]*?) *</desc>"));
    return found ? "gnuplot " + match[1].str() : "gnuplot";
}

std::string_view pageStyle() {
    return embedded::page_css;
}

std::string base64(std::string_view bytes) {
    constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    out.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t k) -> unsigned {
            return i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0;
        };
        const unsigned three = byte(0) << 16 | byte(1) << 8 | byte(2);
        for (unsigned k = 0; k < 4; ++k) {
            out += i + k > bytes.size() ? '=' : digits[three >> (18 - 6 * k) & 63];
        }
    }
    return out;
}

}  // namespace hshfit::inline pages
