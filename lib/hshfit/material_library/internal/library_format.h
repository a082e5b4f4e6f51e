#pragma once

#include <cstddef>

namespace hshfit::material_library {

/// "format" of the head of a library, and the newest version that is read and written.
inline constexpr const char* libraryFormat = "hshfit-library";
inline constexpr int newestLibrary = 2;
/// The version of files whose codes have no scales; readers of that version read them.
inline constexpr int versionWithoutScales = 1;

}  // namespace hshfit::material_library
