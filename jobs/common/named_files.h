#pragma once

#include <set>
#include <string>
#include <string_view>

namespace hshfit::jobs {

/// Adds the files that a word of a command line names: the file of a specification, or the files of
/// the parts of a sum or a list. Where a file is text in JSON (scenes, fits, descriptions,
/// coefficient files), adds the files that it names in turn, by paths from its own folder or from
/// the current one.
void addNamedFiles(std::string_view text, std::set<std::string>& files);

}  // namespace hshfit::jobs
