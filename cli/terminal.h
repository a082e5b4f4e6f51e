#pragma once

#include <cstddef>
#include <optional>

namespace hshfit::cli {

/// The width of help in columns: the number that COLUMNS states, else the width of the terminal
/// that is standard output, else 80; at least 40 and at most 100, beyond which lines are hard to
/// read.
std::size_t columns();

/// The width of tables in columns, without an upper bound. None where lines are to stay whole:
/// standard output is no terminal and COLUMNS states nothing, so that other programs get a line for
/// each row.
std::optional<std::size_t> tableColumns();

enum class Stream { output, error };

/// Columns of the terminal that a stream is; none where it is no terminal, or one of unknown size.
std::optional<std::size_t> terminalWidth(Stream stream);

/// Whether text on a stream may have colours: it is a terminal, other than a dumb one, and NO_COLOR
/// (https://no-color.org) is absent or empty.
bool hasColour(Stream stream);

}  // namespace hshfit::cli
