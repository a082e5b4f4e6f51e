#pragma once

#include <jobs/common/listener.h>
#include <jobs/common/option_row.h>

#include <brdfs/fit/ltc_table.h>

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hshfit::jobs {

struct FittedLtc {
    brdfs::LtcTable table;
    brdfs::LtcTable::Summary summary = {};
    std::vector<std::string> files = {};
    double seconds = 0;  ///< that the fit took
};

/// Linearly transformed cosines of a model over roughness and elevation (fitLtcTable), written to
/// each of `outputs` as its extension says (writeLtcTable); the files appear together.
/// `options.progress` is not called: the listener is. Throws UsageError, NumericError and
/// OutputError.
FittedLtc fitLtc(const std::string& model, const std::vector<std::string>& outputs,
                 const brdfs::LtcTableOptions& options, const Listener& listener = {});

/// The options of the table.
OptionRows<brdfs::LtcTableOptions> ltcOptions();
/// The answer of the command.
nlohmann::ordered_json ltcJson(const FittedLtc& fitted);

}  // namespace hshfit::jobs
