#pragma once

#include <set>
#include <string>
#include <string_view>

namespace hshfit::jobs {

/// Adds the files that a word of a command line names: the file of a specification, those of the
/// parts of a sum or a list, and of files that are text in JSON (scenes, fits, descriptions,
/// coefficient files) those that they name in turn, by paths from their own folder or from the
/// current one.
void addNamedFiles(std::string_view text, std::set<std::string>& files);

}  // namespace hshfit::jobs
