#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace hshfit::inline files {

/// The string "format" of the outermost object of a JSON text, in any order of keys and with any
/// spaces. Nothing behind it is looked at. Empty for a text that has none.
std::string jsonFormat(std::string_view text);

/// Bytes from the beginning of a file that beginsAsJson should get.
constexpr std::size_t jsonStartBytes = 4096;

/// Whether a file that begins with these bytes may be a JSON object: after white space, '{' and
/// then a member's name or the end. JSON has control characters only as escapes, so that none among
/// the bytes may be another than white space: the first numbers of a table can look like '{' too.
bool beginsAsJson(std::string_view bytes);

/// The "format" of a regular file; empty where the file cannot be read.
std::string jsonFormatOf(const std::string& path);

}  // namespace hshfit::inline files
