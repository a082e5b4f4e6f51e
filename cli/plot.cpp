#include "command.h"
#include "within.h"

#include <jobs/studies/plot.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace hshfit::cli {
namespace {

struct PlotArguments {
    std::string basis, output;
    bool sphere = false;
    jobs::PlotOptions options;
};

void runPlot(PlotArguments& arguments, const Globals& globals) {
    arguments.options.domain = arguments.sphere ? FigureDomain::sphere : FigureDomain::hemisphere;
    const jobs::Plotted plotted = jobs::plot(arguments.basis, arguments.output, arguments.options);
    if (globals.json) {
        printJson({{"format", "hshfit-plot"},
                   {"version", 1},
                   {"output", arguments.output},
                   {"basis", plotted.basis},
                   {"order", plotted.order},
                   {"domain", arguments.sphere ? "sphere" : "hemisphere"},
                   {"functions", plotted.functions}});
    } else {
        printText(fmt::format("{}: {} functions of {}, order {}\n", arguments.output,
                              plotted.functions, plotted.basis, plotted.order));
    }
}

}  // namespace

void addPlot(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<PlotArguments>();
    command.add_option("BASIS", arguments->basis, "A basis of hshfit list bases")->required();
    command.add_option("-o,--output", arguments->output, "Figure to write: .png, .svg or .pdf")
        ->required();
    command.add_option("--order", arguments->options.order, "Bands to draw")
        ->check(within(jobs::bounds::plotOrder))
        ->capture_default_str();
    command.add_flag("--sphere", arguments->sphere,
                     "The whole sphere, for sh and esh (default: the hemisphere)");
    command.add_flag("--condon-shortley", arguments->options.condonShortley,
                     "Functions of odd m times -1, as both source papers have them");
    command.callback([arguments, &globals] { runPlot(*arguments, globals); });
}

}  // namespace hshfit::cli
