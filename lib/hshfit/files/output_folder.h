#pragma once

#include <string>

namespace hshfit::inline files {

/// Throws OutputError where the folder of a file that is to be written is not there. A slash at the
/// end of `path`, for several files in a new folder, does not count.
void requireOutputFolder(const std::string& path);

}  // namespace hshfit::inline files
