#include "command.h"
#include "documents.h"

#include <hshfit/error.h>

#include <jobs/studies/eval.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>

namespace hshfit::cli {
namespace {

struct EvalArguments {
    std::string spec, wi, wo, pairs, output;
    jobs::EvalOptions options;
};

nlohmann::ordered_json factsJson(const jobs::Evaluated& found, const jobs::EvalOptions& options) {
    nlohmann::ordered_json answer = {{"format", "hshfit-eval"},
                                     {"version", 1},
                                     {"brdf", found.brdf},
                                     {"cosine", options.cosine},
                                     {"channels", found.channels}};
    if (!found.side.empty()) answer["side"] = found.side;
    return answer;
}

void evaluateOne(const EvalArguments& arguments, const Globals& globals) {
    const Direction wi = parseDirection(arguments.wi, "--wi");
    const Direction wo = parseDirection(arguments.wo, "--wo", 180);
    const jobs::Evaluated found =
        jobs::evaluatePair(arguments.spec, wi, wo, arguments.options, listenerFor(globals));
    if (found.side.empty()) parseDirection(arguments.wo, "--wo");  // of a reflection, to 90
    if (globals.json) {
        auto answer = factsJson(found, arguments.options);
        answer["wi"] = directionJson(wi);
        answer["wo"] = directionJson(wo);
        answer["values"] = found.values;
        return printJson(answer);
    }
    if (!found.side.empty())
        note(globals, fmt::format("{}: f of {}, wo below the surface", found.brdf, found.side));
    std::string text;
    for (std::size_t c = 0; c < found.values.size(); ++c) {
        text += fmt::format("{}\t{}\n", found.channels[c], found.values[c]);
    }
    printText(text);
}

void evaluateAll(const EvalArguments& arguments, const Globals& globals) {
    const jobs::EvaluatedPairs found = jobs::evaluatePairs(
        arguments.spec, arguments.pairs, arguments.output, arguments.options, listenerFor(globals));
    if (!globals.json) {
        if (arguments.output.empty()) printText(found.csv);
        return;
    }
    auto answer = factsJson(found.facts, arguments.options);
    answer["pairs"] = found.count;
    if (arguments.output.empty()) {
        answer["values"] = found.facts.values;
    } else {
        answer["output"] = arguments.output;
    }
    printJson(answer);
}

}  // namespace

void addEval(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<EvalArguments>();
    command.add_option("SPEC", arguments->spec, "BRDF or coefficient file")->required();
    auto* wi = command.add_option("--wi", arguments->wi, "Incoming direction THETA,PHI, degrees");
    auto* wo = command.add_option(
        "--wo", arguments->wo,
        "Outgoing direction THETA,PHI, degrees; of a transmission, theta from 90 to 180");
    auto* pairs = command.add_option(
        "--pairs", arguments->pairs,
        "CSV of direction pairs: columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z; others are ignored");
    command.add_option("-o,--output", arguments->output, "CSV to write (default: standard output)")
        ->needs(pairs);
    addRgb(command, arguments->options.rgb);
    command.add_flag("--cosine", arguments->options.cosine, "Print f cos(theta_i) instead of f");
    wi->needs(wo)->excludes(pairs);
    wo->needs(wi)->excludes(pairs);
    command.callback([arguments, &globals] {
        if (!arguments->pairs.empty()) return evaluateAll(*arguments, globals);
        if (arguments->wi.empty()) throw UsageError("eval: give --wi and --wo, or --pairs");
        evaluateOne(*arguments, globals);
    });
}

}  // namespace hshfit::cli
