#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The result of fitting every file of a folder.
struct BatchOutcome {
    std::size_t fitted = 0, kept = 0;  ///< kept: files whose result stands and is valid
    struct Failure {
        std::string file, reason;
    };
    std::vector<Failure> failures;
};

/// Calls `fitOne(file, result path)` for every regular file of `folder`, sorted by name, that has
/// no valid NAME.EXTENSION.json in `results` yet (kept_outputs.h). Results are written whole or not
/// at all, so that an interrupted run can be resumed. An Error of one file does not stop the
/// others. Throws InputError for a folder that cannot be read, OutputError if `results` cannot be
/// created.
BatchOutcome fitFolder(const std::string& folder, const std::string& results,
                       const std::function<void(const std::string&, const std::string&)>& fitOne,
                       const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace hshfit::jobs
