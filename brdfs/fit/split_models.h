#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::brdfs {

/// The terms of a sum of models: split at every '+' before a letter; the '+' of a number stands
/// before a digit. Spaces are left out.
std::vector<std::string> splitModels(std::string_view spec);

/// The names of the terms of a sum: those of their models, with a number where a model stands more
/// than once, such as "lambert", "ggx1", "ggx2".
std::vector<std::string> termNames(std::string_view spec);

/// "ggx2.alpha": the parameter `key` of a term of `names` (termNames); the key alone where the sum
/// has one term.
std::string parameterName(const std::vector<std::string>& names, std::size_t term,
                          std::string_view key);

/// "ggx.alpha" of "ggx2.alpha": the name without the number of its term. Models end in a letter.
std::string withoutNumber(std::string_view parameter);

}  // namespace hshfit::brdfs
