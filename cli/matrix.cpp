#include "command.h"
#include "command_rows.h"
#include "job_options.h"

#include <jobs/common/option_words.h>
#include <jobs/lighting/rotate.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

void runMatrix(const jobs::MatrixOptions& options, const Globals& globals) {
    const auto rows = jobs::matrix(options);
    if (globals.json) {
        Json document = {{"format", "hshfit-matrix"},
                         {"version", 1},
                         {"from", {{"basis", options.from}, {"order", options.orderOfFrom()}}},
                         {"to", {{"basis", options.to}, {"order", options.order}}}};
        if (options.euler)
            document["euler"] = {options.euler->a, options.euler->b, options.euler->c};
        document["condon_shortley"] = options.condonShortley;
        if (options.weight) document["weight"] = jobs::weightName(*options.weight);
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

constexpr ArgumentRow matrixArguments[] = {
    required("FROM", at<&jobs::MatrixOptions::from>, "Basis of the columns (hshfit list bases)",
             {.words = jobs::basisWords}),
    required("TO", at<&jobs::MatrixOptions::to>, "Basis of the rows", {.words = jobs::basisWords}),
};

}  // namespace

CommandRows matrixRows() {
    return {matrixArguments, {jobs::matrixOptions().rows}};
}

void addMatrix(CLI::App& command, Globals& globals) {
    auto options = std::make_shared<jobs::MatrixOptions>();
    addArguments(command, matrixArguments, *options);
    addOptions(command, jobs::matrixOptions(), *options);
    command.callback([options, &globals] { runMatrix(*options, globals); });
}

}  // namespace hshfit::cli
