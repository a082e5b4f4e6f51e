#pragma once

#include <hshfit/rotation/rotation.h>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::cli {

/// `count` finite numbers with commas between. Throws UsageError that names the option and shows
/// `form`.
std::vector<double> parseNumbers(const std::string& text, std::size_t count,
                                 std::string_view option, std::string_view form);

/// "A,B,C" in degrees.
Rotation parseEuler(const std::string& text);

}  // namespace hshfit::cli
