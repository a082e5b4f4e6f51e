#pragma once

#include <hshfit/rotation/rotation.h>

#include <string>

namespace hshfit::cli {

/// "A,B,C" in degrees.
Rotation parseEuler(const std::string& text);

}  // namespace hshfit::cli
