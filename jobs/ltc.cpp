#include "ltc.h"

#include <brdfs/fit/ltc_files.h>

#include <fmt/format.h>

#include <chrono>

namespace hshfit::jobs {

FittedLtc fitLtc(const std::string& model, const std::vector<std::string>& outputs,
                 const brdfs::LtcTableOptions& options, const Listener& listener) {
    for (const std::string& output : outputs) brdfs::ltcOutputs(output);
    const auto start = std::chrono::steady_clock::now();
    brdfs::LtcTableOptions how = options;
    how.progress = listener.part("ltc");
    FittedLtc result{.table = brdfs::fitLtcTable(model, how)};
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    FileSet files(".", true);
    for (const std::string& output : outputs)
        for (const std::string& path : brdfs::writeLtcTable(result.table, output, files))
            result.files.push_back(path);
    files.commit();

    result.summary = result.table.summary();
    if (result.summary.unsettled > 0)
        listener.say(fmt::format("{} of {} fits ended before they had settled",
                                 result.summary.unsettled, result.table.cells.size()));
    return result;
}

}  // namespace hshfit::jobs
