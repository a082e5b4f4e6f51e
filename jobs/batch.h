#pragma once

#include "listener.h"

#include <hshfit/error.h>

#include <functional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// SPECs with each folder replaced by the measured files in it, in the order of their names: those
/// that a format recognises by content or that have its extension; coefficient files, presets and
/// folders within are passed over. Throws InputError for a folder that cannot be read, and one in
/// which there is no such file.
std::vector<std::string> expandInputs(const std::vector<std::string>& specs);

/// Whether SPECs ask for many results: several of them, or a folder.
bool areMany(const std::vector<std::string>& specs);

/// FOLDER/NAME + extension for each input: a file's name without its extension and options, a
/// model's specification with '_' for what file systems and shells take amiss. Throws UsageError
/// where two would be the same file.
std::vector<std::string> outputPaths(const std::vector<std::string>& specs,
                                     const std::string& folder, const std::string& extension);

struct InputFailure {
    std::string spec, reason;
    ExitCode code;
};

/// Calls `work(index, progress)` for every input, on all threads that oneTBB has: as many inputs at
/// a time as there are threads, and those left over help with the last ones from within. An Error
/// of one input, out of memory included, does not stop the others; an OutputError does. Failures
/// come back in the order of the inputs.
std::vector<InputFailure> forEachInput(const std::vector<std::string>& specs,
                                       const Listener& listener, const std::string& part,
                                       const std::function<void(std::size_t, ProgressCall)>& work);

/// Of all of them together: 3, or 4 if every one is of numbers; 0 if there are none.
ExitCode codeOf(const std::vector<InputFailure>& failures);

}  // namespace hshfit::jobs
