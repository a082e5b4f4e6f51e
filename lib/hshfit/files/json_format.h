#pragma once

#include <string>
#include <string_view>

namespace hshfit::inline files {

/// The string "format" of the outermost object of a JSON text, in any order of keys and with any
/// spaces. Nothing behind it is looked at. Empty for a text that has none.
std::string jsonFormat(std::string_view text);

/// The "format" of a regular file; empty where the file cannot be read.
std::string jsonFormatOf(const std::string& path);

}  // namespace hshfit::inline files
