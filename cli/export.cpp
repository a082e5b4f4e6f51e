#include "command.h"
#include "export_lighting.h"
#include "export_map.h"
#include "export_material.h"

#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/pages/picture_error_json.h>

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
    std::vector<std::string> coefficients;
    std::string output, number, storage = "auto", packing = "coef4";
    std::string lighting;  ///< models; empty: none
    jobs::LightingTableOptions tables;
    bool chroma = false, noError = false, sampling = false, noSampling = false;
    jobs::ExportOptions options;
    jobs::MaterialExportOptions material;
    std::string wrap = "clamp";  ///< of maps of materials
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
        "weight {:.3g} times its mean, {:.2g} % wasted\n",
        proposal["bytes"].get<std::size_t>(), proposal["seconds"].get<double>(), variance, largest,
        100 * wasted);
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

/// Refuses options that do not go with the targets: materials have some of their own, and none of
/// those of coefficients.
void requireOptions(const CLI::App& command, bool materials) {
    constexpr std::string_view both[] = {"COEFFS",  "--output", "--target", "--name",    "--source",
                                         "--force", "--json",   "--quiet",  "--threads", "--help"};
    constexpr std::string_view own[] = {"--mesh", "--extensions"};
    for (const CLI::Option* option : command.get_options()) {
        const std::string name =
            option->get_lnames().empty() ? option->get_name() : "--" + option->get_lnames().front();
        const auto isIn = [&](const auto& names) {
            return std::ranges::find(names, name) != std::end(names);
        };
        if (option->count() == 0 || isIn(both) || isIn(own) == materials) continue;
        throw UsageError(fmt::format("export: {} is for {}", name,
                                     isIn(own) ? "the targets gltf and materialx"
                                               : "other targets than gltf and materialx"));
    }
}

bool isMap(const std::string& input) {
    return isMapSidecar(input) || isFilteredSidecar(input);
}

/// Refuses options that maps of materials do not have, and those that they alone have.
void requireMapOptions(const CLI::App& command, const std::vector<std::string>& inputs) {
    constexpr std::string_view those[] = {
        "COEFFS",  "--output", "--target",  "--name",   "--force", "--json",
        "--quiet", "--help",   "--threads", "--prefix", "--light", "--environment-order",
        "--wrap"};
    const auto map = std::ranges::find_if(inputs, isMap);
    if (map == inputs.end()) {
        if (command.get_option("--wrap")->count() > 0)
            throw UsageError("export: --wrap is for maps of materials");
        return;
    }
    for (const CLI::Option* option : command.get_options()) {
        const std::string name =
            option->get_lnames().empty() ? option->get_name() : "--" + option->get_lnames().front();
        if (option->count() > 0 && std::ranges::find(those, name) == std::end(those)) {
            throw UsageError(fmt::format("export: {} is for coefficients; {} is a map of materials",
                                         name, *map));
        }
        const bool light = name == "--light" || name == "--environment-order";
        if (light && option->count() > 0 && isFilteredSidecar(*map)) {
            throw UsageError(
                fmt::format("export: {}: {} is a map of filtered lobes, which take no "
                            "light of an environment",
                            name, *map));
        }
    }
}

/// The options of textures that maps share.
jobs::MapExportOptions mapOptions(const ExportArguments& arguments) {
    const jobs::ExportOptions& shared = arguments.options;
    jobs::MapExportOptions options{.name = shared.name,
                                   .prefix = shared.shader.prefix,
                                   .environmentOrder = shared.shader.environmentOrder,
                                   .wrap = arguments.wrap,
                                   .lights = shared.lights,
                                   .force = shared.force};
    if (shared.targets != jobs::ExportOptions().targets) options.targets = shared.targets;
    return options;
}

/// The options of textures that lighting shares.
void runLighting(const ExportArguments& arguments, const Globals& globals) {
    const jobs::ExportOptions& shared = arguments.options;
    jobs::LightingExportOptions options{.models = arguments.lighting,
                                        .targets = shared.targets,
                                        .name = shared.name,
                                        .source = shared.source,
                                        .prefix = shared.shader.prefix,
                                        .measureError = !arguments.noError,
                                        .force = shared.force};
    if (!arguments.number.empty()) options.number = gpu::parseNumber(arguments.number);
    options.errors.tables = arguments.tables;
    options.errors.tables.order = shared.shader.environmentOrder;
    if (!shared.lights.empty()) options.light = fmt::format("{}", fmt::join(shared.lights, "+"));
    // Errors under the light that is written, and under those of the catalog.
    options.errors.lights = jobs::catalogLights();
    if (!shared.lights.empty())
        options.errors.lights.insert(options.errors.lights.begin(), options.light);
    runExportLighting(arguments.coefficients[0], arguments.output, options, globals);
}

std::string answerText(const Json& answer) {
    if (isMapDocument(answer)) return mapDocumentText(answer);
    const Json picture = answer["fit_error"].value("picture", Json());
    return text(answer) +
           (picture.is_null() ? "" : "picture: " + summaryOf(pictureErrorFrom(picture)) + "\n") +
           (answer.contains("proposal") ? proposalText(answer["proposal"]) : "");
}

/// The answer for a coefficient file or a map of materials.
Json exported(const ExportArguments& arguments, const std::string& input, const std::string& folder,
              const jobs::Listener& listener) {
    if (isMap(input))
        return mapDocument(jobs::exportMap(input, folder, mapOptions(arguments), listener), folder);
    const jobs::Exported made =
        jobs::exportCoefficients(input, folder, arguments.options, listener);
    if (made.poor) listener.say(made.poor->line());
    return document(made, folder);
}

void exportOne(const ExportArguments& arguments, const Globals& globals) {
    const Json answer =
        exported(arguments, arguments.coefficients[0], arguments.output, listenerFor(globals));
    if (globals.json)
        printJson(answer);
    else
        printText(answerText(answer));
}

/// Every coefficient file to a folder of its own in the folder `-o`.
void exportMany(const ExportArguments& arguments, Globals& globals) {
    jobs::ExportPlaces places = jobs::exportPlaces(arguments.coefficients, arguments.output);
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

void runExport(ExportArguments& arguments, const CLI::App& command, Globals& globals) {
    jobs::ExportOptions& options = arguments.options;
    const bool materials = jobs::areMaterials(options.targets);
    requireOptions(command, materials);
    requireMapOptions(command, arguments.coefficients);
    const bool many = jobs::areMany(arguments.coefficients);
    if (many && (materials || !arguments.lighting.empty()))
        throw UsageError("export: the targets gltf and materialx and --lighting take one input");
    requirePrefiltered(command, arguments.lighting);
    if (!arguments.lighting.empty()) return runLighting(arguments, globals);
    if (materials) {
        jobs::MaterialExportOptions& material = arguments.material;
        material.targets = options.targets;
        material.name = options.name;
        material.source = options.source;
        material.force = options.force;
        return runMaterialExport(arguments.coefficients[0], arguments.output, material, globals);
    }
    if (!arguments.number.empty()) options.number = gpu::parseNumber(arguments.number);
    options.storage = gpu::parseStorage(arguments.storage);
    options.pack.packing = arguments.packing == "rgb" ? gpu::Packing::rgb : gpu::Packing::coef4;
    options.pack.luminanceChroma = arguments.chroma || options.pack.chromaOrder > 0;
    options.measureError = !arguments.noError;
    if (arguments.sampling || arguments.noSampling) options.sampling = arguments.sampling;
    many ? exportMany(arguments, globals) : exportOne(arguments, globals);
}

}  // namespace

void addExport(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ExportArguments>();
    jobs::ExportOptions& options = arguments->options;
    command
        .add_option(
            "COEFFS", arguments->coefficients,
            "Coefficient file of hshfit project, one or more, or a folder of them; material.json "
            "of hshfit svbrdf; for gltf, materialx and --lighting a BRDF too")
        ->required();
    command
        .add_option("-o,--output", arguments->output,
                    "Folder, made if absent; with many COEFFS, of one folder for each")
        ->required();
    command
        .add_option(
            "--target", options.targets,
            "all that is possible, or containers, languages, renderers, three and viewer from "
            "hshfit list targets; or gltf, materialx: a material fitted to the source")
        ->capture_default_str();
    command.add_option(
        "--outgoing", options.outgoing,
        "Outgoing set of the textures, WxH or N; other than COEFFS' own: projected "
        "anew (default: its own; the forms halfway and basis are exported as they are)");
    command
        .add_option("--basis", options.basis,
                    "With --outgoing, of the form halfway: what it is projected to")
        ->capture_default_str();
    command.add_option("--order", options.order, "With --basis")->capture_default_str();
    command.add_option("--name", options.name,
                       "What the files' names begin with (default: that of COEFFS)");
    command.add_option("--number", arguments->number,
                       "float16, float32, unorm16 or unorm8 (default: float16; for the "
                       "forms halfway and basis, the least that holds the file; with --lighting "
                       "float16 or float32 of the cube, by default float32 beyond 65504)");
    command
        .add_option("--storage", arguments->storage,
                    "Numbers of these forms in shaders: constants, block (one uniform block), "
                    "texture, or auto: texture above 4096 numbers, else constants")
        ->capture_default_str();
    command
        .add_option("--packing", arguments->packing,
                    "coef4: four coefficients a texel; rgb: one coefficient, its channels a texel")
        ->check(CLI::IsMember({"coef4", "rgb"}))
        ->capture_default_str();
    command.add_flag("--chroma", arguments->chroma, "Store luminance and chroma (Y, Co, Cg)");
    command.add_option("--chroma-order", options.pack.chromaOrder,
                       "Bands kept of the chroma; implies --chroma (default: all)");
    command.add_option("--basis-textures", options.pack.basisSize,
                       "Side of basis textures; without it shaders evaluate the basis");
    command
        .add_option("--environment-order", options.shader.environmentOrder,
                    "Bands of the SH environment that shaders' shade() takes; 0: no shade()")
        ->capture_default_str();
    command
        .add_option("--prefix", options.shader.prefix, "What every name in a shader begins with")
        ->capture_default_str();
    command.add_option("--source", options.source,
                       "BRDF that the error is measured against (default: as COEFFS says)");
    command.add_flag("--allow-loss", options.allowLoss,
                     "Accept an export more than twice as far from its source as COEFFS is");
    command.add_flag("--no-error", arguments->noError, "Do not measure the error");
    command.add_option(
        "--light", options.lights,
        "Environment of the viewer: a light of hshfit list lights, a picture, or a sum "
        "by '+'; repeated: several to choose from (default: studio)");
    command.add_option("--lighting", arguments->lighting,
                       "Tables, light and shaders for environments and area lights in place of "
                       "textures: all, or of coefficients, split-sum, ltc and prefiltered those "
                       "named; with --light the light that is written; shaders of materials that "
                       "are not isotropic take a tangent");
    addPrefiltered(command, arguments->tables);
    command.add_option("--library", options.library,
                       "Of the target three: where its page finds three.js, a path from the folder "
                       "or an address (default: ./node_modules/three)");
    auto* sampling = command.add_flag("--sampling", arguments->sampling,
                                      "Fit a proposal for path tracing: in the sidecar, and as "
                                      "sample() and pdf() in shaders (default: with shaders)");
    command.add_flag("--no-sampling", arguments->noSampling, "No proposal")->excludes(sampling);
    command
        .add_option("--wrap", arguments->wrap,
                    "Of a map of materials: what lies beyond its edge, clamp or repeat")
        ->check(CLI::IsMember({"clamp", "repeat"}))
        ->capture_default_str();
    command.add_flag("--zstd", options.zstd, "Compress KTX2 with Zstandard");
    command.add_flag("--force", options.force, "Replace files that are there");
    command.add_option("--mesh", arguments->material.mesh,
                       "With gltf: OBJ, PLY or glTF file, +y up (default: a sphere)");
    command
        .add_option("--extensions", arguments->material.parts,
                    "With gltf and materialx, of a fit: auto for the extensions (of OpenPBR: "
                    "lobes) that held-out directions find worth it, none, all, or names with "
                    "commas")
        ->capture_default_str();
    command.callback([arguments, &command, &globals] { runExport(*arguments, command, globals); });
}

}  // namespace hshfit::cli
