#include "command.h"
#include "documents.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/error.h>

#include <brdfs/catalog.h>
#include <brdfs/repair.h>
#include <brdfs/spec.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ConvertOptions {
    std::string input, output, to, repairs, outgoing;
    bool rgb = false, reportLoss = false, force = false;
};

/// "merl (.binary), rgl (.bsdf), …"
std::string writableFormats() {
    std::string text;
    for (const auto& writer : brdfs::writers()) {
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", writer.name, writer.extension);
    }
    return text;
}

/// The one asked for, else the first one in the table that has the file's extension.
const brdfs::Writer& chooseWriter(const ConvertOptions& options) {
    const std::string_view name = std::string_view(options.to).substr(0, options.to.find(':'));
    const std::string extension = std::filesystem::path(options.output).extension().string();
    for (const auto& writer : brdfs::writers()) {
        if (name.empty() ? writer.extension == extension : writer.name == name) return writer;
    }
    if (!name.empty()) {
        throw UsageError(fmt::format("--to {}: unknown format; those that can be written are {}",
                                     name, writableFormats()));
    }
    throw UsageError(
        fmt::format("{}: the formats that can be written are {}; choose by the "
                    "extension or with --to",
                    options.output, writableFormats()));
}

brdfs::Parameters writerParameters(const brdfs::Writer& writer, const std::string& to) {
    const std::size_t colon = to.find(':');
    return brdfs::parseParameters(writer.name, writer.parameters,
                                  colon == std::string::npos ? "" : to.substr(colon + 1));
}

struct Loss {
    std::string outgoing;
    std::vector<MetricValue> metrics;
};

/// What was written, read back and compared with what it was written from.
Loss measureLoss(const Brdf& input, const brdfs::Writer& writer, const ConvertOptions& options,
                 const Globals& globals) {
    if (!writer.readBack) {
        throw UsageError(fmt::format(
            "--report-loss: {} is for other programs to read; nothing here reads it", writer.name));
    }
    const auto output = brdfs::open(options.output);
    const OutgoingSet outgoing =
        outgoingOrDefault(options.outgoing, input.laws().isotropic ? *output : input);
    Progress progress(globals, "loss");
    return {outgoing.spec(), compare(input, *output, outgoing, selectMetrics("all"),
                                     {.progress = progress.callback()})};
}

Json repairsJson(const brdfs::RepairedBrdf& repaired) {
    Json rows = Json::array();
    for (const auto& count : repaired.counts()) {
        rows.push_back({{"name", count.name},
                        {"values", repaired.evaluated()},
                        {"changed", count.changed},
                        {"left", count.left}});
    }
    return rows;
}

std::string convertText(const Json& document, const Loss* loss) {
    std::string text =
        fmt::format("{}: {}, {} bytes\n", document["output"].get<std::string>(),
                    document["written"].get<std::string>(), document["bytes"].get<std::size_t>());
    for (const Json& sentence : document["altered"]) {
        text += fmt::format("  altered: {}\n", sentence.get<std::string>());
    }
    for (const Json& row : document.value("repairs", Json::array())) {
        text +=
            fmt::format("  repaired: {} changed {} of {} values", row["name"].get<std::string>(),
                        row["changed"].get<std::uint64_t>(), row["values"].get<std::uint64_t>());
        if (row["left"] != 0)
            text += fmt::format(" and left {} as they were", row["left"].get<std::uint64_t>());
        text += "\n";
    }
    if (!loss) return text;
    text += fmt::format("loss, outgoing {}\n", loss->outgoing);
    for (const MetricValue& result : loss->metrics) text += metricText(result);
    return text;
}

void runConvert(const ConvertOptions& options, const Globals& globals) {
    const brdfs::Writer& writer = chooseWriter(options);
    const brdfs::Parameters parameters = writerParameters(writer, options.to);
    std::unique_ptr<Brdf> brdf = openSource(options.input, options.rgb);
    const brdfs::RepairedBrdf* repaired = nullptr;
    if (!options.repairs.empty()) {
        Progress progress(globals, "repair");
        auto wrapped = brdfs::repaired(std::move(brdf), options.repairs, progress.callback());
        repaired = wrapped.get();
        brdf = std::move(wrapped);
    }

    Json document = {{"format", "hshfit-convert"},
                     {"version", 1},
                     {"input", brdf->name()},
                     {"output", options.output},
                     {"written", writer.name}};
    {
        Progress progress(globals, "convert");
        document["altered"] =
            writer.write(*brdf, options.output, parameters,
                         {.force = options.force, .progress = progress.callback()});
    }
    document["bytes"] = std::filesystem::file_size(options.output);
    if (repaired) document["repairs"] = repairsJson(*repaired);
    std::optional<Loss> loss;
    if (options.reportLoss) {
        loss = measureLoss(*brdf, writer, options, globals);
        Json rows = Json::array();
        for (const MetricValue& result : loss->metrics) rows.push_back(metricJson(result));
        document["loss"] = {{"outgoing", loss->outgoing}, {"metrics", std::move(rows)}};
    }
    brdf->checkIntact();
    if (globals.json) {
        printJson(document);
    } else {
        printText(convertText(document, loss ? &*loss : nullptr));
    }
}

std::string writersHelp() {
    std::string text = "\nFormats to write (options in hshfit list writers):\n";
    for (const auto& writer : brdfs::writers()) {
        text += fmt::format("  {:<12} {:<10} {}\n", writer.name, writer.extension, writer.help);
    }
    text += "\nRepairs:\n";
    for (const auto& repair : brdfs::repairs()) {
        text += fmt::format("  {:<23} {}\n", repair.name, repair.help);
    }
    return text;
}

}  // namespace

void addConvert(CLI::App& command, Globals& globals) {
    auto options = std::make_shared<ConvertOptions>();
    command.footer(command.get_footer() + "\n" + writersHelp());
    command.add_option("IN", options->input, "BRDF, measured file or coefficient file")->required();
    command.add_option("OUT", options->output, "File to write")->required();
    command.add_option("--to", options->to,
                       "Format and its options, NAME[:key=value,...] (default: by the extension)");
    command.add_flag("--report-loss", options->reportLoss,
                     "Read the file back and say what error it costs");
    command.add_option("--outgoing", options->outgoing,
                       "Outgoing directions of the loss: WxH, N or THETA,PHI");
    command.add_option("--repair", options->repairs,
                       "Repairs before writing, separated by commas, or all");
    addRgb(command, options->rgb);
    command.add_flag("--force", options->force, "Replace an existing file");
    command.callback([options, &globals] { runConvert(*options, globals); });
}

}  // namespace hshfit::cli
