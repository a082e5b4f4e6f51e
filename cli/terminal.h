#pragma once

#include <cstddef>

namespace hshfit::cli {

/// Columns that help takes: those that COLUMNS states, else those of the terminal that is standard
/// output, else 80; at least 40 and at most 100, beyond which lines are hard to read.
std::size_t columns();

enum class Stream { output, error };

/// Whether text on a stream may have colours: it is a terminal, other than a dumb one, and NO_COLOR
/// (https://no-color.org) is absent or empty.
bool hasColour(Stream stream);

}  // namespace hshfit::cli
