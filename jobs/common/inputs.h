#pragma once

#include "listener.h"

#include <hshfit/error.h>

#include <functional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The files of a folder that are inputs.
enum class Members { measured, coefficients, both };

/// SPECs with each folder replaced by its files of a kind, sorted by name, and each pattern (`*`,
/// `?`, `[...]`, glob(7)) by the files that match. A format recognises a measured file by content
/// or by extension. Presets and subfolders are skipped. Throws InputError for a folder that cannot
/// be read or has no such file.
std::vector<std::string> expandInputs(const std::vector<std::string>& specs,
                                      Members members = Members::measured);

/// Whether a SPEC can only be meant as a pattern of paths: it has `*`, `?` or `[`, names no file,
/// and is no specification of models, presets or a scaled sum of these ("0.5*lambert +
/// ggx:alpha=.2").
bool isPattern(const std::string& spec);

/// Whether SPECs give many results: there are several of them, or one is a folder or a pattern that
/// matches.
bool areMany(const std::vector<std::string>& specs);

/// The name of a result: a file's name without extension and options, or a model's specification
/// with '_' for characters special to file systems and shells.
std::string nameOf(const std::string& spec);

/// FOLDER/NAME + extension for each input. NAME is nameOf. Throws UsageError if two paths are
/// equal.
std::vector<std::string> outputPaths(const std::vector<std::string>& specs,
                                     const std::string& folder, const std::string& extension);

/// Throws OutputError if a file stands where the folder of many results should.
void requireFolder(const std::string& folder);

struct InputFailure {
    std::string spec, reason;
    ExitCode code;
};

/// Calls `work(index, progress)` for every input, one input per thread of oneTBB. Threads
/// without an input left join the parallel loops of the last ones. An Error of one input, out
/// of memory included, does not stop the others; an OutputError does. Failures come back in the
/// order of the inputs.
std::vector<InputFailure> forEachInput(const std::vector<std::string>& specs,
                                       const Listener& listener, const std::string& part,
                                       const std::function<void(std::size_t, ProgressCall)>& work);

/// The exit code of a batch: 0 without failures, 4 if all of them are numerical, else 3.
ExitCode codeOf(const std::vector<InputFailure>& failures);

}  // namespace hshfit::jobs
