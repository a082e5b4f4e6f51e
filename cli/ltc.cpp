#include "command.h"

#include <jobs/ltc.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <map>

namespace hshfit::cli {
namespace {

struct LtcArguments {
    std::string spec, mapping = "square";
    std::vector<std::string> outputs;
    brdfs::LtcTableOptions table;
};

const std::map<std::string, brdfs::RoughnessMapping> mappings{
    {"square", brdfs::RoughnessMapping::square},
    {"linear", brdfs::RoughnessMapping::linear},
    {"exponent", brdfs::RoughnessMapping::exponent}};

void runLtc(LtcArguments& arguments, const Globals& globals) {
    arguments.table.mapping = mappings.at(arguments.mapping);
    const jobs::FittedLtc fitted =
        jobs::fitLtc(arguments.spec, arguments.outputs, arguments.table, listenerFor(globals));
    const brdfs::LtcTable& table = fitted.table;
    const auto& summary = fitted.summary;
    if (globals.json) {
        printJson({{"format", "hshfit-ltc-answer"},
                   {"version", 1},
                   {"brdf", table.spec},
                   {"parameter", table.parameter},
                   {"size", table.size},
                   {"outputs", fitted.files},
                   {"mean_error", summary.meanError},
                   {"largest_error", summary.largestError},
                   {"mean_misplaced", summary.meanMisplaced},
                   {"largest_uncertainty", summary.largestUncertainty},
                   {"unsettled", summary.unsettled},
                   {"seconds", fitted.seconds}});
        return;
    }
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
