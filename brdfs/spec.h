#pragma once

#include <brdfs/catalog.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// Parses "key=value,key=value" (may be empty) against the table's parameters: every key declared
/// and given once, every value finite and in range, every parameter without a default given. Three
/// equal colour values become one, so that grey stays grey.
///
/// `owner` ("ward") starts every message. Throws UsageError that names the key, the value and
/// the valid values.
Parameters parseParameters(std::string_view owner, std::span<const Parameter> declared,
                           std::string_view text);

/// The two halves of it: what the text states, and that with defaults and the canonical text.
Parameters readParameters(std::string_view owner, std::span<const Parameter> declared,
                          std::string_view text);
Parameters completed(std::string_view owner, std::span<const Parameter> declared,
                     Parameters stated);

/// The path in a specification of a file: all of it where that exists, else the longest part before
/// a ':' that does, so that the path, the options and the names after it may hold colons; "" where
/// there is none.
std::string_view pathIn(std::string_view spec);

/// The valid values of a parameter, for messages and listings: "0 to 1, or r/g/b", "1992|duer".
std::string validValues(const Parameter& parameter);

/// The least number of insertions, deletions and replacements that turns one into the other.
std::size_t editDistance(std::string_view a, std::string_view b);

/// " (did you mean 'ggx'?)" if one of `known` starts with `word` or is within two edits of it, else
/// "".
std::string suggestion(std::string_view word, std::span<const std::string_view> known);

/// "a, b, c".
std::string joined(std::span<const std::string_view> words);

}  // namespace hshfit::brdfs
