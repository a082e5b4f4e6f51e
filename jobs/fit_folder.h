#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// What became of a folder.
struct BatchOutcome {
    std::size_t fitted = 0, kept = 0;  ///< kept: a result stood there already
    struct Failure {
        std::string file, reason;
    };
    std::vector<Failure> failures;
};

/// Calls `fitOne(file, result path)` for every regular file of `folder`, in the order of names, for
/// which `results` has no NAME.EXTENSION.json yet; results appear whole or not at all, so that a
/// run that was cut off goes on where it was. An Error of one file does not stop the others. Throws
/// InputError for a folder that cannot be read, OutputError for results that cannot be made.
BatchOutcome fitFolder(const std::string& folder, const std::string& results,
                       const std::function<void(const std::string&, const std::string&)>& fitOne,
                       const std::function<void(std::size_t, std::size_t)>& progress = {});

}  // namespace hshfit::jobs
