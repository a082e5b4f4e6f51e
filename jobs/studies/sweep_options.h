#pragma once

#include <jobs/common/option_row.h>

#include <hshfit/tradeoff/sweep.h>

#include <cstddef>
#include <string>
#include <vector>

namespace hshfit::jobs {

/// The forms that a trade-off tries, as words; empty: the sweep's own.
struct SweepOptions {
    std::vector<std::string> forms, bases, outgoing, halfway, precisions, splits, windows,
        constraints;
    std::vector<int> orders, ranks;
    std::vector<std::size_t> keep;
    bool cosine = false;

    /// Throws UsageError for a word that none of them is.
    tradeoff::Sweep sweep() const;
};
OptionRows<SweepOptions> sweepOptions();

}  // namespace hshfit::jobs
