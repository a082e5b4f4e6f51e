#include "command.h"
#include "command_rows.h"
#include "job_options.h"
#include "trade_lighting.h"

#include <hshfit/error.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <jobs/studies/tradeoff.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace hshfit::cli {
namespace {

struct TradeoffArguments {
    std::vector<std::string> specs;
    std::string output;
    jobs::TradeoffOptions options;
    jobs::LightingTradeOptions lighting{.models = {}};  ///< none: forms are measured
};

void runTradeoff(const TradeoffArguments& arguments, Globals& globals) {
    if (!arguments.lighting.models.empty())
        return runTradeLighting(arguments.specs, arguments.lighting, globals);
    if (arguments.output.empty() && !globals.json) {
        throw UsageError("tradeoff: give -o DIR for the files, or --json");
    }
    jobs::TradeoffOptions options = arguments.options;
    tradeoff::TradeoffOptions& measurement = options.measurement;
    if (!globals.quiet)
        measurement.found = [&](const std::string& brdf, const tradeoff::Measured& form,
                                double error) {
            note(globals, fmt::format("{}: so far {}: {} bytes, error {:.3g}", brdf, form.options,
                                      form.bytes, error));
        };
    const jobs::MeasuredTradeoffs measured =
        jobs::measureTradeoffs(arguments.specs, arguments.output, options, listenerFor(globals));
    if (globals.json) {
        printText(tradeoffJson(measured.trades, true));
    } else if (!measured.trades.empty()) {
        std::string text;
        for (const tradeoff::Tradeoff& trade : measured.trades)
            text += tradeoffText(trade, measurement.byTime);
        const char* timing = !measurement.timing ? "" : ", timing.html";
        printText(text + fmt::format("written to {}: tradeoff.html{}, and the figures and tables "
                                     "in them\n",
                                     arguments.output, timing));
    }
    reportFailures(measured.failures, measured.specs.size(), globals);
}

constexpr ArgumentRow tradeoffArguments[] = {
    required("SPEC", at<&TradeoffArguments::specs>,
             "One or more BRDFs; of a folder, the measured files in it", brdfRead),
    optionalOutput(at<&TradeoffArguments::output>, "Folder to write, made if absent",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows tradeoffRows() {
    return {tradeoffArguments,
            {jobs::sweepOptions().rows, jobs::tradeoffOptions().rows,
             jobs::lightingTradeOptions().rows}};
}

void addTradeoff(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<TradeoffArguments>();
    addArguments(command, tradeoffArguments, *arguments);
    addOptions(command, jobs::sweepOptions(), arguments->options.sweep, "What is tried");
    addOptions(command, jobs::tradeoffOptions(), arguments->options);
    addOptions(command, jobs::lightingTradeOptions(), arguments->lighting);
    command.callback([arguments, &globals] { runTradeoff(*arguments, globals); });
}

}  // namespace hshfit::cli
