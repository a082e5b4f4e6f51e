#pragma once

#include <string>

namespace hshfit::inline files {

/// The extension of a path with its dot, in lower case: ".png" of "a/SPHERE.PNG"; empty without
/// one. Only ASCII letters change.
std::string extensionOf(const std::string& path);

}  // namespace hshfit::inline files
