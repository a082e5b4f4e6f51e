#include "command.h"

#include <hshfit/error.h>

#include <brdfs/measured/merl_writer.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace hshfit::cli {
namespace {

struct ConvertOptions {
    std::string input, output;
    bool force = false;
};

void runConvert(const ConvertOptions& options, const Globals& globals) {
    const std::filesystem::path path(options.output);
    if (path.extension() != ".binary") {
        throw UsageError(
            fmt::format("{}: the formats that can be written are told by extension: .binary (MERL)",
                        options.output));
    }
    const auto brdf = openSource(options.input);
    brdfs::writeMerl(*brdf, options.output, {.force = options.force});
    brdf->checkIntact();
    const auto bytes = std::filesystem::file_size(path);
    if (globals.json) {
        printJson({{"format", "hshfit-convert"},
                   {"version", 1},
                   {"input", brdf->name()},
                   {"output", options.output},
                   {"bytes", bytes}});
    } else {
        printText(fmt::format("{}: {} bytes\n", options.output, bytes));
    }
}

}  // namespace

void addConvert(CLI::App& app, Globals& globals) {
    auto options = std::make_shared<ConvertOptions>();
    CLI::App& command =
        addCommand(app, globals, "convert", "Write a BRDF in a measured-data format (MERL .binary)",
                   "hshfit convert ggx:alpha=.3,f0=.9 ggx.binary");
    command.add_option("IN", options->input, "BRDF, measured file or coefficient file")->required();
    command.add_option("OUT", options->output, "File to write; its extension names the format")
        ->required();
    command.add_flag("--force", options->force, "Replace an existing file");
    command.callback([options, &globals] { runConvert(*options, globals); });
}

}  // namespace hshfit::cli
