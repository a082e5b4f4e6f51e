#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The terms of a sum of models: split at every '+' before a letter; the '+' of a number stands
/// before a digit. Spaces are left out.
std::vector<std::string> splitModels(std::string_view spec);

}  // namespace hshfit::brdfs
