#include "command.h"

#include <jobs/fits/ltc.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

struct LtcArguments {
    std::string spec, mapping = "square";
    std::vector<std::string> outputs;
    brdfs::LtcTableOptions table;
};

void runLtc(LtcArguments& arguments, const Globals& globals) {
    arguments.table.mapping = jobs::parseMapping(arguments.mapping);
    const jobs::FittedLtc fitted =
        jobs::fitLtc(arguments.spec, arguments.outputs, arguments.table, listenerFor(globals));
    const brdfs::LtcTable& table = fitted.table;
    const auto& summary = fitted.summary;
    if (globals.json) return printJson(jobs::ltcJson(fitted));
    printText(fmt::format(
        "{}: {} x {} over {} from {:.4g} to {:.4g}; cubed lobe error {:.4f}, at most {:.3f}; "
        "{:.2f} % of the light misplaced; {:.0f} s\n",
        fmt::join(fitted.files, ", "), table.size, table.size, table.parameter,
        table.values.front(), table.values.back(), summary.meanError, summary.largestError,
        100 * summary.meanMisplaced, fitted.seconds));
}

}  // namespace

void addLtc(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<LtcArguments>();
    command
        .add_option("MODEL", arguments->spec,
                    "Model, without the parameter that runs over roughness")
        ->required();
    command
        .add_option("-o,--output", arguments->outputs,
                    ".json, or NAME.exr or NAME.dds for NAME_1 and NAME_2; may be repeated")
        ->required()
        ->allow_extra_args(false);
    command.add_option("--size", arguments->table.size, "Cells a side")
        ->check(CLI::Range(2, 1024))
        ->capture_default_str();
    command
        .add_option("--parameter", arguments->table.parameter,
                    "What runs over roughness; several with commas (ax,ay) get the same value")
        ->capture_default_str();
    command
        .add_option("--mapping", arguments->mapping,
                    "Its value for the roughness r of a column: square (r^2), linear (r) or "
                    "exponent (2/r^4 - 2)")
        ->check(CLI::IsMember({"square", "linear", "exponent"}))
        ->capture_default_str();
    command.callback([arguments, &globals] { runLtc(*arguments, globals); });
}

}  // namespace hshfit::cli
