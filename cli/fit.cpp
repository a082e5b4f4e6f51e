#include "command.h"
#include "command_rows.h"
#include "figure_lines.h"
#include "fit_instrument.h"
#include "fit_uncertainty.h"
#include "job_options.h"
#include "measured_numbers.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/output_rule.h>
#include <hshfit/percent.h>

#include <jobs/common/option_words.h>
#include <jobs/fits/fit.h>
#include <jobs/fits/fit_tables.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <chrono>
#include <ctime>
#include <map>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct FitArguments {
    std::string data, all, output;
    std::vector<std::string> models;  ///< to compare
    jobs::FigureArguments figures;
    jobs::FitOptions options;
};

/// The samples of the fit, from the fields of its preset.
std::string samplesLine(const Json& fit) {
    const std::map<std::string, std::string> kinds{
        {"cells", "cells of the table"},
        {"measured", "measured samples"},
        {"nodes", "nodes at which f was evaluated"},
        {"pixels", "pixels of spheres under five lights"}};
    const std::map<std::string, std::string> weights{{"equal", "equally"},
                                                     {"solid-angle", "by solid angle"},
                                                     {"sigma", "by their stated uncertainties"},
                                                     {"area", "by area"}};
    return fmt::format("  fitted to {} {}, weighted {}\n", fit["samples"].get<std::size_t>(),
                       kinds.at(fit["samples_of"]), weights.at(fit["weights"]));
}

/// The parameters that were not fitted, if the model was given with them or they are not at their
/// defaults; empty where there are none.
std::string heldLine(const Json& held) {
    std::vector<std::string> texts;
    for (const Json& own : held) {
        const Json& value = own["value"];
        const auto name = own["name"].get<std::string>();
        if (own.contains("default") && !own.contains("stated")) continue;
        if (value.is_string())
            texts.push_back(fmt::format("{} = {}", name, value.get<std::string>()));
        else
            texts.push_back(
                fmt::format("{} = {:.6g}", name,
                            fmt::join(value.is_array() ? value.get<std::vector<double>>()
                                                       : std::vector{value.get<double>()},
                                      "/")));
    }
    return texts.empty() ? "" : fmt::format("  held: {}\n", fmt::join(texts, ", "));
}

/// The fit in one line: its specification, or its range of wavelengths.
std::string headLine(const brdfs::FitResult& result) {
    if (result.spectrum.empty()) return withShortNumbers(result.spec) + "\n";
    return fmt::format("{} at {} wavelengths from {} to {} nm\n", result.model,
                       result.spectrum.size(), result.spectrum.front().nanometres,
                       result.spectrum.back().nanometres);
}

std::string text(const jobs::Fitted& fitted, const FitArguments& arguments) {
    const brdfs::FitResult& result = fitted.result;
    std::string lines = headLine(result) + samplesLine(fitted.preset["fit"]);
    for (const brdfs::FittedParameter& p : result.parameters) {
        if (p.isScanScale()) continue;
        const std::string value = p.standardError ? withError(p.value, *p.standardError)
                                  : !p.bound.empty()
                                      ? fmt::format("{:.6g}, at its {} bound", p.value, p.bound)
                                      : fmt::format("{:.6g}, not determined by the data", p.value);
        lines += fmt::format("  {:<24} {:>2} {}\n", p.name, p.channel, value);
    }
    lines += heldLine(fitted.preset["fit"]["held"]);
    lines += instrumentText(result);
    if (fitted.search) lines += brdfs::textOf(*fitted.search);
    for (const std::string& set : jobs::notToldApart(result))
        lines += fmt::format("  ambiguous together: {}\n", set);
    lines += fmt::format("  rms residual {:.6g} over {} values, {} iterations, {}\n", result.loss,
                         result.values, result.iterations,
                         result.converged ? "converged" : "NOT CONVERGED");
    lines +=
        fmt::format("  explains {} of the data by the loss {}; relative error of f cos {}\n",
                    percent(fitted.explained, 4), fitted.preset["fit"]["loss"].get<std::string>(),
                    percent(fitted.relativeError));
    if (fitted.picture) lines += "  " + summaryOf(*fitted.picture) + "\n";
    if (fitted.factors)
        lines += fmt::format(
            "  off by a factor of {:.3g} in the median, {:.3g} for nine of ten "
            "values\n",
            fitted.factors->median, fitted.factors->nineOfTen);
    lines += uncertaintyText(fitted.preset["fit"]);
    if (fitted.pageFiles > 0)
        lines += fmt::format("written to {}: fit.json, comparison.html and {} files beside it\n",
                             arguments.output, fitted.pageFiles - 1);
    else if (!arguments.output.empty())
        lines += fmt::format("written to {}\n", arguments.output);
    if (!arguments.options.certificate.empty())
        lines += fmt::format("certificate written to {}\n", arguments.options.certificate);
    return lines + figuresText(fitted.figures, arguments.figures);
}

void runAll(const FitArguments& arguments, Globals& globals) {
    if (arguments.output.empty())
        throw UsageError("fit --all: give -o DIR, the folder for the results");
    const jobs::BatchOutcome outcome =
        jobs::fitAll(arguments.all, arguments.output, arguments.options, listenerFor(globals));
    Json failures = Json::array();
    std::string lines = fmt::format("{} fitted, {} kept, {} failed\n", outcome.fitted, outcome.kept,
                                    outcome.failures.size());
    for (const auto& [file, reason] : outcome.failures) {
        failures.push_back({{"file", file}, {"reason", reason}});
        lines += reason.starts_with(file) ? fmt::format("  {}\n", reason)
                                          : fmt::format("  {}: {}\n", file, reason);
    }
    if (!outcome.failures.empty())
        endWithoutNumbers(globals,
                          fmt::format("fit --all: {} of {} fits failed", outcome.failures.size(),
                                      outcome.fitted + outcome.kept + outcome.failures.size()));
    if (!globals.json) return printText(lines);
    printJson({{"format", "hshfit-fit-all"},
               {"version", 1},
               {"fitted", outcome.fitted},
               {"kept", outcome.kept},
               {"failures", failures}});
}

void runCompareModels(const FitArguments& arguments, Globals& globals) {
    const auto [loss, ranks] =
        jobs::rankModels(arguments.data, arguments.models, arguments.options);
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
                        {"spec", fit.spectrum.empty() ? Json(fit.spec) : Json()},
                        {"parameters", fit.parameters.size()},
                        {"held_out_rms", rank.heldOut},
                        {"rms", fit.loss},
                        {"aic", fit.aic},
                        {"bic", fit.bic},
                        {"converged", fit.converged}});
        if (fit.uncertainty) {
            list.back()["chi_square"] =
                fit.uncertainty->stated ? Json(fit.uncertainty->chiSquare) : Json();
            list.back()["degrees_of_freedom"] = fit.uncertainty->degreesOfFreedom;
            list.back()["tied"] = rank.tied;
            list.back()["simplest_of_tied"] = rank.simplest;
        }
        lines += fmt::format("  {:<28} {:>3} {:>12.6g} {:>12.6g} {:>12.8g} {:>12.8g}{}\n",
                             rank.model, fit.parameters.size(), rank.heldOut, fit.loss, fit.aic,
                             fit.bic, fit.converged ? "" : "  not converged");
        if (fit.uncertainty && fit.uncertainty->stated)
            lines.insert(lines.size() - 1, fmt::format("  chi-square {:.4g} each",
                                                       fit.uncertainty->reducedChiSquare()));
        if (rank.tied) lines.insert(lines.size() - 1, "  tied with the first");
        if (rank.simplest) lines.insert(lines.size() - 1, "  fewest parameters of those tied");
        if (!fit.converged && !arguments.options.accept)
            endWithoutNumbers(globals,
                              fmt::format("{}: the fit of {} did not converge; --accept takes it",
                                          arguments.data, rank.model));
    }
    const Json document = {{"format", "hshfit-fit-models"},
                           {"version", 1},
                           {"data", arguments.data},
                           {"loss", loss},
                           {"models", list}};
    stateExitCode(globals.exitCode);
    if (!arguments.output.empty()) writeFile(arguments.output, jsonText(document, 2) + "\n");
    if (globals.json)
        printJson(document);
    else
        printText(lines);
}

void runFit(FitArguments& arguments, Globals& globals) {
    arguments.options.figures = arguments.figures.parsed();
    if (arguments.data.empty() == arguments.all.empty())
        throw UsageError("fit: give either DATA or --all DIR");
    if (arguments.options.model.empty() == arguments.models.empty())
        throw UsageError("fit: give either --model or --compare-models");
    const jobs::FitOptions& options = arguments.options;
    if ((!arguments.all.empty() || !arguments.models.empty()) &&
        (options.bootstrap > 0 || options.profile || !options.residuals.empty() ||
         options.figures || !options.bands.empty() || !options.certificate.empty()))
        throw UsageError(
            "fit: --bootstrap, --profile, --residuals, --figures, --bands and --certificate are "
            "for one model and one DATA");
    if (!options.certificateFields.empty() && options.certificate.empty())
        throw UsageError("fit: --certificate-fields is for --certificate OUT.pdf");
    if (!arguments.models.empty() && (!options.calibration.empty() || !options.budget.empty()))
        throw UsageError("fit: --calibration and --budget are for one model");
    if (options.bands.empty() != options.bandsTo.empty() &&
        !(globals.json && !options.bands.empty()))
        throw UsageError(
            "fit: --bands PAIRS and --bands-to FILE.csv go together; with --json, bands are also "
            "in the answer");
    if (!arguments.all.empty()) {
        if (arguments.options.model.empty()) throw UsageError("fit --all: takes one --model");
        return runAll(arguments, globals);
    }
    if (!arguments.models.empty()) return runCompareModels(arguments, globals);
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpuStart = std::clock();
    jobs::Fitted fitted =
        jobs::fit(arguments.data, arguments.output, arguments.options, listenerFor(globals));
    if (fitted.poor) note(globals, fitted.poor->line());
    noteFont(fitted.figures, arguments.figures, globals);
    if (!globals.json) return printText(text(fitted, arguments));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    fitted.preset["time"] = {
        {"seconds", elapsed.count()},
        {"cpu_seconds", static_cast<double>(std::clock() - cpuStart) / CLOCKS_PER_SEC}};
    if (!fitted.figures.names.empty())
        fitted.preset["figures"] = figuresJson(fitted.figures, arguments.figures.figures);
    if (!fitted.bands.is_null()) fitted.preset["bands"] = fitted.bands;
    if (fitted.poor) fitted.preset["poor"] = jobs::poorJson(*fitted.poor);
    printJson(fitted.preset);
}

constexpr ArgumentRow fitArguments[] = {
    optional("DATA", at<&FitArguments::data>, "BRDF or coefficient file", brdfRead),
    optional("all", at<&FitArguments::all>,
             "Fit every file of a folder; -o DIR takes one result each; what stands there and "
             "is valid is not fitted again",
             {.files = Files::readFolder}),
    optional("compare-models", at<&FitArguments::models>,
             "Fit each of these models and rank them by held-out directions",
             {.words = jobs::modelWords, .syntax = Syntax::sum}),
    optionalOutput(at<&FitArguments::output>,
                   "Where the fit goes: a preset (.json), or a folder for a report as well",
                   jsonWritten),
};

}  // namespace

CommandRows fitRows() {
    return {fitArguments,
            {jobs::fitOptions().rows, jobs::instrumentOptions().rows, jobs::figureOptions().rows}};
}

void addFit(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<FitArguments>();
    jobs::FitOptions& options = arguments->options;
    addArguments(command, fitArguments, *arguments);
    addOptions(command, jobs::fitOptions(), options);
    addOptions(command, jobs::instrumentOptions(), options.instrument, "Instrument");
    addOptions(command, jobs::figureOptions(), arguments->figures, "Figures for print");
    command.callback([arguments, &globals] { runFit(*arguments, globals); });
}

}  // namespace hshfit::cli
