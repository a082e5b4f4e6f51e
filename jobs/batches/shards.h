#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

/// The share of a batch that one process takes: number `index` of `count`, from 1.
struct Shard {
    std::size_t index = 1, count = 1;
    std::string origin = {};  ///< the engine whose environment states it; empty: none

    bool operator==(const Shard& other) const {
        return index == other.index && count == other.count;
    }
};

/// The shard of "K/N", K from 1 to N, or of "/N" with K from the environment. Without a text it is
/// what the environment states, or the whole. Throws UsageError.
///
/// The environment: an array of Slurm (SLURM_ARRAY_TASK_ID, _MIN, _STEP, _COUNT), an indexed job of
/// Kubernetes (JOB_COMPLETION_INDEX, from 0, whose count has to be stated), processes of Open MPI
/// (OMPI_COMM_WORLD_RANK, _SIZE). An array of MPI jobs multiplies the two.
Shard shardOf(std::string_view text);

/// The shard of each item, from 0, for `count` shards: the same on every machine, since it depends
/// on costs and texts alone. Items in order of falling cost, ties by their texts, each go to the
/// shard with the least sum so far (longest processing time first; R. L. Graham, Bounds on
/// Multiprocessing Timing Anomalies, SIAM J. Appl. Math. 17, 1969): the largest sum is at most
/// 4/3 - 1/(3 count) of the best possible one. Items of equal cost whose texts are neighbours go to
/// different shards, so that what the costs do not know spreads evenly over them.
std::vector<std::uint32_t> assignShards(std::span<const double> costs,
                                        std::span<const std::string> texts, std::size_t count);

}  // namespace hshfit::jobs
