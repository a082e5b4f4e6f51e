#pragma once

#include "item_key.h"
#include "manifest.h"
#include "store.h"

#include <jobs/common/listener.h>

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

struct BatchProgram;

/// An item beside its result. Stale: the result is of other inputs, options or another version of
/// the program.
struct ItemStatus {
    enum class State { done, failed, stale, missing };
    const BatchItem* item = nullptr;
    State state = State::missing;
    std::optional<ItemRecord> record = {};
};

std::string_view nameOf(ItemStatus::State state);

/// The items of a manifest, sorted by name, as they stand in a folder.
std::vector<ItemStatus> statusOf(const Manifest& manifest, const std::string& folder,
                                 const BatchProgram& program, const Listener& listener = {});

struct MergeOptions {
    int thumbnail = 48;  ///< pixels of the sphere of each material; 0: none
};

/// Writes one table of all items into the folder: table.csv and table.jsonl, index.html, which
/// sorts and filters it, and times.csv. The table has every number, truth value and short text of
/// the answers, without times, so that it has the same bytes however the work was shared out.
///
/// Throws OutputError. Returns the paths.
std::vector<std::string> mergeBatch(const std::vector<ItemStatus>& items, const std::string& folder,
                                    const BatchProgram& program, const MergeOptions& options,
                                    const Listener& listener = {});

}  // namespace hshfit::jobs
