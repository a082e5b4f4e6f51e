#include "export.h"

#include <jobs/common/clock.h>
#include <jobs/source/picture.h>
#include <jobs/source/source.h>
#include "export_engine.h"
#include "export_loss.h"
#include "export_three.h"
#include "export_viewer.h"
#include "proposal.h"

#include <hshfit/brdf/transmission.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/filtered_maps/filtered_sidecar.h>
#include <hshfit/gpu/binaries/spirv_module.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/gpu/forms/form_files.h>
#include <hshfit/gpu/forms/form_table.h>
#include <hshfit/gpu/proposals/proposal_shader.h>
#include <hshfit/light/catalog.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/wording.h>

#include <brdfs/measured/mueller.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <utility>

namespace hshfit::jobs {
namespace {

using gpu::Target;
using Targets = std::vector<const Target*>;

/// The BRDF that the coefficients came from, if it can still be opened.
struct Source {
    std::unique_ptr<Brdf> brdf;
    std::string reason;  ///< why there is none
};

/// Throws InputError for a library, or the specification of a BRDF, in place of a file of
/// coefficients.
void requireCoefficients(const std::string& path) {
    if (extensionOf(path) == ".library")
        throw InputError(fmt::format(
            "{0}: is a library of materials; the action export of the command library writes one "
            "shader for all, and a projection of {0}:NAME in the halfway form is exported as such",
            path));
    if (path == "-" || std::filesystem::exists(path)) return;
    try {
        openBrdf(path, false, Sides::either);
    } catch (const std::exception&) {
        return;  // no BRDF: the path of a file that is missing
    }
    throw InputError(
        fmt::format("{}: is a BRDF; expected a file of coefficients, such as its projection in the "
                    "halfway form",
                    path));
}

Source openSourceOf(const ExportOptions& options, const CoefficientHead& coefficients) {
    if (!options.source.empty()) {
        Source named{openBrdf(options.source, false, Sides::either), {}};
        if (transmissionSide(named.brdf->name()) != transmissionSide(coefficients.source))
            throw UsageError(fmt::format("{}: {} is not of the side of {}",
                                         Setting{"ExportOptions::source"}, named.brdf->name(),
                                         coefficients.source));
        return named;
    }
    try {
        return {openBrdf(coefficients.source, false, Sides::either), {}};
    } catch (const Error& error) {
        return {nullptr, fmt::format("the source does not open ({}); name it with {}", error.what(),
                                     Setting{"ExportOptions::source"})};
    }
}

/// Coefficients per outgoing direction. Other forms, and files with a BRDF added, are projected
/// anew. The stated error of the export includes the loss of that projection.
struct Exportable {
    Coefficients coefficients;
    bool plain = true;  ///< a projection, with nothing done to it since
};
Exportable coefficientsOf(const Representation& stored, const std::string& path,
                          const ExportOptions& options, const Listener& listener) {
    const ExportOptions usual;
    if (stored.kind() != Representation::Kind::halfway &&
        (options.basis != usual.basis || options.order != usual.order))
        throw UsageError(
            fmt::format("basis and order are for the form halfway; {} has {} of order "
                        "{}, which an export keeps",
                        path, stored.head.basis, stored.head.order));
    ExpandOptions expansion{.basis = options.basis, .order = options.order};
    std::optional<OutgoingSet> outgoing;
    if (!options.outgoing.empty()) outgoing = OutgoingSet::parse(options.outgoing);
    if (outgoing) expansion.outgoing = &*outgoing;
    expansion.projection.progress = listener.part("project");
    if (stored.kind() != Representation::Kind::outgoing || !stored.added.empty() || outgoing) {
        listener.say(fmt::format("{}: form {}{}; exported as coefficients per outgoing direction",
                                 path, kindName(stored.kind()),
                                 stored.added.empty() ? "" : " with " + stored.added));
    }
    // Steps (a window, factors, bits) make of a projection something else.
    const bool plain = stored.kind() == Representation::Kind::outgoing && stored.steps.empty();
    return {expand(stored, sourceOpener(), expansion), plain};
}

/// The error that `measure` finds against the source, or the reason why there is none. A failure
/// of an explicitly named source is thrown.
template <class Measure>
ExportError errorBy(const Source& source, const ExportOptions& options, const Measure& measure) {
    if (!options.measureError) return {{}, "not asked for"};
    if (!source.brdf) return {{}, source.reason};
    try {
        return measure(*source.brdf);
    } catch (const Error& error) {
        if (!options.source.empty()) throw;
        return {{}, error.what()};
    }
}

/// An early check, before the error is measured. Writing checks every file again.
void refuseToReplace(const std::string& folder, const std::string& sidecar, bool force) {
    const auto path = std::filesystem::path(folder) / sidecar;
    std::error_code ignored;
    if (!force && std::filesystem::exists(path, ignored)) {
        throw OutputError(fmt::format("'{}' exists; {} replaces the files of an export",
                                      path.string(), Setting{"ExportOptions::force"}));
    }
}

std::vector<const gpu::Container*> containersOf(const Targets& chosen, const ExportOptions& options,
                                                gpu::Number number, const Listener& listener) {
    std::vector<const gpu::Container*> containers;
    for (const Target* target : chosen) {
        if (target->kind != Target::Kind::container) continue;
        const gpu::Container& container = gpu::findContainer(target->name);
        if (options.targets == "all" && !container.holds(number)) {
            listener.say(fmt::format("left out: {} cannot hold {}", container.name,
                                     gpu::numberName(number)));
        } else {
            containers.push_back(&container);
        }
    }
    return containers;
}

/// The shader of a language for what is exported.
std::string sourceOf(gpu::Language language, const Exported& exported,
                     const ExportOptions& options) {
    const std::string& prefix = options.shader.prefix;
    const bool cosine = !exported.form && exported.payload.head.quantity == Quantity::brdfCosine;
    std::string source =
        exported.form ? gpu::formShaderSource(language, *exported.form,
                                              {.prefix = prefix, .storage = exported.storage})
                      : gpu::shaderSource(language, exported.payload, options.shader);
    if (exported.proposal)
        source += gpu::proposalSource(language, *exported.proposal, {prefix, cosine});
    return source;
}

/// Fits a proposal to what the shaders evaluate to, if it is asked for.
void addProposal(const Targets& chosen, const ExportOptions& options, const Brdf& brdf,
                 Exported& exported) {
    const bool shaders = std::ranges::any_of(chosen, [](const Target* target) {
        return target->kind == Target::Kind::shader || target->kind == Target::Kind::binary;
    });
    if (!options.sampling.value_or(shaders)) return;
    const auto start = Clock::now();
    exported.proposal = proposalFor(brdf);
    exported.proposalSeconds = secondsSince(start);
}

std::string proposalTextOf(const Exported& exported) {
    return exported.proposal ? gpu::proposalText(*exported.proposal) : std::string();
}

/// f of the BRDF that a form adds, per channel, where it is a Lambert term, whose f is the same for
/// all directions. Empty where the form adds nothing, or anything else.
std::vector<double> constantOf(const Representation& form) {
    const std::string& spec = form.added;
    if (spec.substr(0, spec.find(':')) != "lambert" || spec.find('+') != std::string::npos)
        return {};
    const auto added = sourceOpener()(spec);
    const Direction up{0, 0, 1};
    std::vector<double> values(added->channels().count());
    added->eval(up, {&up.x, &up.y, &up.z, 1}, values.data());
    if (values.size() == 1) values.resize(form.head.channels.count(), values[0]);
    return values.size() == form.head.channels.count() ? values : std::vector<double>{};
}

void writeShaders(const Targets& chosen, const ExportOptions& options, const Listener& listener,
                  FileSet& files, Exported& exported) {
    for (const gpu::LanguageEntry& language : gpu::languages()) {
        const bool wanted = std::ranges::any_of(chosen, [&](const Target* target) {
            return target->kind == Target::Kind::shader && target->name == language.name;
        });
        if (!wanted) continue;
        std::string source;
        try {
            source = sourceOf(language.language, exported, options);
        } catch (const UsageError& error) {
            if (options.targets != "all") throw;
            listener.say(fmt::format("left out: {}", error.what()));
            continue;
        }
        const std::string file =
            gpu::shaderFileName(exported.name, language, options.shader.prefix);
        files.write(file, gpu::fileText(language.language, source,
                                        std::filesystem::path(file).stem().string()));
        exported.texts.push_back({"shader", std::string(language.name), file});
    }
}

/// The functions of the shader as SPIR-V, by the compiler that is linked, each with a file that
/// says how it is bound.
void writeSpirv(const Targets& chosen, const ExportOptions& options, const Listener& listener,
                FileSet& files, Exported& exported) {
    const auto target = std::ranges::find(chosen, Target::Kind::binary, &Target::kind);
    if (target == chosen.end()) return;
    const std::string& prefix = options.shader.prefix;
    try {
        const auto modules =
            exported.form
                ? gpu::spirvModules(*exported.form, {.prefix = prefix, .storage = exported.storage},
                                    exported.proposal)
                : gpu::spirvModules(exported.payload, prefix, exported.proposal);
        for (const gpu::SpirvModule& module : modules) {
            const std::string file =
                fmt::format("{}_{}{}.spv", exported.name, prefix,
                            module.function == "eval" ? "" : "_" + module.function);
            files.write(file, gpu::spirvBytes(module.words));
            files.write(file + ".json", gpu::moduleText(module, file));
            exported.texts.push_back({"binary", (*target)->name, file});
            exported.texts.push_back({"bindings", (*target)->name, file + ".json"});
        }
    } catch (const UsageError& error) {
        if (options.targets != "all") throw;
        listener.say(fmt::format("left out: {}", error.what()));
    }
}

/// The modules of engines, which look up environments for the source, or for what is exported.
void writeModules(const Targets& chosen, const Source& source, const Representation& shown,
                  const ExportOptions& options, const Listener& listener, FileSet& files,
                  Exported& exported) {
    std::unique_ptr<Brdf> again;
    for (const Target* target : chosen) {
        if (target->kind != Target::Kind::module) continue;
        if (!source.brdf && !again) again = reconstruct(shown, sourceOpener());
        const Brdf& brdf = source.brdf ? *source.brdf : *again;
        if (hasEngineFile(target->name))
            writeEngine(target->name, brdf, options, listener, files, exported);
        else
            writeThree(brdf, options, listener, files, exported);
    }
}

bool hasViewer(const Targets& chosen) {
    return std::ranges::any_of(
        chosen, [](const Target* target) { return target->kind == Target::Kind::viewer; });
}

/// Early, so that a wrong light costs no measurement.
std::vector<LightSpecification> lightsOf(const Targets& chosen, const ExportOptions& options) {
    const bool viewer = hasViewer(chosen);
    std::vector<LightSpecification> lights;
    for (const std::string& text : options.lights) lights.push_back(parseLights(text));
    if (!viewer && !lights.empty()) {
        throw UsageError(fmt::format("{} is for the target viewer, which is not among '{}'",
                                     Setting{"ExportOptions::lights"}, options.targets));
    }
    if (viewer && lights.empty()) lights.push_back(parseLights(std::string(studioKind().name)));
    return lights;
}

/// Throws UsageError for what only coefficients per outgoing direction have.
void requireFormOptions(const ExportOptions& options) {
    const ExportOptions plain;
    if (options.pack.packing != plain.pack.packing || options.pack.luminanceChroma ||
        options.pack.chromaOrder > 0 || options.pack.basisSize > 0 ||
        options.basis != plain.basis || options.order != plain.order ||
        options.shader.environmentOrder != plain.shader.environmentOrder) {
        throw UsageError(fmt::format(
            "basis, order, packing, chroma, basis textures and the light of shaders are for "
            "coefficients per outgoing direction, which {} makes of this form",
            Setting{"ExportOptions::outgoing"}));
    }
}

/// A form with a shader of its own, as it is.
void exportForm(const Representation& stored, const std::string& path, const std::string& folder,
                const Targets& chosen, const std::vector<LightSpecification>& lights,
                const ExportOptions& options, const Listener& listener, Exported& exported) {
    requireFormOptions(options);
    exported.form = gpu::packForm(stored, options.number);
    exported.form->constant = constantOf(stored);
    exported.storage = gpu::storageFor(*exported.form, options.storage);
    FileSet files(folder, options.force);
    refuseToReplace(folder, exported.sidecar, options.force);
    const Source source = openSourceOf(options, stored.head);
    exported.error = errorBy(source, options, [&](const Brdf& brdf) {
        const auto again = reconstruct(exported.form->form, sourceOpener());
        return ExportError{{}, {}, exportLoss(brdf, stored, *again), pictureErrorOf(brdf, *again)};
    });
    if (exported.error.loss && !options.allowLoss) {
        refuseLoss(*exported.error.loss, path,
                   options.number ? std::optional(Setting{"PackOptions::number"}) : std::nullopt);
    }
    if (exported.error.picture)
        exported.poor = judge(stored, {}, exported.error.picture, *source.brdf, path);
    addProposal(chosen, options, *reconstruct(exported.form->form, sourceOpener()), exported);
    exported.textures = gpu::writeForm(
        *exported.form, containersOf(chosen, options, exported.form->texels.number, listener),
        exported.name,
        {.zstd = options.zstd,
         .fitError = exported.error.loss ? jsonText(errorJson(exported.error)) : std::string(),
         .proposal = proposalTextOf(exported)},
        sourceOpener(), files);
    writeShaders(chosen, options, listener, files, exported);
    writeSpirv(chosen, options, listener, files, exported);
    writeModules(chosen, source, exported.form->form, options, listener, files, exported);
    writeViewer(stored, source.brdf.get(), lights, options, listener, files, exported);
    files.commit();
}

/// The targets for what is exported: those that draw lit surfaces take reflections.
Targets targetsFor(const Representation& stored, const ExportOptions& options,
                   const Listener& listener) {
    Targets chosen = gpu::selectTargets(options.targets);
    if (std::ranges::find(chosen, Target::Kind::mips, &Target::kind) != chosen.end())
        throw UsageError("the target mips takes a map of materials, which svbrdf writes");
    if (transmissionSide(stored.head.source).empty()) return chosen;
    std::erase_if(chosen, [&](const Target* target) {
        if (target->kind != Target::Kind::viewer && target->kind != Target::Kind::module)
            return false;
        const std::string why = fmt::format(
            "{} draws reflecting surfaces, and {} is a transmission; expected textures and shaders",
            target->name, stored.head.source);
        // The textures and shaders of an engine stay.
        if (options.targets != "all" && !hasEngineFile(target->name)) throw UsageError(why);
        listener.say("left out: " + why);
        return true;
    });
    return chosen;
}

}  // namespace

nlohmann::ordered_json errorJson(const ExportError& error) {
    nlohmann::ordered_json json;
    if (error.loss) {
        json = {{"metric", "mean |ln(1 + f cos(theta_i)) - ln(1 + g cos(theta_i))|"},
                {"pairs", error.loss->pairs},
                {"file", error.loss->file},
                {"mean_log", error.loss->exported}};
    } else if (error.split) {
        const gpu::ErrorSplit& split = *error.split;
        json = {{"metric", "rms of the difference times cos(theta_i), over that of f"},
                {"outgoing", split.outgoing},
                {"truncation", split.truncation},
                {"interpolation", split.interpolation},
                {"form", split.form},
                {"quantisation", split.quantisation},
                {"total", split.total},
                {"mean_log", split.meanLog}};
    } else {
        return {{"reason", error.reason}};
    }
    if (error.picture) json["picture"] = pictureErrorJson(*error.picture);
    return json;
}

Exported exportCoefficients(const std::string& path, const std::string& folder,
                            const ExportOptions& options, const Listener& listener) {
    gpu::selectTargets(options.targets);  // a word that is none fails before any file is opened
    if (isFilteredSidecar(path)) {
        throw UsageError(fmt::format(
            "{}: a map of normals and directions has no coefficients; those of a texel, "
            "projected as {}:x=0,y=0,level=0, are exported",
            path, path));
    }
    requireCoefficients(path);
    const Representation stored = readRepresentation(path);
    brdfs::requireReflectance(path, stored.head.channels, "export");
    const Targets chosen = targetsFor(stored, options, listener);
    const std::vector<LightSpecification> lights = lightsOf(chosen, options);
    Exported exported;
    exported.name =
        options.name.empty() ? std::filesystem::path(path).stem().string() : options.name;
    exported.sidecar = exported.name + ".hsh.json";
    exported.test = exported.name + "_test.json";
    if (gpu::hasShader(stored, !constantOf(stored).empty()) && options.outgoing.empty()) {
        exportForm(stored, path, folder, chosen, lights, options, listener, exported);
        return exported;
    }
    if (options.storage != gpu::Storage::automatic) {
        throw UsageError(fmt::format("{} is for forms that have a shader of their own",
                                     Setting{"ExportOptions::storage"}));
    }
    const Exportable given = coefficientsOf(stored, path, options, listener);
    const Coefficients& coefficients = given.coefficients;
    gpu::PackOptions pack = options.pack;
    pack.number = options.number.value_or(pack.number);
    pack.luminanceChroma |= pack.chromaOrder > 0;
    exported.payload = gpu::pack(coefficients, pack);

    FileSet files(folder, options.force);
    refuseToReplace(folder, exported.sidecar, options.force);
    const Source source = openSourceOf(options, coefficients);
    exported.error = errorBy(source, options, [&](const Brdf& brdf) {
        return ExportError{
            gpu::splitError(brdf, coefficients, exported.payload,
                            {.plain = given.plain, .progress = listener.part("error")}),
            {},
            {},
            pictureErrorOf(brdf, Reconstruction(gpu::unpack(exported.payload)))};
    });
    const bool anew = stored.kind() != Representation::Kind::outgoing || !stored.added.empty();
    if (exported.error.split && anew && !options.allowLoss) {
        const auto again =
            reconstruct(fromCoefficients(gpu::unpack(exported.payload)), sourceOpener());
        refuseLoss(exportLoss(*source.brdf, stored, *again), path,
                   options.outgoing.empty() ? std::nullopt
                                            : std::optional(Setting{"ExportOptions::outgoing"}));
    }
    if (exported.error.split)
        exported.poor = judge(*exported.error.split, exported.error.picture, exported.payload,
                              *source.brdf, path, folder);
    addProposal(chosen, options, Reconstruction(gpu::unpack(exported.payload)), exported);
    exported.textures = gpu::writeContainers(
        exported.payload, containersOf(chosen, options, pack.number, listener), exported.name,
        {.zstd = options.zstd,
         .fitError = exported.error.split ? jsonText(errorJson(exported.error)) : std::string(),
         .proposal = proposalTextOf(exported)},
        files);
    writeShaders(chosen, options, listener, files, exported);
    writeSpirv(chosen, options, listener, files, exported);
    writeModules(chosen, source, stored, options, listener, files, exported);
    writeViewer(stored, source.brdf.get(), lights, options, listener, files, exported);
    files.commit();
    return exported;
}

ExportPlaces exportPlaces(const std::vector<std::string>& inputs, const std::string& folder) {
    ExportPlaces places{.inputs = expandInputs(inputs, Members::coefficients), .folders = {}};
    places.folders = outputPaths(places.inputs, folder, "");
    requireFolder(folder);
    return places;
}

}  // namespace hshfit::jobs
