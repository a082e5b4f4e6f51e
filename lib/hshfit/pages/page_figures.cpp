#include <hshfit/pages/page_figures.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>

#include <fmt/format.h>
#include <kainjow/mustache.hpp>

namespace hshfit::embedded {
extern const std::string_view live_css, page_css;
}

namespace hshfit::inline pages {

std::string fileContent(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

std::string commandMarkup(const std::string& command) {
    const std::string text = kainjow::mustache::html_escape(command);
    return std::regex_replace(text, std::regex(R"((^| )(--[^ ]+))"),
                              "$1<span class=\"option\">$2</span>");
}

namespace {

/// The columns as documents of their own, which show the elements of the whole one in `<g>`, at
/// most `unit` pixels for each unit.
std::string columnsOf(const std::string& tag, std::span<const int> columns,
                      const std::string& group, double unit) {
    std::smatch box;
    if (!std::regex_search(tag, box, std::regex(R"re(viewBox="0 0 (\d+) (\d+)")re"))) return {};
    const int width = std::stoi(box[1]);
    std::string parts;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        const int end = i + 1 < columns.size() ? columns[i + 1] : width;
        parts += fmt::format(
            "\n<svg class=\"part\" aria-hidden=\"true\" style=\"max-width:{:.0f}px\" "
            "preserveAspectRatio=\"xMinYMin slice\" viewBox=\"{} 0 {} {}\"><use "
            "href=\"#{}\"/></svg>",
            unit * (end - columns[i]), columns[i], end - columns[i], box[2].str(), group);
    }
    return parts;
}

/// Elements `<title>` that hold text alone.
void removeTitles(std::string& svg) {
    constexpr std::string_view open = "<title>", close = "</title>";
    for (std::size_t at = 0; (at = svg.find(open, at)) != svg.npos;) {
        const std::size_t end = svg.find('<', at + open.size());
        if (end != svg.npos && svg.compare(end, close.size(), close) == 0)
            svg.erase(at, end + close.size() - at);
        else
            at += open.size();
    }
}

/// The text with `own` after each mark whose next character is accepted.
template <class Accept>
std::string withAfter(const std::string& text, std::string_view mark, const std::string& own,
                      const Accept& accept) {
    std::string result;
    std::size_t done = 0;
    for (std::size_t at = 0; (at = text.find(mark, at)) != text.npos;) {
        at += mark.size();
        if (at == text.size() || !accept(static_cast<unsigned char>(text[at]))) continue;
        result.append(text, done, at - done);
        result += own;
        done = at;
    }
    return result.append(text, done);
}

}  // namespace

std::string inlinedFigure(std::string svg, std::size_t index, std::span<const int> columns) {
    svg.erase(0, svg.find("<svg"));
    // Only the tag itself: std::regex recurses over the pictures that an SVG may hold.
    const std::size_t end = std::min(svg.find('>'), svg.size());
    // Units are then points, and the text is small.
    const bool inMillimetres = svg.find("mm\"") < end;
    std::string tag = std::regex_replace(svg.substr(0, end),
                                         std::regex(R"re(\s(width|height)="[\d.]+(mm)?")re"), "");
    tag = std::regex_replace(tag, std::regex("<svg"), "<svg role=\"img\"");
    svg = tag + svg.substr(end);
    removeTitles(svg);
    const std::string own = fmt::format("f{}-", index);
    const auto isLetter = [](unsigned char c) { return std::isalpha(c) != 0; };
    for (const char* mark : {" id=\"", " id='"}) svg = withAfter(svg, mark, own, isLetter);
    for (const char* mark : {"href=\"#", "href='#", "url(#"})
        svg = withAfter(svg, mark, own, [](unsigned char) { return true; });
    const std::size_t last = svg.rfind("</svg>"), first = svg.find('>') + 1;
    if (columns.size() < 2 || last == svg.npos || first > last) return svg;
    const std::string parts = columnsOf(tag, columns, own + "whole", inMillimetres ? 1.5 : 1);
    if (parts.empty()) return svg;
    svg.replace(last, svg.npos, "</g></svg>" + parts);
    // A column that shrinks by half on a narrow page has larger text there.
    constexpr int wide = 700;
    const bool large = columns[1] - columns[0] > wide;
    svg.insert(first,
               fmt::format("<g id=\"{}whole\" class=\"columns{}\">", own, large ? " wide" : ""));
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
