#pragma once

#include <hshfit/representation/representation.h>

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hshfit::cli {

/// Kind, bytes and steps, for JSON answers.
nlohmann::ordered_json describeForm(const Representation& representation);
/// Kind, bytes and steps in one line.
std::string formLine(const Representation& representation);

}  // namespace hshfit::cli
