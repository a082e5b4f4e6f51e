#include "command.h"

#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/tradeoff/tradeoff_files.h>

#include <brdfs/catalog.h>

#include <jobs/source.h>

#include <fmt/format.h>
#include <libfccp/csv.h>
#include <CLI/CLI.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>

namespace hshfit::cli {
namespace {

using tradeoff::Tradeoff;
using tradeoff::TradeoffOptions;

struct TradeoffArguments {
    std::vector<std::string> specs;
    std::string output, pairs, writePairs;
    std::vector<std::string> forms, bases, outgoing, halfway, precisions, splits, windows,
        constraints;
    std::vector<int> orders, ranks;
    std::vector<std::size_t> keep;
    int pairCount = 32768;
    std::string metric = TradeoffOptions{}.metric;
    double maxBytes = 0, maxNanoseconds = 0, tolerance = 0;
    double maxEvaluations = static_cast<double>(TradeoffOptions{}.projection.maxEvaluations);
    bool cosine = false, noTiming = false, byTime = false, rgb = false, wavelets = false;
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

TradeoffOptions optionsFrom(const TradeoffArguments& arguments) {
    TradeoffOptions options;
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
    options.metric = arguments.metric;
    if (arguments.maxBytes > 0) options.maxBytes = static_cast<std::size_t>(arguments.maxBytes);
    if (arguments.maxNanoseconds > 0) options.maxNanoseconds = arguments.maxNanoseconds;
    options.timing = !arguments.noTiming;
    options.byTime = arguments.byTime;
    options.wavelets = arguments.wavelets;
    options.projection.tolerance = arguments.tolerance;
    options.projection.maxEvaluations = static_cast<std::size_t>(arguments.maxEvaluations);
    return options;
}

double numberIn(const char* cell, const std::string& where) {
    const std::string_view text(cell);
    double value = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size() || !std::isfinite(value)) {
        throw InputError(fmt::format("{}: '{}' is not a finite number", where, text));
    }
    return value;
}

Direction unit(const Direction& d, const std::string& where) {
    const double length = std::sqrt(dot(d, d));
    if (std::abs(length - 1) > 1e-3) {
        throw InputError(fmt::format("{}: the direction {}, {}, {} has length {:.4g}, not 1", where,
                                     d.x, d.y, d.z, length));
    }
    return {d.x / length, d.y / length, d.z / length};
}

/// Columns wi_x … wo_z and, if there is one, weight.
PairSample readPairs(const std::string& path) {
    std::vector<Direction> wi, wo;
    std::vector<double> weights;
    try {
        io::CSVReader<7, io::trim_chars<' ', '\t'>, io::double_quote_escape<',', '"'>> reader(path);
        reader.read_header(io::ignore_extra_column | io::ignore_missing_column, "wi_x", "wi_y",
                           "wi_z", "wo_x", "wo_y", "wo_z", "weight");
        for (const char* name : {"wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z"}) {
            if (reader.has_column(name)) continue;
            throw InputError(fmt::format("{}: there is no column {}", path, name));
        }
        const char* cells[7] = {};
        while (
            reader.read_row(cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6])) {
            const std::string where = fmt::format("{}, line {}", path, reader.get_file_line());
            std::array<double, 6> v{};
            for (std::size_t k = 0; k < v.size(); ++k) v[k] = numberIn(cells[k], where);
            wi.push_back(unit({v[0], v[1], v[2]}, where));
            wo.push_back(unit({v[3], v[4], v[5]}, where));
            if (reader.has_column("weight")) weights.push_back(numberIn(cells[6], where));
        }
    } catch (const io::error::base& error) {
        error.format_error_message();
        throw InputError(error.what());
    }
    return pairsFrom(wi, wo, weights);
}

PairSample pairsFor(const TradeoffArguments& arguments) {
    if (!arguments.pairs.empty()) return readPairs(arguments.pairs);
    SpreadOptions spread;
    spread.incoming = std::max(2, arguments.pairCount / (spread.replicates * spread.outgoing));
    return spreadPairs(spread);
}

/// The pairs, their weights and the values of one BRDF, for measurements of other models.
std::string pairsCsv(const PairSample& pairs, const Brdf& brdf) {
    const std::vector<double> values = evaluateOn(brdf, pairs);
    std::string csv = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,weight";
    for (const std::string& name : brdf.channels().names()) csv += fmt::format(",{}", name);
    csv += "\n";
    for (std::size_t g = 0; g < pairs.wo.size(); ++g) {
        const Direction& wo = pairs.wo[g];
        for (std::size_t k = pairs.first[g]; k < pairs.first[g + 1]; ++k) {
            csv += fmt::format("{},{},{},{},{},{},{}", pairs.x[k], pairs.y[k], pairs.z[k], wo.x,
                               wo.y, wo.z, pairs.weights[k]);
            for (std::size_t at = k; at < values.size(); at += pairs.size()) {
                csv += fmt::format(",{}", values[at]);
            }
            csv += "\n";
        }
    }
    return csv;
}

/// The trade-offs of all inputs, in their order. They run one at a time to keep times comparable.
std::vector<Tradeoff> measureAll(const TradeoffArguments& arguments,
                                 const std::vector<std::string>& specs, const Globals& globals,
                                 std::vector<jobs::InputFailure>& failures,
                                 std::optional<FileSet>& files) {
    const PairSample pairs = pairsFor(arguments);
    const TradeoffOptions common = optionsFrom(arguments);
    std::vector<Tradeoff> trades;
    for (const std::string& spec : specs) {
        try {
            const auto brdf = jobs::openBrdf(spec, arguments.rgb);
            if (!arguments.writePairs.empty()) {
                files->write(std::filesystem::absolute(arguments.writePairs).string(),
                             pairsCsv(pairs, *brdf));
            }
            Progress progress(globals, spec);
            TradeoffOptions options = common;
            options.progress = progress.callback();
            trades.push_back(measure(*brdf, pairs, options,
                                     [](const std::string& s) { return brdfs::open(s); }));
        } catch (const OutputError&) {
            throw;
        } catch (const Error& error) {
            if (specs.size() == 1) throw;
            failures.push_back({spec, error.what(), error.code()});
        }
    }
    return trades;
}

void runTradeoff(const TradeoffArguments& arguments, Globals& globals) {
    if (arguments.output.empty() && !globals.json) {
        throw UsageError("tradeoff: give -o DIR for the files, or --json");
    }
    const std::vector<std::string> specs = jobs::expandInputs(arguments.specs);
    if (!arguments.writePairs.empty() && specs.size() > 1) {
        throw UsageError("--write-pairs holds the values of one BRDF: give one SPEC");
    }
    std::vector<jobs::InputFailure> failures;
    std::optional<FileSet> files;
    if (!arguments.output.empty() || !arguments.writePairs.empty())
        files.emplace(arguments.output.empty() ? "." : arguments.output, true,
                      FileSet::Above::require);
    const std::vector<Tradeoff> trades = measureAll(arguments, specs, globals, failures, files);
    if (!trades.empty() && !arguments.output.empty())
        writeTradeoffs(trades, *files);
    else if (!trades.empty() && files)
        files->commit();
    if (globals.json) {
        printText(tradeoffJson(trades, true));
    } else if (!trades.empty()) {
        std::string text;
        for (const Tradeoff& trade : trades) text += tradeoffText(trade, arguments.byTime);
        const char* timing = arguments.noTiming ? "" : ", timing.html";
        printText(text + fmt::format("written to {}: tradeoff.html{}, and the figures and tables "
                                     "in them\n",
                                     arguments.output, timing));
    }
    reportFailures(failures, specs.size(), globals);
}

void addSweep(CLI::App& command, TradeoffArguments& arguments) {
    const auto list = [&](const std::string& name, auto& into, const std::string& help) {
        return command.add_option(name, into, help)->delimiter(',')->allow_extra_args(false);
    };
    list("--forms", arguments.forms, "Of outgoing, basis, halfway (default: all)");
    list("--bases", arguments.bases, "all, or names from hshfit list bases (default: three)");
    list("--orders", arguments.orders, "Orders (default: 3,5,7,10)")->check(CLI::Range(1, 1000));
    list("--ranks", arguments.ranks, "Ranks of factors, 0 for none (default: 0,2,4)")
        ->check(CLI::Range(0, 1000));
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
    command.add_option("--metric", arguments->metric, "What the fronts weigh: hshfit list metrics")
        ->capture_default_str();
    command.add_option("--max-bytes", arguments->maxBytes, "Leave out forms that take more")
        ->check(CLI::Range(1.0, 1e15));
    command
        .add_option("--max-ns", arguments->maxNanoseconds,
                    "Leave out of the front over time what takes longer for a pair; with --by-time")
        ->check(CLI::Range(1e-3, 1e12));
    command.add_flag("--no-timing", arguments->noTiming, "Measure no times");
    command.add_flag("--by-time", arguments->byTime,
                     "Print the front over time instead of that over bytes");
    command
        .add_option("--pair-count", arguments->pairCount,
                    "Pairs of directions on which errors are measured, about")
        ->check(CLI::Range(256, 1 << 24))
        ->capture_default_str();
    command.add_option("--pairs", arguments->pairs,
                       "CSV of the pairs to measure on instead: columns wi_x … wo_z, and weight");
    command.add_option("--write-pairs", arguments->writePairs,
                       "CSV to write: the pairs, their weights and the values of SPEC");
    command.add_flag("--wavelets", arguments->wavelets,
                     "Measure the best terms of SOHO wavelets too, for comparison");
    command.add_flag("--cosine", arguments->cosine, "Project f cos(theta_i) instead of f");
    addRgb(command, arguments->rgb);
    addQuadrature(command, arguments->tolerance, arguments->maxEvaluations);
    command.callback([arguments, &globals] { runTradeoff(*arguments, globals); });
}

}  // namespace hshfit::cli
