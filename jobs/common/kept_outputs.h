#pragma once

#include "listener.h"

#include <hshfit/files/output_rule.h>

#include <string>
#include <vector>

namespace hshfit::jobs {

// The one rule for files that stand where a command writes. A file that is valid, made from inputs
// of the same bytes with the same options by the same version, is kept. Any other is refused
// (OutputError) unless the rule of the process replaces (hshfit/files/output_rule.h).

/// SHA-256 of the meaning of a word of a command line: its text without folders, and the bytes of
/// the files that it names (named_files.h), of a folder all files in it.
std::string contentOf(const std::string& word);

/// Whether a word names a file, alone or in a sum or a list.
bool namesFile(const std::string& word);

/// The key of what the command of the rule makes of these inputs; empty where no rule is in use.
std::string keyOf(const std::vector<std::string>& specs);

enum class Found {
    toMake,  ///< something is absent, or its bytes decide once they are made
    /// Valid, but for files that were taken away or inputs that failed: all are made again.
    incomplete,
    valid,
};
struct FoundOutputs {
    Found found = Found::toMake;
    int exitCode = 0;  ///< of the run that made them
};

/// The state of everything that the command would write to `outputs`, files or folders. Throws
/// OutputError, before any work, for what is known to be made from other input, options or version,
/// or by somebody else. Files whose format has no place for a key do not decide: their bytes do.
FoundOutputs findOutputs(const std::vector<std::string>& outputs, const std::string& key);

/// "kept FILE: made from the same input, options and version"
std::string keptLine(const std::string& output);

/// Says which of the results of many inputs are valid, and takes them out of `specs` and
/// `outputs`; returns their paths.
std::vector<std::string> takeKept(std::vector<std::string>& specs,
                                  std::vector<std::string>& outputs);

}  // namespace hshfit::jobs
