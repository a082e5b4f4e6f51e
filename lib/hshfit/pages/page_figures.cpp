#include <hshfit/pages/page_figures.h>

#include <fstream>
#include <iterator>
#include <regex>

#include <fmt/format.h>

namespace hshfit::embedded {
extern const std::string_view live_css, page_css;
}

namespace hshfit::inline pages {

std::string fileContent(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

namespace {

/// The columns as documents of their own, which show the elements of the whole one in `<g>`.
std::string columnsOf(const std::string& tag, std::span<const int> columns,
                      const std::string& group) {
    std::smatch box;
    if (!std::regex_search(tag, box, std::regex(R"re(viewBox="0 0 (\d+) (\d+)")re"))) return {};
    const int width = std::stoi(box[1]);
    std::string parts;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const int end = i + 1 < columns.size() ? columns[i + 1] : width;
        parts += fmt::format(
            "\n<svg class=\"part\" aria-hidden=\"true\" viewBox=\"{} 0 {} {}\">"
            "<use href=\"#{}\"/></svg>",
            columns[i], end - columns[i], box[2].str(), group);
    }
    return parts;
}

}  // namespace

std::string inlinedFigure(std::string svg, std::size_t index, std::span<const int> columns) {
    svg.erase(0, svg.find("<svg"));
    // Only the tag itself: std::regex recurses over the pictures that an SVG may hold.
    const std::size_t end = std::min(svg.find('>'), svg.size());
    std::string tag = std::regex_replace(svg.substr(0, end),
                                         std::regex(R"re(\s(width|height)="[\d.]+(mm)?")re"), "");
    tag = std::regex_replace(tag, std::regex("<svg"), "<svg role=\"img\"");
    svg = tag + svg.substr(end);
    svg = std::regex_replace(svg, std::regex("<title>[^<]*</title>"), "");
    const std::string own = fmt::format("f{}-", index);
    svg = std::regex_replace(svg, std::regex(R"re(( id=["'])(?=[A-Za-z]))re"), "$1" + own);
    svg = std::regex_replace(svg, std::regex(R"re((href=["']#|url\(#))re"), "$1" + own);
    const std::size_t last = svg.rfind("</svg>"), first = svg.find('>') + 1;
    if (columns.size() < 2 || last == svg.npos || first > last) return svg;
    const std::string parts = columnsOf(tag, columns, own + "whole");
    if (parts.empty()) return svg;
    svg.replace(last, svg.npos, "</g></svg>" + parts);
    svg.insert(first, "<g id=\"" + own + "whole\">");
    return svg.insert(std::string_view("<svg").size(), " class=\"whole\"");
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

std::string livePageStyle(std::string_view own) {
    return std::string(embedded::live_css) + std::string(own);
}

std::string scriptSafe(std::string json) {
    for (std::size_t at = json.find('<'); at != json.npos; at = json.find('<', at))
        json.replace(at, 1, "\\u003c");
    return json;
}

}  // namespace hshfit::inline pages
