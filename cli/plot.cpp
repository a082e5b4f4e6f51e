#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <jobs/common/option_words.h>
#include <jobs/studies/plot.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

struct PlotArguments {
    std::string basis, output;
    jobs::PlotOptions options;
};

void runPlot(const PlotArguments& arguments, const Globals& globals) {
    const jobs::Plotted plotted = jobs::plot(arguments.basis, arguments.output, arguments.options);
    if (globals.json) {
        printJson({{"format", "hshfit-plot"},
                   {"version", 1},
                   {"output", arguments.output},
                   {"basis", plotted.basis},
                   {"order", plotted.order},
                   {"domain", arguments.options.sphere ? "sphere" : "hemisphere"},
                   {"functions", plotted.functions}});
    } else {
        printText(fmt::format("{}: {} functions of {}, order {}\n", arguments.output,
                              plotted.functions, plotted.basis, plotted.order));
    }
}

constexpr ArgumentRow plotArguments[] = {
    required("BASIS", at<&PlotArguments::basis>, "A basis of hshfit list bases",
             {.words = jobs::basisWords}),
    requiredOutput(at<&PlotArguments::output>, "Figure to write: .png, .svg or .pdf",
                   {.files = Files::written}),
};

}  // namespace

CommandRows plotRows() {
    return {plotArguments, {jobs::plotOptions().rows}};
}

void addPlot(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<PlotArguments>();
    addArguments(command, plotArguments, *arguments);
    addOptions(command, jobs::plotOptions(), arguments->options);
    command.callback([arguments, &globals] { runPlot(*arguments, globals); });
}

}  // namespace hshfit::cli
