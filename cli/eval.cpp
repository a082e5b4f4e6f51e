#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"

#include <jobs/studies/eval.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <memory>

namespace hshfit::cli {
namespace {

struct EvalArguments {
    std::string spec, output;
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
    const jobs::Evaluated found =
        jobs::evaluatePair(arguments.spec, arguments.options, listenerFor(globals));
    if (globals.json) {
        auto answer = factsJson(found, arguments.options);
        answer["wi"] = directionJson(arguments.options.wi->direction());
        answer["wo"] = directionJson(arguments.options.wo->direction());
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
    const jobs::EvaluatedPairs found = jobs::evaluatePairs(arguments.spec, arguments.output,
                                                           arguments.options, listenerFor(globals));
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

constexpr ArgumentRow evalArguments[] = {
    required("SPEC", at<&EvalArguments::spec>, "BRDF or coefficient file", brdfRead),
    {optionalOutput(at<&EvalArguments::output>, "CSV to write (default: standard output)",
                    {.files = Files::written, .dash = ".csv"})
         .row.with("pairs")},
};

}  // namespace

CommandRows evalRows() {
    return {evalArguments, {jobs::evalOptions().rows}};
}

void addEval(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<EvalArguments>();
    addOptions(command, jobs::evalOptions(), arguments->options);
    addArguments(command, evalArguments, *arguments);
    command.callback([arguments, &globals] {
        if (arguments->options.pairs.empty())
            evaluateOne(*arguments, globals);
        else
            evaluateAll(*arguments, globals);
    });
}

}  // namespace hshfit::cli
