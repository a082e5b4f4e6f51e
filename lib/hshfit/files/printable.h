#pragma once

#include <string>
#include <string_view>

namespace hshfit::inline files {

/// `text`, which may quote a file, on one line and without control characters.
std::string printable(std::string_view text);

}  // namespace hshfit::inline files
