#include "fit_folder.h"

#include <jobs/common/kept_outputs.h>

#include <hshfit/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace hshfit::jobs {

namespace fs = std::filesystem;

BatchOutcome fitFolder(const std::string& folder, const std::string& results,
                       const std::function<void(const std::string&, const std::string&)>& fitOne,
                       const std::function<void(std::size_t, std::size_t)>& progress) {
    std::error_code error;
    std::vector<fs::path> files;
    fs::directory_iterator entries(folder, error);
    if (error) throw InputError(fmt::format("{}: {}", folder, error.message()));
    for (const fs::directory_entry& entry : entries)
        if (entry.is_regular_file(error)) files.push_back(entry.path());
    std::ranges::sort(files);
    fs::create_directories(results, error);
    if (error) throw OutputError(fmt::format("{}: {}", results, error.message()));
    std::vector<std::string> data, outputs;
    for (const fs::path& file : files) {
        data.push_back(file.string());
        outputs.push_back((fs::path(results) / (file.filename().string() + ".json")).string());
    }
    BatchOutcome outcome;
    outcome.kept = takeKept(data, outputs).size();
    for (std::size_t i = 0; i < data.size(); ++i) {
        try {
            const OutputKey key(keyOf({data[i]}));
            fitOne(data[i], outputs[i]);
            ++outcome.fitted;
        } catch (const OutputError&) {
            throw;
        } catch (const Error& failure) {
            outcome.failures.push_back({data[i], failure.what()});
        }
        if (progress) progress(outcome.kept + i + 1, files.size());
    }
    return outcome;
}

}  // namespace hshfit::jobs
