#pragma once

#include "manifest.h"
#include "shards.h"
#include "store.h"

#include <jobs/common/listener.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct BatchProgram;

struct BatchOptions {
    Shard shard = {};
    std::size_t processes = 0;  ///< that work side by side, one thread each; 0: a core each
    /// Bytes for the data of all processes together; 0: no limit. An item that its share does not
    /// suffice for is tried again at the end, alone, with all of it.
    std::size_t memory = 0;
    std::string costs = {};  ///< times.csv of an earlier batch; empty: estimates
    bool force = false;      ///< what is done and valid is done again
    /// After it no item begins, and those at work are finished. None: no end.
    std::optional<double> seconds = {};
};

/// A finished item, or one that was valid, and how far the batch is.
struct BatchEvent {
    const ItemRecord& record;
    bool kept = false;
    std::size_t finished = 0, failed = 0, items = 0;  ///< of this shard
    double seconds = 0, secondsLeft = 0;
};

struct BatchRun {
    Manifest manifest;                      ///< whole; nothing was run if it has mistakes
    std::size_t items = 0;                  ///< of this shard
    std::size_t done = 0;                   ///< now
    std::size_t kept = 0;                   ///< were there and valid
    std::size_t left = 0;                   ///< not begun when the time was over
    std::vector<ItemRecord> failures = {};  ///< sorted by name
    double seconds = 0;
};

/// The items of a shard, as indices, the most costly first. Throws InputError for a table of costs
/// that cannot be read.
std::vector<std::size_t> itemsOfShard(const Manifest& manifest, const BatchProgram& program,
                                      const BatchOptions& options);

/// Makes the items of a manifest, or a shard of them, in `folder`/items/NAME: the result of the
/// command, answer.json (what it prints as JSON) and record.json. Results whose inputs, options
/// and version of the program are as they were are kept. A failed item does not stop the others;
/// the next run tries failed items again, and begins the items that no time was left for. Results
/// do not depend on shards or processes.
///
/// Forks: the process must have no other threads. Throws InputError for a manifest that cannot be
/// read, UsageError, OutputError.
BatchRun runBatch(const std::string& manifest, const std::string& folder,
                  const BatchProgram& program, const BatchOptions& options,
                  const Listener& listener = {},
                  const std::function<void(const BatchEvent&)>& event = {});

}  // namespace hshfit::jobs
