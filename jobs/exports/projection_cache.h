#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/tradeoff/projection_folder.h>

#include <filesystem>

namespace hshfit::jobs {

/// `path` is ProjectionFolder::path.
constexpr OptionRow cacheRow(Member path) {
    const OptionRow row{"cache", path,
                        "Folder that keeps projections from run to run, of plan, tradeoff and "
                        "choose alike; made if absent"};
    return row.takes({.files = Files::addedFolder});
}

/// Makes a folder ready for use, which is made if it is named and absent. Files that
/// specifications name may lie in `beside`. Damaged files are told to the listener. Throws
/// OutputError.
void useCache(tradeoff::ProjectionFolder& folder, const Listener& listener,
              const std::filesystem::path& beside = {});

}  // namespace hshfit::jobs
