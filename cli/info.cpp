#include "command.h"
#include "command_rows.h"
#include "documents.h"
#include "form_lines.h"
#include "health.h"
#include "info_light.h"
#include "job_options.h"

#include <hshfit/brdf/transmission.h>
#include <hshfit/files/json_fields.h>

#include <jobs/common/many.h>
#include <jobs/source/map_facts.h>
#include <jobs/studies/info.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <variant>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

Json factsJson(const std::vector<Fact>& facts) {
    Json json = Json::object();
    for (const auto& [name, value] : facts) {
        std::visit([&, &key = name](const auto& v) { json[key] = v; }, value);
    }
    return json;
}

void describeCoefficients(const CoefficientHead& c, Json& document) {
    document["symmetry"] = {
        {"isotropic", c.isotropic}, {"bilateral", c.bilateral}, {"reciprocal", c.reciprocal}};
    document["facts"] = {{"basis", c.basis},
                         {"order", c.order},
                         {"condon_shortley", c.condonShortley},
                         {"quantity", quantityName(c.quantity)},
                         {"outgoing", c.outgoing.spec()},
                         {"outgoing_directions", c.outgoing.size()},
                         {"coefficients_per_direction", c.slots()},
                         {"energy", c.energy.finite ? Json(c.energy.value) : Json(nullptr)},
                         {"quadrature_error", c.error},
                         {"generator", c.generator}};
}

/// Adds the facts of the container of exported coefficients.
void describeContainer(const gpu::ImportedPayload& read, Json& facts) {
    facts["container"] = read.container;
    facts["texels"] = read.file;
    facts["number"] = gpu::numberName(read.payload.coefficients.number);
    facts["packing"] = gpu::packingName(read.payload.packing);
    facts["layers"] = read.payload.coefficients.layers;
    facts["functions_per_direction"] = read.payload.slots.size();
}

void describeContainer(const gpu::ImportedForm& read, Json& facts) {
    facts["container"] = read.container;
    facts["texels"] = read.file;
    facts["number"] = gpu::numberName(read.payload.texels.number);
    facts["layout"] = "stream";
    facts["numbers"] = read.payload.stream.size();
}

Json answer(const jobs::BrdfInfo& info) {
    const Brdf& brdf = *info.brdf;
    Json document = {{"format", "hshfit-info"},
                     {"version", 1},
                     {"kind", info.coefficients ? "coefficients" : "brdf"},
                     {"name", brdf.name()},
                     {"channels", brdf.channels().names()}};
    if (const std::string name = brdf.name(); !transmissionSide(name).empty())
        document["side"] = transmissionSide(name);
    if (info.coefficients) {
        describeCoefficients(*info.coefficients, document);
        if (info.representation) document["representation"] = describeForm(*info.representation);
    } else {
        document["laws"] = lawsJson(brdf.laws());
        document["facts"] = factsJson(brdf.facts());
    }
    if (info.exported) describeContainer(*info.exported, document["facts"]);
    if (info.exportedForm) describeContainer(*info.exportedForm, document["facts"]);
    describeHealth(info, document);
    document["range"] = {{"min", finiteOrNull(info.least)}, {"max", finiteOrNull(info.greatest)}};
    if (!info.warnings.empty()) document["warnings"] = info.warnings;
    return document;
}

Json mapJson(const jobs::MapFacts& map) {
    Json levels = Json::array();
    for (const auto& level : map.levels)
        levels.push_back({{"width", level.width}, {"height", level.height}});
    return {{"form", map.form},
            {"levels", levels},
            {"bytes", map.bytes},
            {"texel", {{"x", map.x}, {"y", map.y}, {"level", map.level}}}};
}

std::string mapText(const Json& map) {
    const Json& first = map["levels"].at(0);
    return factLine(
               "map",
               fmt::format("{} x {} texels, {} level{}, form {}, {} bytes",
                           first["width"].get<std::size_t>(), first["height"].get<std::size_t>(),
                           map["levels"].size(), map["levels"].size() == 1 ? "" : "s",
                           map["form"].get<std::string>(), map["bytes"].get<std::size_t>())) +
           factLine("texel", fmt::format("{},{} of level {}; :x=…,y=… names others",
                                         map["texel"]["x"].get<std::size_t>(),
                                         map["texel"]["y"].get<std::size_t>(),
                                         map["texel"]["level"].get<std::size_t>()));
}

std::string scalarText(const Json& value) {
    return value.is_string() ? value.get<std::string>() : jsonText(value);
}

/// Six digits; all of them are in the answer in JSON.
std::string shortText(const Json& value) {
    return value.is_null() ? "not finite" : fmt::format("{:.6g}", value.get<double>());
}

std::string infoText(const Json& document) {
    std::string out = fmt::format("{}: {}\n", document["kind"].get<std::string>(),
                                  document["name"].get<std::string>());
    if (document.contains("map")) out += mapText(document["map"]);
    if (document.contains("side"))
        out += factLine("light", fmt::format("{}: wo is below the surface",
                                             document["side"].get<std::string>()));
    std::vector<std::string> names = document["channels"];
    if (names.size() > 8)
        names = {fmt::format("{} from {} to {}", names.size(), names.front(), names.back())};
    out += factLine("channels", fmt::format("{}", fmt::join(names, " ")));
    for (const char* section : {"laws", "symmetry", "facts", "representation"}) {
        if (!document.contains(section)) continue;
        for (const auto& [key, value] : document[section].items())
            out += factLine(key, scalarText(value));
    }
    out += factLine("smallest f found", shortText(document["range"]["min"]));
    out += factLine("largest f found", shortText(document["range"]["max"]));
    out += healthText(document);
    for (const Json& warning : document.value("warnings", Json::array()))
        out += factLine("WARNING", warning.get<std::string>());
    return out;
}

struct InfoArguments {
    std::vector<std::string> specs;
    jobs::InfoOptions options;
};

/// The answer, and whether it is about a light.
struct Described {
    Json document;
    bool light = false;

    std::string text() const { return light ? lightText(document) : infoText(document); }
};

Described describe(const std::string& spec, const jobs::InfoOptions& options,
                   const jobs::Listener& listener) {
    if (looksLikeLight(spec)) return {lightAnswer(spec, jobs::describeLight(spec)), true};
    Described described{answer(jobs::describeSource(spec, options, listener))};
    if (const auto map = jobs::mapOf(spec)) described.document["map"] = mapJson(*map);
    return described;
}

/// One after the other, with an empty line in between.
void infoMany(const InfoArguments& arguments, Globals& globals) {
    const auto many = jobs::makeMany<Described>(
        jobs::expandInputs(arguments.specs, jobs::Members::both), {}, "info", listenerFor(globals),
        [&](const std::string& spec, const std::string&, const jobs::Listener& each) {
            return describe(spec, arguments.options, each);
        });
    Json documents = Json::array();
    std::string text;
    for (const auto& described : many.results) {
        if (!described) continue;
        documents.push_back(described->document);
        text += (text.empty() ? "" : "\n") + described->text();
    }
    if (globals.json)
        printJson({{"format", "hshfit-infos"},
                   {"version", 1},
                   {"infos", documents},
                   {"failures", failuresJson(many.failures)}});
    else
        printText(text);
    reportFailures(many.failures, many.specs.size(), globals);
}

void runInfo(const InfoArguments& arguments, Globals& globals) {
    if (jobs::areMany(arguments.specs)) return infoMany(arguments, globals);
    const Described described =
        describe(arguments.specs[0], arguments.options, listenerFor(globals));
    if (globals.json)
        printJson(described.document);
    else
        printText(described.text());
}

constexpr ArgumentRow infoArguments[] = {
    required("SPEC", at<&InfoArguments::specs>,
             "BRDF, light, coefficient file or file of an export; one or more, and of a "
             "folder its measured and coefficient files",
             {.syntax = Syntax::either, .files = Files::read, .dash = ""}),
};

}  // namespace

CommandRows infoRows() {
    return {infoArguments, {jobs::infoOptions().rows}};
}

void addInfo(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<InfoArguments>();
    addArguments(command, infoArguments, *arguments);
    addOptions(command, jobs::infoOptions(), arguments->options);
    command.callback([arguments, &globals] { runInfo(*arguments, globals); });
}

}  // namespace hshfit::cli
