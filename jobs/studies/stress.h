#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <hshfit/stability/stress.h>

#include <brdfs/random_cases.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct StressOptions {
    /// BRDFs to project; none: Lambert, and Phong, GGX and Ward from broad lobes to a mirror.
    std::vector<std::string> lobes = {};
    std::string bases = "all";  ///< or names, separated by commas
    int maxOrder = stability::StressOptions{}.maxOrder;
    /// Random projections over the catalog whose stated errors are tried; none: 2000, or 0 where
    /// lobes are given.
    std::optional<std::size_t> trials = {};
    std::uint64_t seed = brdfs::RandomCasesOptions{}.seed;  ///< of the random projections
    double tolerance = 0;              ///< of the random projections; 0: each BRDF's own
    std::vector<std::string> of = {};  ///< models and formats whose projections are kept; all
};
OptionRows<StressOptions> stressOptions();

/// The accuracy of each computation by degree, order and width, with its files in the folder
/// `output` (stability::writeStress) unless that is empty. Throws UsageError, InputError and
/// OutputError.
stability::StressReport stress(const std::string& output, const StressOptions& options,
                               const Listener& listener = {});

}  // namespace hshfit::jobs
