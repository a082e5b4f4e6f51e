#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <hshfit/percent.h>

#include <jobs/common/option_words.h>
#include <jobs/fits/ltc.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

struct LtcArguments {
    std::string spec;
    std::vector<std::string> outputs;
    brdfs::LtcTableOptions table;
};

void runLtc(const LtcArguments& arguments, const Globals& globals) {
    const jobs::FittedLtc fitted =
        jobs::fitLtc(arguments.spec, arguments.outputs, arguments.table, listenerFor(globals));
    const brdfs::LtcTable& table = fitted.table;
    const auto& summary = fitted.summary;
    if (globals.json) return printJson(jobs::ltcJson(fitted));
    const double misplaced =
        std::ranges::max_element(table.cells, {}, &brdfs::LtcLobe::misplaced)->misplaced;
    printText(fmt::format(
        "{}: {} x {} over {} from {:.4g} to {:.4g}; cubed lobe error {:.4f}, at most {:.3f}; "
        "{} of the light misplaced, at most {}; {:.0f} s\n",
        fmt::join(fitted.files, ", "), table.size, table.size, table.parameter,
        table.values.front(), table.values.back(), summary.meanError, summary.largestError,
        percent(summary.meanMisplaced), percent(misplaced), fitted.seconds));
}

constexpr ArgumentRow ltcArguments[] = {
    required("MODEL", at<&LtcArguments::spec>,
             "Model, without the parameter that runs over roughness", {.words = jobs::modelWords}),
    requiredOutput(at<&LtcArguments::outputs>,
                   ".json, or NAME.exr or NAME.dds for NAME_1 and NAME_2; may be repeated",
                   jsonWritten),
};

}  // namespace

CommandRows ltcRows() {
    return {ltcArguments, {jobs::ltcOptions().rows}};
}

void addLtc(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<LtcArguments>();
    addArguments(command, ltcArguments, *arguments);
    addOptions(command, jobs::ltcOptions(), arguments->table);
    command.callback([arguments, &globals] { runLtc(*arguments, globals); });
}

}  // namespace hshfit::cli
