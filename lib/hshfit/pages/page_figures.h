#pragma once

// The common parts of pages: their style and the figures in them.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::inline pages {

/// The bytes of a file; empty if it cannot be read.
std::string fileContent(const std::string& path);

/// An SVG document as part of a page: no prologue, no fixed size, names that no other `index` has.
/// `columns` are the left ends of its columns of panels, in its own units: on narrow screens the
/// page shows the columns below one another. One column, or none: the figure stays whole.
std::string inlinedFigure(std::string svg, std::size_t index,
                          std::span<const int> columns = std::span<const int>());

/// "gnuplot 5.4 patchlevel 4", from the SVG document; else "gnuplot".
std::string plotterOf(const std::string& svg);

/// A command line as markup in which no line ends between the hyphens of an option or behind them.
std::string commandMarkup(const std::string& command);

/// The style sheet of reports and comparisons.
std::string_view pageStyle();

/// The style sheet of a page that draws in the browser: colours, text and layout, then its own.
std::string livePageStyle(std::string_view own);

/// The text of a JSON document so that it can stand within a script element.
std::string scriptSafe(std::string json);

}  // namespace hshfit::inline pages
