#include "command.h"
#include "command_rows.h"
#include "export_lighting.h"
#include "export_map.h"
#include "export_material.h"
#include "job_options.h"

#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/library_maps/library_sidecar.h>
#include <hshfit/light/catalog.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/percent.h>
#include <hshfit/wings.h>

#include <jobs/common/many.h>
#include <jobs/exports/export.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ExportArguments {
    std::vector<std::string> inputs;
    std::string output;
    jobs::ExportOptions options;
    // Each has the options of its own; options that it shares are in `options`.
    jobs::LightingExportOptions lighting{.models = {}};  ///< none
    jobs::MaterialExportOptions material;
    jobs::MapExportOptions map;
};

Json describe(const gpu::Payload& payload) {
    const gpu::Texels& texels = payload.coefficients;
    Json document = {{"brdf", payload.head.source},
                     {"basis", payload.head.basis},
                     {"order", payload.head.order},
                     {"quantity", quantityName(payload.head.quantity)},
                     {"outgoing", payload.head.outgoing.spec()},
                     {"number", gpu::numberName(texels.number)},
                     {"packing", gpu::packingName(payload.packing)},
                     {"stored_channels", Json::array()},
                     {"functions", payload.slots.size()},
                     {"layers", texels.layers},
                     {"texel_bytes", texels.bytes.size()}};
    for (const gpu::StoredChannel& channel : payload.stored)
        document["stored_channels"].push_back(
            {{"name", channel.name}, {"functions", channel.slots}});
    if (const auto basis = gpu::basisTextureError(payload)) {
        document["basis_textures"] = {{"size", payload.basisTexels->width},
                                      {"largest_error", basis->largest},
                                      {"largest_error_above_6_degrees", basis->largestAbove6},
                                      {"rms_error", basis->rms}};
    }
    return document;
}

Json describeExportedForm(const jobs::Exported& exported) {
    const gpu::FormPayload& payload = *exported.form;
    return {{"brdf", payload.form.head.source},
            {"form", kindName(payload.form.kind())},
            {"channels", payload.form.head.channels.names()},
            {"number", gpu::numberName(payload.texels.number)},
            {"storage", gpu::storageName(exported.storage)},
            {"numbers", payload.form.numbers()},
            {"bytes", payload.form.bytes()},
            {"texel_bytes", payload.texels.bytes.size()}};
}

std::string exportedFormText(const Json& document) {
    std::string out = fmt::format(
        "{}: form {}, {} numbers in {} bytes, texels of {} in {} bytes; shaders with {}\n",
        document["folder"].get<std::string>(), document["form"].get<std::string>(),
        document["numbers"].get<std::size_t>(), document["bytes"].get<std::size_t>(),
        document["number"].get<std::string>(), document["texel_bytes"].get<std::size_t>(),
        document["storage"].get<std::string>());
    for (const Json& file : document["files"])
        out += fmt::format("  {}\n", file["path"].get<std::string>());
    const Json& error = document["fit_error"];
    if (error.contains("reason"))
        return out + fmt::format("no error: {}\n", error["reason"].get<std::string>());
    return out + fmt::format("mean log error against {}: {:.3g}, of the file {:.3g}\n",
                             document["brdf"].get<std::string>(), error["mean_log"].get<double>(),
                             error["file"].get<double>());
}

std::string text(const Json& document) {
    if (document.contains("form")) return exportedFormText(document);
    std::string out =
        fmt::format("{}: {} order {}, {}, {}, {} layers, {} bytes of texels\n",
                    document["folder"].get<std::string>(), document["basis"].get<std::string>(),
                    document["order"].get<int>(), document["outgoing"].get<std::string>(),
                    document["number"].get<std::string>(), document["layers"].get<std::size_t>(),
                    document["texel_bytes"].get<std::size_t>());
    for (const Json& file : document["files"])
        out += fmt::format("  {}\n", file["path"].get<std::string>());
    for (const Json& light : document.value("lights", Json::array())) {
        out += fmt::format(
            "  light {}: {} bands{}, picture of {} bytes, within {:.2g} %\n",
            light["light"].get<std::string>(), light["bands"].get<int>(),
            light["captured"].is_null() ? std::string()
                                        : fmt::format(" have {:.3g} % of its energy",
                                                      100 * light["captured"].get<double>()),
            light["picture_bytes"].get<std::size_t>(), 100 * light["picture_error"].get<double>());
    }
    const Json& error = document["fit_error"];
    if (error.contains("reason")) {
        out += fmt::format("no error: {}\n", error["reason"].get<std::string>());
    } else {
        const auto percent = [&](const char* key) { return 100 * error[key].get<double>(); };
        out += fmt::format(
            "error against {}: {:.3g} % = truncation {:.3g} %, interpolation {:.3g} %{}, "
            "storage {:.3g} %; mean log {:.3g}\n",
            document["brdf"].get<std::string>(), percent("total"), percent("truncation"),
            percent("interpolation"),
            percent("form") > 0 ? fmt::format(", form {:.3g} %", percent("form")) : "",
            percent("quantisation"), error["mean_log"].get<double>());
    }
    if (document.contains("basis_textures")) {
        const Json& basis = document["basis_textures"];
        out += fmt::format(
            "basis textures {0}x{0}: error at most {1:.3g}, {2:.3g} above 6 degrees, rms {3:.3g}\n",
            basis["size"].get<int>(), basis["largest_error"].get<double>(),
            basis["largest_error_above_6_degrees"].get<double>(), basis["rms_error"].get<double>());
    }
    return out;
}

/// The largest values over elevations, which `efficiency` has one by one.
Json proposalJson(const jobs::Exported& exported) {
    Json rows = Json::array();
    for (const gpu::ProposalRow& row : exported.proposal->rows) {
        const Efficiency& e = row.efficiency;
        rows.push_back({{"theta", degrees(polarAngle(e.wo))},
                        {"albedo", row.albedo ? Json(*row.albedo) : Json(nullptr)},
                        {"estimate", e.albedo},
                        {"variance", e.variance},
                        {"largest", e.largest},
                        {"wasted", e.wasted}});
    }
    return {{"rows", exported.proposal->proposal.rows.size()},
            {"bytes", exported.proposal->proposal.bytes()},
            {"seconds", exported.proposalSeconds},
            {"efficiency", rows}};
}

std::string proposalText(const Json& proposal) {
    double variance = 0, largest = 0, wasted = 0;
    for (const Json& row : proposal["efficiency"]) {
        variance = std::max(variance, row["variance"].get<double>());
        largest = std::max(largest, row["largest"].get<double>());
        wasted = std::max(wasted, row["wasted"].get<double>());
    }
    return fmt::format(
        "sampling: proposal of {} bytes in {:.2g} s; at most, from 0 to 85 degrees, variance "
        "{:.2g}, "
        "weight {:.3g} times its mean, {} wasted\n",
        proposal["bytes"].get<std::size_t>(), proposal["seconds"].get<double>(), variance, largest,
        hshfit::percent(wasted, 2));
}

Json document(const jobs::Exported& exported, const std::string& folder) {
    Json document = {
        {"format", "hshfit-export"}, {"version", 1}, {"folder", folder}, {"name", exported.name}};
    document.update(exported.form ? describeExportedForm(exported) : describe(exported.payload));
    document["fit_error"] = jobs::errorJson(exported.error);
    if (exported.poor) document["poor"] = jobs::poorJson(*exported.poor);
    if (exported.proposal) document["proposal"] = proposalJson(exported);
    document["files"] = Json::array({{{"role", "sidecar"}, {"path", exported.sidecar}},
                                     {{"role", "test"}, {"path", exported.test}}});
    for (const gpu::ViewerLight& light : exported.lights) {
        document["lights"].push_back(
            {{"light", light.name},
             {"bands", light.coefficients.order},
             {"captured", std::isfinite(light.captured) ? Json(light.captured) : Json()},
             {"picture_bytes", light.rgbe.size()},
             {"picture_error", light.pictureError}});
    }
    for (const gpu::ExportedFile& file : exported.textures) {
        document["files"].push_back({{"role", gpu::roleName(file.role)},
                                     {"target", file.container},
                                     {"path", file.path},
                                     {"bytes", file.bytes},
                                     {"sha256", file.sha256}});
    }
    for (const jobs::ExportedText& file : exported.texts) {
        document["files"].push_back(
            {{"role", file.role}, {"target", file.target}, {"path", file.path}});
    }
    return document;
}

bool isMap(const std::string& input) {
    return isMapSidecar(input) || isFilteredSidecar(input) || isLibrarySidecar(input);
}

/// A kind of export (OptionRow::inputs) as messages name it.
struct Kind {
    unsigned bit;
    std::string_view name;
};
constexpr Kind kinds[] = {{jobs::exports::coefficients, "coefficients"},
                          {jobs::exports::materials, "the targets gltf, materialx and usd"},
                          {jobs::exports::maps, "maps of materials"},
                          {jobs::exports::lighting, "--lighting"}};

unsigned kindOf(const ExportArguments& arguments) {
    namespace exports = jobs::exports;
    if (jobs::areMaterials(arguments.options.targets)) return exports::materials;
    if (!arguments.lighting.models.empty()) return exports::lighting;
    return std::ranges::any_of(arguments.inputs, isMap) ? exports::maps : exports::coefficients;
}

/// Refuses options that are for other kinds of exports.
void requireOptions(const CLI::App& command, const ExportArguments& arguments, unsigned kind) {
    std::vector<std::string_view> names;
    for (const auto rows : exportRows().options) {
        const auto given = misplacedOption(command, rows, kind);
        if (!given) continue;
        for (const Kind& each : kinds)
            if (given->row->inputs & each.bit) names.push_back(each.name);
        throw UsageError(fmt::format("export: {} is for {}, not for {}", given->name,
                                     fmt::join(names, " and "),
                                     std::ranges::find(kinds, kind, &Kind::bit)->name));
    }
    if (kind != jobs::exports::maps) return;
    const auto filtered = std::ranges::find_if(arguments.inputs, [](const std::string& input) {
        return isFilteredSidecar(input) || isLibrarySidecar(input);
    });
    for (const char* name : {"--light", "--environment-order"})
        if (filtered != arguments.inputs.end() && command.get_option(name)->count() > 0)
            throw UsageError(fmt::format(
                "export: {}: {} is a map {}, which take no light of an environment", name,
                *filtered,
                isLibrarySidecar(*filtered) ? "of materials in a library" : "of filtered lobes"));
}

/// The options of textures that maps share.
jobs::MapExportOptions mapOptions(const ExportArguments& arguments) {
    const jobs::ExportOptions& shared = arguments.options;
    jobs::MapExportOptions options = arguments.map;
    options.name = shared.name;
    options.prefix = shared.shader.prefix;
    options.environmentOrder = shared.shader.environmentOrder;
    options.lights = shared.lights;
    options.force = shared.force;
    if (shared.targets != jobs::ExportOptions().targets) options.targets = shared.targets;
    return options;
}

std::string answerText(const Json& answer) {
    if constexpr (isBuilt(Wing::maps))
        if (isMapDocument(answer)) return mapDocumentText(answer);
    const Json picture = answer["fit_error"].value("picture", Json());
    return text(answer) +
           (picture.is_null() ? "" : "picture: " + summaryOf(pictureErrorFrom(picture)) + "\n") +
           (answer.contains("proposal") ? proposalText(answer["proposal"]) : "");
}

/// The answer for a coefficient file or a map of materials.
Json exported(const ExportArguments& arguments, const std::string& input, const std::string& folder,
              const jobs::Listener& listener) {
    if (isMap(input)) {
        if constexpr (isBuilt(Wing::maps))
            return mapDocument(jobs::exportMap(input, folder, mapOptions(arguments), listener),
                               folder);
        throw UsageError(notBuilt(input, Wing::maps));
    }
    const jobs::Exported made =
        jobs::exportCoefficients(input, folder, arguments.options, listener);
    if (made.poor) listener.say(made.poor->line());
    return document(made, folder);
}

void exportOne(const ExportArguments& arguments, const Globals& globals) {
    const Json answer =
        exported(arguments, arguments.inputs[0], arguments.output, listenerFor(globals));
    if (globals.json)
        printJson(answer);
    else
        printText(answerText(answer));
}

/// Every coefficient file to a folder of its own in the folder `-o`.
void exportMany(const ExportArguments& arguments, Globals& globals) {
    jobs::ExportPlaces places = jobs::exportPlaces(arguments.inputs, arguments.output);
    const auto many = jobs::makeMany<Json>(
        std::move(places.inputs), std::move(places.folders), "export", listenerFor(globals),
        [&](const std::string& input, const std::string& folder, const jobs::Listener& each) {
            return exported(arguments, input, folder, each);
        });
    Json documents = Json::array();
    std::string lines;
    for (const std::string& kept : many.kept) lines += jobs::keptLine(kept) + "\n";
    for (const auto& answer : many.results) {
        if (!answer) continue;
        documents.push_back(*answer);
        lines += answerText(*answer);
    }
    if (globals.json)
        printJson({{"format", "hshfit-exports"},
                   {"version", 1},
                   {"exports", documents},
                   {"kept", many.kept},
                   {"failures", failuresJson(many.failures)}});
    else
        printText(lines);
    reportFailures(many.failures, many.specs.size() + many.kept.size(), globals);
}

void runExport(const ExportArguments& arguments, const CLI::App& command, Globals& globals) {
    namespace exports = jobs::exports;
    const unsigned kind = kindOf(arguments);
    requireOptions(command, arguments, kind);
    const bool many = jobs::areMany(arguments.inputs);
    if (many && (kind == exports::materials || kind == exports::lighting))
        throw UsageError(
            "export: the targets gltf, materialx and usd and --lighting take one input");
    if (kind == exports::lighting) {
        requirePrefiltered(command, arguments.lighting.models);
        return runExportLighting(arguments.inputs[0], arguments.output,
                                 withShared(arguments.options, arguments.lighting), globals);
    }
    if (kind == exports::materials)
        return runMaterialExport(arguments.inputs[0], arguments.output,
                                 withShared(arguments.options, arguments.material), globals);
    many ? exportMany(arguments, globals) : exportOne(arguments, globals);
}

constexpr ArgumentRow exportArguments[] = {
    required("COEFFS", at<&ExportArguments::inputs>,
             "Coefficient file of hshfit project, one or more, or a folder of them; material.json "
             "of hshfit svbrdf; for gltf, materialx, usd and --lighting a BRDF too",
             brdfRead),
    requiredOutput(at<&ExportArguments::output>,
                   "Folder, made if absent; with many COEFFS, of one folder for each",
                   {.files = Files::folder}),
};

}  // namespace

CommandRows exportRows() {
    return {exportArguments,
            {jobs::exportOptions().rows, jobs::lightingExportOptions().rows,
             jobs::mapExportOptions().rows, jobs::materialExportOptions().rows}};
}

void addExport(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ExportArguments>();
    addArguments(command, exportArguments, *arguments);
    addOptions(command, jobs::exportOptions(), arguments->options);
    addOptions(command, jobs::lightingExportOptions(), arguments->lighting);
    addOptions(command, jobs::mapExportOptions(), arguments->map);
    addOptions(command, jobs::materialExportOptions(), arguments->material);
    command.callback([arguments, &command, &globals] { runExport(*arguments, command, globals); });
}

}  // namespace hshfit::cli
