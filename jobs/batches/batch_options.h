#pragma once

#include "run.h"
#include "table.h"

#include <jobs/common/option_row.h>

#include <string>

namespace hshfit::jobs {

/// A batch as it is asked for: by default its items are made.
struct BatchRequest {
    std::string shard = {};     ///< shardOf
    std::string progress = {};  ///< file for a line of each item; empty: none
    bool check = false;         ///< look at the manifest alone
    bool list = false;          ///< and name the items
    bool status = false;        ///< count what is made
    bool merge = false;         ///< and write the table
    BatchOptions run = {};      ///< its shard is `shard`
    MergeOptions merging = {};
};
OptionRows<BatchRequest> batchOptions();

}  // namespace hshfit::jobs
