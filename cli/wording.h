#pragma once

#include <hshfit/wording.h>

namespace hshfit::cli {

/// The settings and functions that messages refer to, as options and commands of the program.
Wording optionWording();

}  // namespace hshfit::cli
