#include "command.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/pages/basis_figure.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

struct PlotArguments {
    std::string basis, output;
    int order = 4;
    bool sphere = false, condonShortley = false;
};

void runPlot(const PlotArguments& arguments, Globals& globals) {
    const bases::Entry& entry = bases::find(arguments.basis);
    const int order = std::min(arguments.order, entry.maxOrder);
    const auto basis = bases::make(entry.name, order, {.condonShortley = arguments.condonShortley});
    const FigureDomain domain = arguments.sphere ? FigureDomain::sphere : FigureDomain::hemisphere;
    writeBasisFigure(*basis, domain, arguments.output);
    const int functions = basis->functionCount(order);
    if (globals.json) {
        printJson({{"format", "hshfit-plot"},
                   {"version", 1},
                   {"output", arguments.output},
                   {"basis", basis->name()},
                   {"order", order},
                   {"domain", arguments.sphere ? "sphere" : "hemisphere"},
                   {"functions", functions}});
    } else {
        printText(fmt::format("{}: {} functions of {}, order {}\n", arguments.output, functions,
                              basis->name(), order));
    }
}

}  // namespace

void addPlot(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<PlotArguments>();
    command.add_option("BASIS", arguments->basis, "A basis of hshfit list bases")->required();
    command.add_option("-o,--output", arguments->output, "Figure to write: .png, .svg or .pdf")
        ->required();
    command.add_option("--order", arguments->order, "Bands to draw")
        ->check(CLI::Range(1, 8))
        ->capture_default_str();
    command.add_flag("--sphere", arguments->sphere,
                     "The whole sphere, for sh and esh (default: the hemisphere)");
    command.add_flag("--condon-shortley", arguments->condonShortley,
                     "Functions of odd m times -1, as both source papers have them");
    command.callback([arguments, &globals] { runPlot(*arguments, globals); });
}

}  // namespace hshfit::cli
