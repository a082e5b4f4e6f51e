#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hshfit::inline files {

/// `text`, which may quote a file or the name of one, as a terminal, a page or a figure can show
/// it: one line of valid UTF-8. Each control character (C0, DEL, C1, line and paragraph separators,
/// characters that turn the direction of writing) and each byte that is no UTF-8 becomes '?'.
std::string printable(std::string_view text);

/// The same for a text of several lines: line feeds and tabs stay.
std::string printableLines(std::string_view text);

/// JSON whose strings have those control characters as escapes.
std::string printableJson(std::string_view json);

/// `text` within `limit` bytes (10 or more): of a longer one both ends, with "…" between them. No
/// UTF-8 character is cut.
std::string shortened(std::string_view text, std::size_t limit);

}  // namespace hshfit::inline files
