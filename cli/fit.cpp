#include "command.h"
#include "fit_batch.h"

#include <brdfs/catalog.h>
#include <brdfs/fit/compare_models.h>
#include <brdfs/fit/fit.h>
#include <brdfs/fit/fit_json.h>
#include <brdfs/measured/measured_brdf.h>
#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/pages/comparison.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <ctime>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct FitArguments {
    std::string data, all, model, output, loss = "cosine", robust = "none", weights = "auto";
    double robustScale = 0;
    bool perChannel = false, accept = false, rgb = false;
    int starts = 16, iterations = 200;
    std::uint64_t seed = 1;
    std::vector<std::string> models;  ///< to compare
    brdfs::SampleOptions samples;
};

brdfs::FitOptions optionsOf(const FitArguments& arguments) {
    brdfs::FitOptions options;
    options.model = arguments.model;
    options.loss = brdfs::findLoss(arguments.loss).kind;
    options.robust = brdfs::findRobust(arguments.robust);
    options.robustScale = arguments.robustScale;
    options.perChannel = arguments.perChannel;
    options.starts = arguments.starts;
    options.seed = arguments.seed;
    options.iterations = arguments.iterations;
    return options;
}

brdfs::FitSamples samplesOf(const FitArguments& arguments, const std::string& data) {
    brdfs::SampleOptions options = arguments.samples;
    options.weights = brdfs::findSampleWeights(arguments.weights);
    options.seed = arguments.seed;
    const auto brdf = openSource(data, arguments.rgb);
    brdfs::FitSamples samples = brdfs::gatherSamples(*brdf, options);
    if (const auto* measured = dynamic_cast<const brdfs::MeasuredBrdf*>(brdf.get()))
        measured->checkReadable();
    else
        brdf->checkIntact();
    return samples;
}

std::string text(const brdfs::FitResult& result) {
    std::string lines = fmt::format("{}\n", result.spec);
    for (const brdfs::FittedParameter& p : result.parameters) {
        const std::string error = p.standardError    ? fmt::format("+- {:.3g}", *p.standardError)
                                  : !p.bound.empty() ? fmt::format("at its {} bound", p.bound)
                                                     : "not determined by the data";
        lines += fmt::format("  {:<24} {:>2} {:<14.8g} {}\n", p.name, p.channel, p.value, error);
    }
    for (const auto& set : result.ambiguous)
        lines += fmt::format("  ambiguous together: {}\n", fmt::join(set, ", "));
    lines += fmt::format("  rms residual {:.6g} over {} values, {} iterations, {}\n", result.loss,
                         result.values, result.iterations,
                         result.converged ? "converged" : "NOT CONVERGED");
    return lines;
}

/// Whether `-o` names a folder for a report, and not a preset.
bool isFolder(const std::string& output) {
    return !output.empty() && !output.ends_with(".json");
}

/// Data and fit side by side, as `compare` shows them, in the folder where the fit is.
std::size_t writeReport(const FitArguments& arguments, const std::string& spec,
                        const Globals& globals) {
    const auto data = openSource(arguments.data, arguments.rgb);
    const auto fitted = brdfs::open(spec);
    Progress progress(globals, "report");
    ComparisonOptions options;
    options.progress = options.sphere.progress = progress.callback();
    return writeComparison(*data, *fitted, options, arguments.output).size();
}

/// Fits one file. Throws NumericError if it did not converge and that is not accepted.
Json fitOne(const FitArguments& arguments, const std::string& data, const std::string& output,
            const Globals& globals, std::string& answer) {
    brdfs::FitOptions options = optionsOf(arguments);
    const brdfs::FitSamples samples = samplesOf(arguments, data);
    Progress progress(globals, "fit");
    options.progress = progress.callback();
    const brdfs::FitResult result = brdfs::fit(samples, options);
    if (!result.converged && !arguments.accept)
        throw NumericError(
            fmt::format("{}: the fit of {} did not converge ({}); --accept takes it as it is", data,
                        arguments.model, result.message));
    Json preset = brdfs::fitPreset({data, &samples, options, result});
    answer = text(result);
    if (isFolder(output)) {
        const std::size_t files = writeReport(arguments, result.spec, globals);
        writeFile(output + "/fit.json", preset.dump(2) + "\n");
        answer += fmt::format("written to {}: fit.json, comparison.html and {} files beside it\n",
                              output, files - 1);
    } else if (!output.empty()) {
        writeFile(output, preset.dump(2) + "\n");
    }
    return preset;
}

void runAll(const FitArguments& arguments, Globals& globals) {
    if (arguments.output.empty())
        throw UsageError("fit --all: give -o DIR, the folder for the results");
    Globals inner = globals;
    inner.quiet = true;
    Progress progress(globals, "files");
    const BatchOutcome outcome = fitFolder(
        arguments.all, arguments.output,
        [&](const std::string& file, const std::string& result) {
            std::string ignored;
            fitOne(arguments, file, result, inner, ignored);
        },
        progress.callback());
    Json failures = Json::array();
    std::string lines = fmt::format("{} fitted, {} were there, {} failed\n", outcome.fitted,
                                    outcome.kept, outcome.failures.size());
    for (const auto& [file, reason] : outcome.failures) {
        failures.push_back({{"file", file}, {"reason", reason}});
        lines += reason.starts_with(file) ? fmt::format("  {}\n", reason)
                                          : fmt::format("  {}: {}\n", file, reason);
    }
    if (!outcome.failures.empty()) globals.exitCode = static_cast<int>(ExitCode::numeric);
    if (!globals.json) return printText(lines);
    printJson({{"format", "hshfit-fit-all"},
               {"version", 1},
               {"fitted", outcome.fitted},
               {"kept", outcome.kept},
               {"failures", failures}});
}

void runCompareModels(const FitArguments& arguments, Globals& globals) {
    const brdfs::FitSamples samples = samplesOf(arguments, arguments.data);
    const auto ranks = brdfs::compareModels(samples, arguments.models, optionsOf(arguments));
    Json list = Json::array();
    std::string lines = fmt::format("  {:<28} {:>3} {:>12} {:>12} {:>12} {:>12}\n", "model", "p",
                                    "held out", "rms", "AIC", "BIC");
    for (const brdfs::ModelRank& rank : ranks) {
        if (!rank.failure.empty()) {
            list.push_back({{"model", rank.model}, {"failure", rank.failure}});
            lines += fmt::format("  {:<28} {}\n", rank.model, rank.failure);
            continue;
        }
        const brdfs::FitResult& fit = rank.fit;
        list.push_back({{"model", rank.model},
                        {"spec", fit.spec},
                        {"parameters", fit.parameters.size()},
                        {"held_out_rms", rank.heldOut},
                        {"rms", fit.loss},
                        {"aic", fit.aic},
                        {"bic", fit.bic},
                        {"converged", fit.converged}});
        lines += fmt::format("  {:<28} {:>3} {:>12.6g} {:>12.6g} {:>12.8g} {:>12.8g}{}\n",
                             rank.model, fit.parameters.size(), rank.heldOut, fit.loss, fit.aic,
                             fit.bic, fit.converged ? "" : "  not converged");
        if (!fit.converged && !arguments.accept)
            globals.exitCode = static_cast<int>(ExitCode::numeric);
    }
    const Json document = {{"format", "hshfit-fit-models"},
                           {"version", 1},
                           {"data", arguments.data},
                           {"loss", arguments.loss},
                           {"models", list}};
    if (!arguments.output.empty()) writeFile(arguments.output, document.dump(2) + "\n");
    if (globals.json)
        printJson(document);
    else
        printText(lines);
}

void runFit(const FitArguments& arguments, Globals& globals) {
    if (arguments.data.empty() == arguments.all.empty())
        throw UsageError("fit: give either DATA or --all DIR");
    if (arguments.model.empty() == arguments.models.empty())
        throw UsageError("fit: give either --model or --compare-models");
    if (!arguments.all.empty()) {
        if (arguments.model.empty()) throw UsageError("fit --all: takes one --model");
        return runAll(arguments, globals);
    }
    if (!arguments.models.empty()) return runCompareModels(arguments, globals);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpuStart = std::clock();
    std::string answer;
    Json preset = fitOne(arguments, arguments.data, arguments.output, globals, answer);
    if (!globals.json) return printText(answer);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    preset["time"] = {
        {"seconds", elapsed.count()},
        {"cpu_seconds", static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC}};
    printJson(preset);
}

}  // namespace

void addFit(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<FitArguments>();
    command.add_option("DATA", arguments->data, "BRDF or coefficient file");
    command.add_option(
        "--all", arguments->all,
        "Fit every file of a folder; -o DIR takes one result each; what stands there "
        "is not fitted again");
    command.add_option("--model", arguments->model,
                       "MODEL[:key=value,...][+MODEL...]: what is given is not fitted");
    command.add_option("--compare-models", arguments->models,
                       "Fit each of these models and rank them by held-out directions");
    command.add_option("-o,--output", arguments->output,
                       "Where the fit goes: a preset (.json), or a folder for a report as well");
    command.add_option("--loss", arguments->loss, "l2, cosine, log, cube-root or log-relative")
        ->capture_default_str();
    command.add_option("--robust", arguments->robust, "none, huber or cauchy")
        ->capture_default_str();
    command
        .add_option("--robust-scale", arguments->robustScale,
                    "Residual at which it sets in; 0: from the residuals' spread")
        ->check(CLI::Range(0.0, 1e300));
    command.add_flag("--per-channel", arguments->perChannel,
                     "Shapes of their own for each channel");
    command.add_option("--weights", arguments->weights, "auto, equal or solid-angle")
        ->capture_default_str();
    command
        .add_option("--grazing-cut", arguments->samples.grazingCut,
                    "Leave out samples with a polar angle above this, degrees")
        ->check(CLI::Range(0.0, 90.0));
    command.add_option("--samples", arguments->samples.most, "Draw so many samples; 0: all");
    command.add_option("--starts", arguments->starts, "Local searches")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    command.add_option("--iterations", arguments->iterations, "At most so many in the last search")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command.add_option("--seed", arguments->seed, "Of starts and drawn samples")
        ->capture_default_str();
    command.add_flag("--accept", arguments->accept, "Take a fit that did not converge");
    addRgb(command, arguments->rgb);
    command.callback([arguments, &globals] { runFit(*arguments, globals); });
}

}  // namespace hshfit::cli
