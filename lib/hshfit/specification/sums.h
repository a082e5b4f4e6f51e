#pragma once

#include <cstddef>
#include <string_view>

namespace hshfit::inline specification {

/// The position of the first '+' at or after `from` that joins two terms of a specification, with
/// or without spaces around it; npos if there is none. The '+' of a number such as 1e+3 joins
/// nothing, nor does one after '=', '/' or ','. A path may hold '+': callers that know of files
/// look for paths.
std::size_t nextJoint(std::string_view text, std::size_t from);

/// The text without the spaces at its ends.
std::string_view withoutSpaces(std::string_view text);

}  // namespace hshfit::inline specification
