#include "ltc.h"

#include <jobs/common/clock.h>
#include <jobs/common/enum_words.h>

#include <brdfs/fit/ltc_files.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hshfit::jobs {
namespace {

constexpr EnumWord mappings[] = {{"square", "r^2"}, {"linear", "r"}, {"exponent", "2/r^4 - 2"}};
using Mappings = EnumWords<mappings, brdfs::RoughnessMapping>;

using options::at;

constexpr OptionRow ltcRows[] = {
    OptionRow{"size", at<&brdfs::LtcTableOptions::size>, "Cells a side"}.within(
        Bounds<int>{2, 1024}),
    OptionRow{"parameter", at<&brdfs::LtcTableOptions::parameter>,
              "What runs over roughness; several with commas (ax,ay) get the same value"},
    OptionRow{"mapping",
              options::spelled<Mappings::parse, Mappings::name, &brdfs::LtcTableOptions::mapping>,
              "Its value for the roughness r of a column: square (r^2), linear (r) or exponent "
              "(2/r^4 - 2)"}
        .takes({.words = Mappings::words, .complete = true}),
};

}  // namespace

OptionRows<brdfs::LtcTableOptions> ltcOptions() {
    return {ltcRows};
}

FittedLtc fitLtc(const std::string& model, const std::vector<std::string>& outputs,
                 const brdfs::LtcTableOptions& options, const Listener& listener) {
    for (const std::string& output : outputs) brdfs::ltcOutputs(output);
    const auto start = Clock::now();
    brdfs::LtcTableOptions how = options;
    how.progress = listener.part("ltc");
    FittedLtc result{.table = brdfs::fitLtcTable(model, how)};
    result.seconds = secondsSince(start);

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

nlohmann::ordered_json ltcJson(const FittedLtc& fitted) {
    const auto& summary = fitted.summary;
    return {{"format", "hshfit-ltc-answer"},
            {"version", 1},
            {"brdf", fitted.table.spec},
            {"parameter", fitted.table.parameter},
            {"size", fitted.table.size},
            {"outputs", fitted.files},
            {"mean_error", summary.meanError},
            {"largest_error", summary.largestError},
            {"mean_misplaced", summary.meanMisplaced},
            {"largest_uncertainty", summary.largestUncertainty},
            {"unsettled", summary.unsettled},
            {"seconds", fitted.seconds}};
}

}  // namespace hshfit::jobs
