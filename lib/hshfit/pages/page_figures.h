#pragma once

// The common parts of pages: their style and the figures in them.

#include <string>
#include <string_view>

namespace hshfit::inline pages {

/// The bytes of a file; empty if it cannot be read.
std::string fileContent(const std::string& path);

/// An SVG document as part of a page: no prologue, no fixed size, names that no other `index` has.
std::string inlinedFigure(std::string svg, std::size_t index);

/// "gnuplot 5.4 patchlevel 4", from the SVG document; else "gnuplot".
std::string plotterOf(const std::string& svg);

/// The style sheet of every page.
std::string_view pageStyle();

/// RFC 4648, for pictures within a page.
std::string base64(std::string_view bytes);

}  // namespace hshfit::inline pages
