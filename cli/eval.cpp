#include "command.h"
#include "documents.h"

#include <hshfit/error.h>
#include <hshfit/files/atomic_file.h>

#include <jobs/source.h>

#include <fmt/format.h>
#include <libfccp/csv.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>

namespace hshfit::cli {
namespace {

struct EvalOptions {
    std::string spec, wi, wo, pairs, output;
    bool cosine = false, rgb = false;
};

std::vector<double> evaluatePair(const Brdf& brdf, const Direction& wi, const Direction& wo,
                                 bool cosine) {
    std::vector<double> values = evaluate(brdf, wi, wo);
    for (double& value : values) value *= cosine ? wi.z : 1;
    return values;
}

void evaluateOne(const EvalOptions& options, const Globals& globals) {
    const Direction wi = parseDirection(options.wi, "--wi");
    const Direction wo = parseDirection(options.wo, "--wo");
    const auto brdf = jobs::openSource(options.spec, options.rgb);
    const std::vector<double> values = evaluatePair(*brdf, wi, wo, options.cosine);
    brdf->checkIntact();
    const std::vector<std::string> names = brdf->channels().names();
    if (globals.json) {
        printJson({{"format", "hshfit-eval"},
                   {"version", 1},
                   {"brdf", brdf->name()},
                   {"wi", directionJson(wi)},
                   {"wo", directionJson(wo)},
                   {"cosine", options.cosine},
                   {"channels", names},
                   {"values", values}});
        return;
    }
    std::string text;
    for (std::size_t c = 0; c < values.size(); ++c) {
        text += fmt::format("{}\t{}\n", names[c], values[c]);
    }
    printText(text);
}

/// One direction of a row, normalised. Lengths are checked: a column of angles is a likely mistake.
Direction directionOf(const std::array<std::string, 3>& cells, const std::string& where) {
    double v[3] = {};
    for (int i = 0; i < 3; ++i) {
        const char* end = cells[i].data() + cells[i].size();
        const auto parsed = std::from_chars(cells[i].data(), end, v[i]);
        if (parsed.ec != std::errc() || parsed.ptr != end || !std::isfinite(v[i])) {
            throw InputError(fmt::format("{}: '{}' is not a finite number", where, cells[i]));
        }
    }
    const double length = std::hypot(v[0], v[1], v[2]);
    if (std::abs(length - 1) > 1e-3) {
        throw InputError(fmt::format("{}: the direction {}, {}, {} has length {:.4g}, not 1", where,
                                     v[0], v[1], v[2], length));
    }
    return {v[0] / length, v[1] / length, v[2] / length};
}

/// A grey BRDF has the same value for red, green and blue.
std::vector<std::string> columnsOf(const Channels& channels) {
    if (channels.kind == Channels::Kind::spectral) return channels.names();
    return {"r", "g", "b"};
}

std::string evaluateRows(const Brdf& brdf, const EvalOptions& options) {
    const auto columns = columnsOf(brdf.channels());
    std::string csv = "wi_x,wi_y,wi_z,wo_x,wo_y,wo_z";
    for (const std::string& column : columns) csv += "," + column;
    csv += "\n";
    io::CSVReader<6, io::trim_chars<' ', '\t'>, io::double_quote_escape<',', '"'>> reader(
        options.pairs);
    reader.read_header(io::ignore_extra_column, "wi_x", "wi_y", "wi_z", "wo_x", "wo_y", "wo_z");
    std::array<std::string, 3> i, o;
    while (reader.read_row(i[0], i[1], i[2], o[0], o[1], o[2])) {
        const std::string where = fmt::format("{}, line {}", options.pairs, reader.get_file_line());
        const Direction wi = directionOf(i, where), wo = directionOf(o, where);
        const auto values = evaluatePair(brdf, wi, wo, options.cosine);
        fmt::format_to(std::back_inserter(csv), "{},{},{},{},{},{}", i[0], i[1], i[2], o[0], o[1],
                       o[2]);
        for (std::size_t c = 0; c < columns.size(); ++c) {
            fmt::format_to(std::back_inserter(csv), ",{}", values[std::min(c, values.size() - 1)]);
        }
        csv += "\n";
    }
    brdf.checkIntact();
    return csv;
}

void evaluatePairs(const EvalOptions& options) {
    const auto brdf = jobs::openSource(options.spec, options.rgb);
    std::string csv;
    try {
        csv = evaluateRows(*brdf, options);
    } catch (const io::error::base& error) {
        error.format_error_message();
        throw InputError(fmt::format("{} (the columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z are read)",
                                     error.what()));
    }
    if (options.output.empty()) {
        printText(csv);
    } else {
        writeFile(options.output, csv);
    }
}

}  // namespace

void addEval(CLI::App& command, Globals& globals) {
    auto options = std::make_shared<EvalOptions>();
    command.add_option("SPEC", options->spec, "BRDF or coefficient file")->required();
    auto* wi = command.add_option("--wi", options->wi, "Incoming direction THETA,PHI, degrees");
    auto* wo = command.add_option("--wo", options->wo, "Outgoing direction THETA,PHI, degrees");
    auto* pairs = command.add_option(
        "--pairs", options->pairs,
        "CSV of direction pairs: columns wi_x, wi_y, wi_z, wo_x, wo_y, wo_z; others are ignored");
    command.add_option("-o,--output", options->output, "CSV to write (default: standard output)")
        ->needs(pairs);
    addRgb(command, options->rgb);
    command.add_flag("--cosine", options->cosine, "Print f cos(theta_i) instead of f");
    wi->needs(wo)->excludes(pairs);
    wo->needs(wi)->excludes(pairs);
    command.callback([options, &globals] {
        if (!options->pairs.empty()) return evaluatePairs(*options);
        if (options->wi.empty()) throw UsageError("eval: give --wi and --wo, or --pairs");
        evaluateOne(*options, globals);
    });
}

}  // namespace hshfit::cli
