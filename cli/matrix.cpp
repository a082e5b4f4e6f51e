#include "command.h"
#include "rotation_options.h"
#include "within.h"

#include <jobs/lighting/rotate.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct MatrixArguments {
    std::string from, to, euler, weight;
    int order = 3, fromOrder = 0;
    bool condonShortley = false;
};

void runMatrix(const MatrixArguments& arguments, const Globals& globals) {
    jobs::MatrixOptions options{
        .from = arguments.from,
        .to = arguments.to,
        .fromOrder = arguments.fromOrder == 0 ? arguments.order : arguments.fromOrder,
        .toOrder = arguments.order,
        .condonShortley = arguments.condonShortley};
    if (arguments.weight == "cosine") options.weight = Basis::Inner::projectedSolidAngle;
    if (arguments.weight == "solid-angle") options.weight = Basis::Inner::solidAngle;
    if (!arguments.euler.empty()) options.rotation = parseEuler(arguments.euler);
    const auto rows = jobs::matrix(options);
    if (globals.json) {
        Json document = {{"format", "hshfit-matrix"},
                         {"version", 1},
                         {"from", {{"basis", options.from}, {"order", options.fromOrder}}},
                         {"to", {{"basis", options.to}, {"order", options.toOrder}}}};
        if (!arguments.euler.empty())
            document["euler"] = parseNumbers(arguments.euler, 3, "--euler", "A,B,C");
        document["condon_shortley"] = arguments.condonShortley;
        if (!arguments.weight.empty()) document["weight"] = arguments.weight;
        document["matrix"] = rows;
        printJson(document);
        return;
    }
    std::string text;
    for (const auto& row : rows) {
        for (const double entry : row) {
            // Numbers that print as 0 have no sign.
            text += fmt::format("{:10.6f}", std::abs(entry) < 5e-7 ? 0 : entry);
        }
        text += "\n";
    }
    printText(text);
}

}  // namespace

void addMatrix(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<MatrixArguments>();
    command.add_option("FROM", arguments->from, "Basis of the columns (hshfit list bases)")
        ->required();
    command.add_option("TO", arguments->to, "Basis of the rows")->required();
    command.add_option("--order", arguments->order, "Bands of TO")
        ->check(within(jobs::bounds::matrixOrder))
        ->capture_default_str();
    command
        .add_option("--from-order", arguments->fromOrder, "Bands of FROM (default: those of TO)")
        ->check(within(jobs::bounds::matrixOrder));
    command.add_option("--euler", arguments->euler,
                       "A,B,C in degrees: of the rotated function, R_z(A) R_y(B) R_z(C)");
    command.add_flag("--condon-shortley", arguments->condonShortley,
                     "Give functions of odd m the Condon-Shortley sign, in both bases");
    command
        .add_option("--weight", arguments->weight,
                    "Of the integral: solid-angle or cosine (default: that of the basis TO)")
        ->check(CLI::IsMember({"solid-angle", "cosine"}));
    command.callback([arguments, &globals] { runMatrix(*arguments, globals); });
}

}  // namespace hshfit::cli
