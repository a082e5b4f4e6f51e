#include "command.h"
#include "trade_lighting.h"
#include "within.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <jobs/studies/tradeoff.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace hshfit::cli {
namespace {

using tradeoff::TradeoffOptions;

struct TradeoffArguments {
    std::vector<std::string> specs;
    std::string output;
    std::vector<std::string> forms, bases, outgoing, halfway, precisions, splits, windows,
        constraints;
    std::vector<int> orders, ranks;
    std::vector<std::size_t> keep;
    jobs::TradeoffOptions options;
    double maxBytes = 0, maxNanoseconds = 0, tolerance = 0;
    double maxEvaluations = static_cast<double>(TradeoffOptions{}.projection.maxEvaluations);
    bool cosine = false, noTiming = false, gpu = false;
    std::string device;
    std::string lighting;  ///< models; empty: forms are measured
    std::vector<std::string> lights;
};

/// Replaces the sweep's default values with those on the command line, if there are any.
template <class Value, class Parse>
void choose(const std::vector<std::string>& names, std::vector<Value>& into, Parse parse) {
    if (names.empty()) return;
    into.clear();
    for (const std::string& name : names) into.push_back(parse(name));
}

/// Turns "none" into the empty text, which means no split.
std::string parseSplit(const std::string& text) {
    return text == "none" ? std::string() : text;
}

std::string parseOutgoing(const std::string& text) {
    return OutgoingSet::parse(text).spec();
}

std::vector<std::string> basisNames(const std::vector<std::string>& asked) {
    std::vector<std::string> names;
    for (const std::string& text : asked) {
        for (const bases::Entry* entry : bases::select(text)) names.emplace_back(entry->name);
    }
    return names;
}

gpu::DeviceChoice deviceFrom(const std::string& text) {
    using Device = gpu::DeviceChoice::Kind;
    if (text.empty() || text == "any") return {};
    if (text == "gpu") return {.kind = Device::gpu};
    if (text == "software") return {.kind = Device::software};
    return {.name = text};
}

jobs::TradeoffOptions optionsFrom(const TradeoffArguments& arguments) {
    jobs::TradeoffOptions all = arguments.options;
    TradeoffOptions& options = all.measurement;
    tradeoff::Sweep& sweep = options.sweep;
    choose(arguments.forms, sweep.kinds, parseKind);
    if (!arguments.bases.empty()) sweep.bases = basisNames(arguments.bases);
    if (!arguments.orders.empty()) sweep.orders = arguments.orders;
    choose(arguments.outgoing, sweep.outgoing, parseOutgoing);
    choose(arguments.halfway, sweep.halfway, parseHalfway);
    if (!arguments.ranks.empty()) sweep.ranks = arguments.ranks;
    choose(arguments.precisions, sweep.precisions, parsePrecision);
    if (!arguments.keep.empty()) sweep.keep = arguments.keep;
    choose(arguments.splits, sweep.splits, parseSplit);
    choose(arguments.windows, sweep.windows, parseWindow);
    choose(arguments.constraints, sweep.constraints, tradeoff::parseConstraint);
    sweep.quantity = arguments.cosine ? Quantity::brdfCosine : Quantity::brdf;
    if (arguments.maxBytes > 0) options.maxBytes = static_cast<std::size_t>(arguments.maxBytes);
    if (arguments.maxNanoseconds > 0) options.maxNanoseconds = arguments.maxNanoseconds;
    options.timing = !arguments.noTiming;
    if (arguments.gpu) options.gpu = deviceFrom(arguments.device);
    if (!arguments.gpu && !arguments.device.empty())
        throw UsageError("--device names what --gpu runs on: add --gpu");
    options.projection.tolerance = arguments.tolerance;
    options.projection.maxEvaluations = static_cast<std::size_t>(arguments.maxEvaluations);
    return all;
}

void runTradeoff(const TradeoffArguments& arguments, Globals& globals) {
    if (!arguments.lighting.empty()) {
        jobs::LightingTradeOptions options{.models = arguments.lighting};
        options.errors.lights = arguments.lights;
        return runTradeLighting(arguments.specs, options, globals);
    }
    if (arguments.output.empty() && !globals.json) {
        throw UsageError("tradeoff: give -o DIR for the files, or --json");
    }
    const jobs::TradeoffOptions options = optionsFrom(arguments);
    const jobs::MeasuredTradeoffs measured =
        jobs::measureTradeoffs(arguments.specs, arguments.output, options, listenerFor(globals));
    if (globals.json) {
        printText(tradeoffJson(measured.trades, true));
    } else if (!measured.trades.empty()) {
        std::string text;
        for (const tradeoff::Tradeoff& trade : measured.trades)
            text += tradeoffText(trade, options.measurement.byTime);
        const char* timing = arguments.noTiming ? "" : ", timing.html";
        printText(text + fmt::format("written to {}: tradeoff.html{}, and the figures and tables "
                                     "in them\n",
                                     arguments.output, timing));
    }
    reportFailures(measured.failures, measured.specs.size(), globals);
}

void addSweep(CLI::App& command, TradeoffArguments& arguments) {
    const auto list = [&](const std::string& name, auto& into, const std::string& help) {
        return command.add_option(name, into, help)->delimiter(',')->allow_extra_args(false);
    };
    list("--forms", arguments.forms, "Of outgoing, basis, halfway (default: all)");
    list("--bases", arguments.bases, "all, or names from hshfit list bases (default: three)");
    list("--orders", arguments.orders, "Orders (default: 3,5,7,10)")
        ->check(within(jobs::bounds::tradeOrders));
    list("--ranks", arguments.ranks, "Ranks of factors, 0 for none (default: 0,2,4)")
        ->check(within(jobs::bounds::tradeRanks));
    list("--precisions", arguments.precisions,
         "Of float64, float32, half, unorm16, unorm8 (default: all but float64)");
    list("--keep", arguments.keep, "Numbers of each array to keep, 0 for all (default: 0)");
    list("--windows", arguments.windows, "Of none, hann, lanczos, bending (default: none)");
    list("--constraints", arguments.constraints,
         "Of none, non-negative, energy-preserving, both (default: none)");
    const auto repeated = [&](const std::string& name, auto& into, const std::string& help) {
        command.add_option(name, into, help)->allow_extra_args(false);
    };
    repeated("--outgoing", arguments.outgoing,
             "WxH, N or THETA,PHI; give it once for each (default: 8, 16, 32; 8x8, 16x16 if "
             "anisotropic)");
    repeated("--halfway", arguments.halfway,
             "Orders H,D,A of --form halfway; give it once for each (default: four)");
    repeated("--split", arguments.splits,
             "none, diffuse or a BRDF to take out; give it once for each (default: none)");
}

}  // namespace

void addTradeoff(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<TradeoffArguments>();
    command
        .add_option("SPEC", arguments->specs,
                    "One or more BRDFs; of a folder, the measured files in it")
        ->required();
    command.add_option("-o,--output", arguments->output, "Folder to write, made if absent");
    addSweep(command, *arguments);
    command
        .add_option("--metric", arguments->options.measurement.metric,
                    "What the fronts weigh: hshfit list metrics, or picture (FLIP)")
        ->capture_default_str();
    command.add_option("--max-bytes", arguments->maxBytes, "Leave out forms that take more")
        ->check(CLI::Range(1.0, 1e15));
    command
        .add_option("--max-ns", arguments->maxNanoseconds,
                    "Leave out of the front over time what takes longer for a pair; with --by-time")
        ->check(CLI::Range(1e-3, 1e12));
    command.add_flag("--no-timing", arguments->noTiming, "Measure no times");
    command.add_flag("--gpu", arguments->gpu,
                     "Time the shaders of the fronts' forms on a Vulkan device");
    command.add_option("--device", arguments->device,
                       "any (a GPU if there is one), gpu, software, or a part of its name; with "
                       "--gpu");
    command.add_flag("--by-time", arguments->options.measurement.byTime,
                     "Print the front over time instead of that over bytes");
    command
        .add_option("--pair-count", arguments->options.pairCount,
                    "Pairs of directions on which errors are measured, about")
        ->check(within(jobs::bounds::pairCount))
        ->capture_default_str();
    command.add_option("--pairs", arguments->options.pairs,
                       "CSV of the pairs to measure on instead: columns wi_x … wo_z, and weight");
    command.add_option("--write-pairs", arguments->options.writePairs,
                       "CSV to write: the pairs, their weights and the values of SPEC");
    command.add_flag("--wavelets", arguments->options.measurement.wavelets,
                     "Measure the best terms of SOHO wavelets too, for comparison");
    command.add_option("--lighting", arguments->lighting,
                       "Measure, in place of forms, the models of lighting of hshfit export: all, "
                       "or of coefficients, split-sum, ltc and prefiltered those named");
    command
        .add_option("--light", arguments->lights,
                    "With --lighting, a light; repeated (default: an example of every kind)")
        ->allow_extra_args(false);
    command.add_flag("--cosine", arguments->cosine, "Project f cos(theta_i) instead of f");
    addRgb(command, arguments->options.rgb);
    addQuadrature(command, arguments->tolerance, arguments->maxEvaluations);
    command.callback([arguments, &globals] { runTradeoff(*arguments, globals); });
}

}  // namespace hshfit::cli
