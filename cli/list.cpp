#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "job_options.h"
#include "page.h"
#include "terminal.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/light/catalog.h>

#include <brdfs/catalog.h>
#include <brdfs/catalog/metal_spec.h>
#include <brdfs/catalog/preset.h>
#include <brdfs/composed/sum.h>
#include <brdfs/fit/dispersion_law.h>
#include <brdfs/presets/metals.h>
#include <brdfs/presets/preset_collection.h>
#include <jobs/common/option_words.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

Json parameterJson(const brdfs::Parameter& parameter) {
    using Kind = brdfs::Parameter::Kind;
    Json json = {{"name", parameter.name}, {"help", parameter.help}};
    if (parameter.kind == Kind::text) {
        json["kind"] = "text";
        json["default"] = "";
        json["choices"] = parameter.choices;
        return json;
    }
    if (parameter.kind == Kind::choice) {
        json["kind"] = "choice";
        json["default"] = parameter.choices.front();
        json["choices"] = parameter.choices;
        return json;
    }
    json["kind"] = parameter.kind == Kind::colour ? "colour" : "number";
    const auto fallback = parameter.fallback;
    const bool stated = fallback && *fallback >= parameter.min && *fallback <= parameter.max;
    json["default"] = stated ? Json(*fallback) : Json(nullptr);
    json["min"] = finiteOrNull(parameter.min);
    json["max"] = finiteOrNull(parameter.max);
    return json;
}

Json parametersJson(const std::vector<brdfs::Parameter>& parameters) {
    Json json = Json::array();
    for (const auto& parameter : parameters) json.push_back(parameterJson(parameter));
    return json;
}

Json modelsJson() {
    Json rows = Json::array();
    for (const auto& model : brdfs::models()) {
        rows.push_back({{"name", model.name},
                        {"help", model.help},
                        {"source", model.source},
                        {"parameters", parametersJson(model.parameters)},
                        {"laws", lawsJson(model.laws)}});
    }
    return rows;
}

/// A reader or a writer.
template <class Row>
Json fileRowsJson(std::span<const Row> table) {
    Json rows = Json::array();
    for (const Row& row : table) {
        rows.push_back({{"name", row.name},
                        {"help", row.help},
                        {"extension", row.extension},
                        {"parameters", parametersJson(row.parameters)}});
    }
    return rows;
}

Json formatsJson() {
    return fileRowsJson(brdfs::formats());
}

Json writersJson() {
    return fileRowsJson(brdfs::writers());
}

Json lightsJson() {
    Json rows = Json::array();
    const auto add = [&](const LightKind& kind) {
        rows.push_back({{"name", kind.name},
                        {"help", kind.help},
                        {"source", kind.source},
                        {"example", kind.example},
                        {"parameters", parametersJson(kind.parameters)}});
    };
    for (const LightKind& kind : lightKinds()) add(kind);
    add(studioKind());
    add(pictureKind());
    add(coefficientsKind());
    return rows;
}

Json basesJson() {
    Json rows = Json::array();
    for (const auto& basis : bases::catalog()) {
        rows.push_back({{"name", basis.name},
                        {"help", basis.help},
                        {"source", basis.source},
                        {"max_order", basis.maxOrder},
                        {"orthonormal", basis.orthonormal}});
    }
    return rows;
}

Json metricsJson() {
    Json rows = Json::array();
    for (const auto& metric : metricCatalog()) {
        rows.push_back({{"name", metric.name}, {"help", metric.help}, {"source", metric.source}});
    }
    return rows;
}

/// Presets that belong to no collection.
Json presetsJson() {
    Json rows = Json::array();
    for (const auto& preset : brdfs::presets()) {
        const auto content = brdfs::parsePreset(preset.text, "preset:" + std::string(preset.name));
        rows.push_back({{"name", preset.name},
                        {"help", preset.help},
                        {"source", content.source},
                        {"spec", content.spec}});
    }
    return rows;
}

Json collectionsJson() {
    Json rows = Json::array();
    for (std::size_t i = 0; i < brdfs::presetCollections().size(); ++i) {
        const brdfs::PresetCollection& collection = brdfs::presetCollection(i);
        Json row = {{"name", brdfs::presetCollections()[i].name},
                    {"help", collection.help},
                    {"model", collection.model},
                    {"source", collection.source},
                    {"materials", collection.materials.size()}};
        if (!collection.correction.empty()) row["correction"] = collection.correction;
        rows.push_back(row);
    }
    return rows;
}

/// Presets of no collection, and every material of every collection as COLLECTION/MATERIAL.
Json allPresetsJson() {
    Json rows = presetsJson();
    for (std::size_t i = 0; i < brdfs::presetCollections().size(); ++i) {
        const brdfs::PresetCollection& collection = brdfs::presetCollection(i);
        for (const auto& material : collection.materials)
            rows.push_back(
                {{"name", fmt::format("{}/{}", brdfs::presetCollections()[i].name, material.name)},
                 {"help", collection.help},
                 {"source", collection.source},
                 {"spec", material.spec}});
    }
    return rows;
}

std::string lowered(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return text;
}

/// The presets whose name contains `text`, ignoring case. Throws UsageError with the nearest
/// names if there is none.
Json foundPresetsJson(const std::string& text) {
    Json found = Json::array();
    std::vector<std::string> names;
    for (const Json& row : allPresetsJson()) {
        names.push_back(row["name"]);
        if (lowered(names.back()).find(lowered(text)) != std::string::npos) found.push_back(row);
    }
    if (!found.empty()) return found;
    // Many collections have the same material: names are compared without the collection.
    std::vector<std::string> words;
    for (const std::string& name : names) {
        const std::string word = name.substr(name.find('/') + 1);
        if (std::ranges::find(words, word) == words.end()) words.push_back(word);
    }
    std::string hint = "list presets --all prints all";
    if (const auto nearest = brdfs::nearestNames(text, words, 5); !nearest.empty())
        hint = fmt::format("nearest: {}", fmt::join(nearest, ", "));
    throw UsageError(fmt::format("no preset matches '{}'; {}", text, hint));
}

Json metalsJson() {
    Json rows = Json::array();
    for (const brdfs::Metal& metal : brdfs::metals())
        rows.push_back({{"name", metal.name},
                        {"help", metal.help},
                        {"source", metal.source},
                        {"first", metal.rows.front().nanometres},
                        {"last", metal.rows.back().nanometres}});
    return rows;
}

Json dispersionsJson() {
    Json rows = Json::array();
    for (const brdfs::DispersionLaw& law : brdfs::dispersionLaws()) {
        rows.push_back({{"name", law.name}, {"help", law.help}});
        if (law.most > 0)
            rows.back()["number"] = {
                {"min", law.least}, {"max", law.most}, {"default", law.fallback}};
    }
    return rows;
}

Json targetsJson() {
    Json rows = Json::array();
    for (const gpu::Target& target : gpu::targets()) {
        rows.push_back({{"name", target.name},
                        {"help", target.summary},
                        {"kind", gpu::kindName(target.kind)}});
        if (!target.parts.empty()) rows.back()["parts"] = target.parts;
    }
    return rows;
}

struct Section {
    const char* name;
    Json (*rows)();
    std::string_view sums = {};    ///< help on sums of the rows
    std::string_view metals = {};  ///< help on metals in place of numbers
};
constexpr Section sections[] = {{"models", modelsJson, brdfs::sumHelp, brdfs::metalHelp},
                                {"metals", metalsJson},
                                {"dispersions", dispersionsJson},
                                {"formats", formatsJson},
                                {"writers", writersJson},
                                {"lights", lightsJson, lightSumHelp},
                                {"bases", basesJson},
                                {"metrics", metricsJson},
                                {"targets", targetsJson}};

/// A row of a table: a term, and its explanation in lines as wide as the terminal.
std::string rowText(std::size_t indent, std::size_t termWidth, const std::string& term,
                    const std::string& text) {
    const std::string begin = fmt::format("{:{}}{:<{}} ", "", indent, term, termWidth);
    const auto width = tableColumns();
    return begin +
           (width ? wrapped(text, *width, indent + termWidth + 1, columnsOf(begin)) : text) + "\n";
}

std::string detailText(const std::string& term, const std::string& text) {
    return rowText(6, 14, term, text);
}

std::string parameterHelp(const Json& parameter) {
    std::string text = parameter["help"].get<std::string>();
    if (parameter["kind"] == "text")
        return text + fmt::format(" (such as {})", parameter["choices"][0].get<std::string>());
    if (parameter["kind"] == "choice") {
        return text + fmt::format(" ({}; default {})", jsonText(parameter["choices"]),
                                  parameter["default"].get<std::string>());
    }
    const auto shown = [](const Json& limit) {
        return limit.is_null() ? std::string("inf") : fmt::format("{:g}", limit.get<double>());
    };
    text += fmt::format(" ({} to {}", shown(parameter["min"]), shown(parameter["max"]));
    if (!parameter["default"].is_null())
        text += fmt::format("; default {}", shown(parameter["default"]));
    return text + ")";
}

std::string lawsText(const Json& laws) {
    std::string text;
    for (const auto& [law, holds] : laws.items()) {
        if (!holds.get<bool>()) continue;
        std::string words = law;
        std::replace(words.begin(), words.end(), '_', ' ');
        text += (text.empty() ? "" : ", ") + words;
    }
    return text;
}

void printSection(const char* name, const Json& rows, std::string_view sums = {},
                  std::string_view metals = {}) {
    constexpr std::size_t indent = 2, term = 18;
    std::string text = fmt::format("{}\n", name);
    if (rows.empty()) text += "  none yet\n";
    for (const Json& row : rows) {
        text += rowText(indent, term, row["name"], row["help"]);
        if (const std::string source = row.value("source", ""); !source.empty())
            text += detailText("source", source);
        if (row.contains("parts"))
            text += detailText(
                "parts",
                fmt::format("{}", fmt::join(row["parts"].get<std::vector<std::string>>(), ", ")));
        if (row.contains("number"))
            text += detailText(
                "number",
                fmt::format("{} to {}; default {}", row["number"]["min"].get<int>(),
                            row["number"]["max"].get<int>(), row["number"]["default"].get<int>()));
        if (row.contains("example")) text += detailText("example", row["example"]);
        for (const Json& parameter : row.value("parameters", Json::array()))
            text += detailText(parameter["name"], parameterHelp(parameter));
        if (row.contains("laws")) text += detailText("laws", lawsText(row["laws"]));
    }
    if (!sums.empty()) text += rowText(indent, term, "sums", std::string(sums));
    if (!metals.empty()) text += rowText(indent, term, "metals", std::string(metals));
    printText(text + "\n");
}

/// Lists one line per collection if `text` is empty and `all` is false.
void listPresets(const std::string& text, bool all, bool json, Json& document) {
    const bool summary = text.empty() && !all;
    const Json rows = summary         ? presetsJson()
                      : !text.empty() ? foundPresetsJson(text)
                                      : allPresetsJson();
    if (json) {
        document["presets"] = rows;
        document["collections"] = collectionsJson();
        return;
    }
    if (!summary) {
        std::string names;
        for (const Json& row : rows) names += row["name"].get<std::string>() + "\n";
        printText(names);
        return;
    }
    printSection("presets", rows);
    std::string lines = "preset collections (list presets TEXT searches them)\n";
    for (const Json& row : collectionsJson())
        lines += rowText(2, 40,
                         fmt::format("{:<25} {:>3} materials", row["name"].get<std::string>(),
                                     row["materials"].get<int>()),
                         row["help"]);
    printText(lines);
}

struct ListArguments {
    std::string section, text;
    bool all = false;
};

std::vector<Word> sectionWords() {
    std::vector<Word> words{{"presets"}};
    for (const Section& s : sections) words.push_back({std::string(s.name)});
    return words;
}

std::vector<Word> presetWords() {
    std::vector<Word> words = jobs::wordsOf(brdfs::presets());
    for (const brdfs::CollectionEntry& collection : brdfs::presetCollections())
        words.push_back({std::string(collection.name), "a collection"});
    return words;
}

constexpr ArgumentRow listArguments[] = {
    optional("SECTION", at<&ListArguments::section>, "One catalog; all of them if left out",
             {.words = sectionWords, .complete = true}),
    optional("TEXT", at<&ListArguments::text>, "presets: those whose name holds this, in any case",
             {.words = presetWords}),
    optional("all", at<&ListArguments::all>, "presets: every name, not a line per collection"),
};

}  // namespace

CommandRows listRows() {
    return {listArguments, {}};
}

void addList(CLI::App& command, Globals& globals) {
    auto options = std::make_shared<ListArguments>();
    addArguments(command, listArguments, *options);
    command.callback([options, &globals] {
        if (options->section != "presets" && (options->all || !options->text.empty()))
            throw UsageError("TEXT and --all are for `list presets`");
        Json document = {{"format", "hshfit-list"}, {"version", 1}};
        for (const Section& s : sections) {
            if (!options->section.empty() && options->section != s.name) continue;
            if (globals.json) {
                document[s.name] = s.rows();
            } else {
                printSection(s.name, s.rows(), s.sums, s.metals);
            }
        }
        if (options->section.empty() || options->section == "presets")
            listPresets(options->text, options->all, globals.json, document);
        if (globals.json) printJson(document);
    });
}

}  // namespace hshfit::cli
