#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace hshfit::brdfs {

/// The looks of a file that no format takes, and what to do: "a Git LFS pointer, not the file
/// itself; fetch that with 'git lfs pull'". By the first bytes of the file; none if they look like
/// nothing known. `certain`: web pages alone, which may quote a format; to be asked before the
/// formats.
std::optional<std::string> foreignContent(std::span<const unsigned char> head, bool certain);

/// The text behind a byte-order mark of UTF-8 (EF BB BF), which Windows programs put before it.
std::string_view withoutByteOrderMark(std::string_view text);

/// Whether the bytes are text: no control characters but white space.
bool isPlainText(std::span<const unsigned char> head);

}  // namespace hshfit::brdfs
