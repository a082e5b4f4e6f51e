#include "command.h"
#include "form_options.h"

#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/gpu/containers/containers.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/gpu/error_split.h>
#include <hshfit/gpu/shader.h>
#include <hshfit/gpu/viewer.h>
#include <hshfit/representation/forms/represented_brdf.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace hshfit::cli {
namespace {

using Json = nlohmann::ordered_json;
using gpu::Target;

struct ExportArguments {
    std::string coefficients, output, name, source, number = "float16", packing = "coef4";
    std::string targets = "bin,glsl-es", outgoing, basis = ExpandOptions{}.basis;
    int order = ExpandOptions{}.order;
    int basisTextures = 0, environmentOrder = gpu::ShaderOptions{}.environmentOrder;
    int chromaOrder = 0;
    std::string prefix = gpu::ShaderOptions{}.prefix;
    bool chroma = false, noError = false, zstd = false, force = false;
};

/// What the coefficients came from, if it can still be opened.
struct Source {
    std::unique_ptr<Brdf> brdf;
    std::string reason;  ///< why there is none
};

Source openSourceOf(const ExportArguments& arguments, const Coefficients& coefficients) {
    if (!arguments.source.empty()) return {brdfs::open(arguments.source), {}};
    try {
        return {brdfs::open(coefficients.source), {}};
    } catch (const Error& error) {
        return {nullptr,
                fmt::format("the source does not open ({}); name it with --source", error.what())};
    }
}

/// Coefficients per outgoing direction. Other forms, and files with a BRDF added, are projected
/// anew, and what that costs is part of the error that the export states.
Coefficients coefficientsOf(const ExportArguments& arguments, const Globals& globals) {
    const Representation stored = readRepresentation(arguments.coefficients);
    ExpandOptions options{.basis = arguments.basis, .order = arguments.order};
    std::optional<OutgoingSet> outgoing;
    if (!arguments.outgoing.empty()) outgoing = OutgoingSet::parse(arguments.outgoing);
    if (outgoing) options.outgoing = &*outgoing;
    Progress progress(globals, "project");
    options.projection.progress = progress.callback();
    if (stored.kind != Representation::Kind::outgoing || !stored.added.empty() || outgoing) {
        note(globals, fmt::format("{}: form {}{}; exported as coefficients per outgoing direction",
                                  arguments.coefficients, kindName(stored.kind),
                                  stored.added.empty() ? "" : " with " + stored.added));
    }
    return expand(stored, formOpener(), options);
}

/// The errors, or why there are none. A source that was named has to do.
Json errorsOf(const Source& source, const Coefficients& coefficients, const gpu::Payload& payload,
              const ExportArguments& arguments, const Globals& globals) {
    if (arguments.noError) return {{"reason", "not asked for"}};
    if (!source.brdf) return {{"reason", source.reason}};
    try {
        Progress progress(globals, "error");
        const gpu::ErrorSplit split =
            gpu::splitError(*source.brdf, coefficients, payload, {.progress = progress.callback()});
        return {{"metric", "rms of the difference times cos(theta_i), over that of f"},
                {"outgoing", split.outgoing},
                {"truncation", split.truncation},
                {"interpolation", split.interpolation},
                {"quantisation", split.quantisation},
                {"total", split.total},
                {"mean_log", split.meanLog}};
    } catch (const Error& error) {
        if (!arguments.source.empty()) throw;
        return {{"reason", error.what()}};
    }
}

std::string shaderFile(const std::string& name, const gpu::LanguageEntry& language,
                       const std::string& prefix) {
    const bool es = language.language == gpu::Language::glslEs;
    return fmt::format("{}_{}.{}{}", name, prefix, es ? "es." : "", language.extension);
}

/// Shaders and the viewer; the names of the files.
Json writeOthers(const std::vector<const Target*>& chosen, const gpu::Payload& payload,
                 const Source& material, const std::string& name, const ExportArguments& arguments,
                 const Globals& globals, FileSet& files) {
    Json written = Json::array();
    for (const gpu::LanguageEntry& language : gpu::languages()) {
        const bool wanted = std::ranges::any_of(chosen, [&](const Target* target) {
            return target->kind == Target::Kind::shader && target->name == language.name;
        });
        if (!wanted) continue;
        std::string source;
        try {
            source = gpu::shaderSource(
                language.language, payload,
                {.prefix = arguments.prefix, .environmentOrder = arguments.environmentOrder});
        } catch (const UsageError& error) {
            if (arguments.targets != "all") throw;
            note(globals, fmt::format("left out: {}", error.what()));
            continue;
        }
        const std::string file = shaderFile(name, language, arguments.prefix);
        files.write(file, source);
        written.push_back({{"role", "shader"}, {"target", language.name}, {"path", file}});
    }
    const bool viewer = std::ranges::any_of(
        chosen, [](const Target* target) { return target->kind == Target::Kind::viewer; });
    if (viewer) {
        Progress progress(globals, "viewer");
        const std::string file = name + "_viewer.html";
        files.write(file, gpu::viewerPage(
                              gpu::viewerInput(payload, material.brdf.get(), progress.callback())));
        written.push_back({{"role", "viewer"}, {"target", "viewer"}, {"path", file}});
    }
    return written;
}

Json describe(const gpu::Payload& payload) {
    const gpu::Texels& texels = payload.coefficients;
    Json document = {{"brdf", payload.source},
                     {"basis", payload.basis},
                     {"order", payload.order},
                     {"quantity", quantityName(payload.quantity)},
                     {"outgoing", payload.outgoing.spec()},
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

std::string text(const Json& document) {
    std::string out =
        fmt::format("{}: {} order {}, {}, {}, {} layers, {} bytes of texels\n",
                    document["folder"].get<std::string>(), document["basis"].get<std::string>(),
                    document["order"].get<int>(), document["outgoing"].get<std::string>(),
                    document["number"].get<std::string>(), document["layers"].get<std::size_t>(),
                    document["texel_bytes"].get<std::size_t>());
    for (const Json& file : document["files"])
        out += fmt::format("  {}\n", file["path"].get<std::string>());
    const Json& error = document["fit_error"];
    if (error.contains("reason")) {
        out += fmt::format("no error: {}\n", error["reason"].get<std::string>());
    } else {
        const auto percent = [&](const char* key) { return 100 * error[key].get<double>(); };
        out += fmt::format(
            "error against {}: {:.3g} % = truncation {:.3g} %, interpolation {:.3g} %, "
            "storage {:.3g} %; mean log {:.3g}\n",
            document["brdf"].get<std::string>(), percent("total"), percent("truncation"),
            percent("interpolation"), percent("quantisation"), error["mean_log"].get<double>());
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

gpu::PackOptions packOptions(const ExportArguments& arguments) {
    return {.number = gpu::parseNumber(arguments.number),
            .packing = arguments.packing == "rgb" ? gpu::Packing::rgb : gpu::Packing::coef4,
            .luminanceChroma = arguments.chroma || arguments.chromaOrder > 0,
            .chromaOrder = arguments.chromaOrder,
            .basisSize = arguments.basisTextures};
}

/// Before the error is measured; every file is looked at again when it is written.
void refuseToReplace(const ExportArguments& arguments, const std::string& name) {
    const auto sidecar = std::filesystem::path(arguments.output) / (name + ".hsh.json");
    std::error_code ignored;
    if (!arguments.force && std::filesystem::exists(sidecar, ignored)) {
        throw OutputError(
            fmt::format("'{}' exists; --force replaces the files of an export", sidecar.string()));
    }
}

void runExport(const ExportArguments& arguments, const Globals& globals) {
    const std::vector<const Target*> chosen = gpu::selectTargets(arguments.targets);
    const gpu::PackOptions options = packOptions(arguments);
    const Coefficients coefficients = coefficientsOf(arguments, globals);
    const gpu::Payload payload = gpu::pack(coefficients, options);
    const std::string name = arguments.name.empty()
                                 ? std::filesystem::path(arguments.coefficients).stem().string()
                                 : arguments.name;

    FileSet files(arguments.output, arguments.force);
    refuseToReplace(arguments, name);
    const Source source = openSourceOf(arguments, coefficients);
    const Json errors = errorsOf(source, coefficients, payload, arguments, globals);
    std::vector<const gpu::Container*> containers;
    for (const Target* target : chosen) {
        if (target->kind != Target::Kind::container) continue;
        const gpu::Container& container = gpu::findContainer(target->name);
        if (arguments.targets == "all" && !container.holds(options.number)) {
            note(globals,
                 fmt::format("left out: {} cannot hold {}", container.name, arguments.number));
        } else {
            containers.push_back(&container);
        }
    }

    Json document = {
        {"format", "hshfit-export"}, {"version", 1}, {"folder", arguments.output}, {"name", name}};
    document.update(describe(payload));
    document["fit_error"] = errors;
    document["files"] = Json::array({{{"role", "sidecar"}, {"path", name + ".hsh.json"}},
                                     {{"role", "test"}, {"path", name + "_test.json"}}});
    for (const gpu::ExportedFile& file : gpu::writeContainers(
             payload, containers, name,
             {.zstd = arguments.zstd,
             .fitError = errors.contains("reason") ? std::string() : errors.dump()},
             files)) {
        document["files"].push_back({{"role", gpu::roleName(file.role)},
                                     {"target", file.container},
                                     {"path", file.path},
                                     {"bytes", file.bytes},
                                     {"sha256", file.sha256}});
    }
    for (const Json& file : writeOthers(chosen, payload, source, name, arguments, globals, files))
        document["files"].push_back(file);
    files.commit();

    if (globals.json) {
        printJson(document);
    } else {
        printText(text(document));
    }
}

}  // namespace

void addExport(CLI::App& command, Globals& globals) {
    auto arguments = std::make_shared<ExportArguments>();
    command.add_option("COEFFS", arguments->coefficients, "Coefficient file of hshfit project")
        ->required();
    command.add_option("-o,--output", arguments->output, "Folder, made if absent")->required();
    command
        .add_option(
            "--target", arguments->targets,
            "all that is possible, or containers, languages, renderers and viewer from hshfit "
            "list targets")
        ->capture_default_str();
    command.add_option("--outgoing", arguments->outgoing,
                       "Outgoing set of the textures, WxH or N; other than COEFFS' own: projected "
                       "anew (default: its own; 16 or 16x16 for forms that have none)");
    command
        .add_option("--basis", arguments->basis, "For the form halfway: what it is projected to")
        ->capture_default_str();
    command.add_option("--order", arguments->order, "With --basis")->capture_default_str();
    command.add_option("--name", arguments->name,
                       "What the files' names begin with (default: that of COEFFS)");
    command.add_option("--number", arguments->number, "float16, float32, unorm16 or unorm8")
        ->capture_default_str();
    command
        .add_option("--packing", arguments->packing,
                    "coef4: four coefficients a texel; rgb: one coefficient, its channels a texel")
        ->check(CLI::IsMember({"coef4", "rgb"}))
        ->capture_default_str();
    command.add_flag("--chroma", arguments->chroma, "Store luminance and chroma (Y, Co, Cg)");
    command.add_option("--chroma-order", arguments->chromaOrder,
                       "Bands kept of the chroma; implies --chroma (default: all)");
    command.add_option("--basis-textures", arguments->basisTextures,
                       "Side of basis textures; without it shaders evaluate the basis");
    command
        .add_option("--environment-order", arguments->environmentOrder,
                    "Bands of the SH environment that shaders' shade() takes; 0: no shade()")
        ->capture_default_str();
    command.add_option("--prefix", arguments->prefix, "What every name in a shader begins with")
        ->capture_default_str();
    command.add_option("--source", arguments->source,
                       "BRDF that the error is measured against (default: as COEFFS says)");
    command.add_flag("--no-error", arguments->noError, "Do not measure the error");
    command.add_flag("--zstd", arguments->zstd, "Compress KTX2 with Zstandard");
    command.add_flag("--force", arguments->force, "Replace files that are there");
    command.callback([arguments, &globals] { runExport(*arguments, globals); });
}

}  // namespace hshfit::cli
