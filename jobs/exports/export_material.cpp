#include "export_material.h"

#include "preview_surface.h"
#include "sheen_colour.h"

#include <jobs/fits/fit.h>
#include <jobs/source/picture.h>
#include <jobs/source/source.h>

#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/extension.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/materials/glb.h>
#include <hshfit/materials/materialx.h>
#include <hshfit/materials/usd.h>
#include <hshfit/meshes/mesh_file.h>
#include <hshfit/pages/picture_error_json.h>
#include <hshfit/pictures/picture_strips.h>
#include <hshfit/pictures/poor.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>
#include <brdfs/fit/fit_json.h>
#include <brdfs/rows/spec.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <utility>

namespace hshfit::jobs {
namespace {

using Json = nlohmann::ordered_json;
using gpu::Target;

/// The input, as a specification, and the BRDF that the loss is measured against.
struct Input {
    std::string spec;    ///< canonical
    std::string fitTo;   ///< the specification that a fit takes
    std::string source;  ///< as named
    std::unique_ptr<Brdf> brdf;
    std::string reason;  ///< why there is none
};

/// The data of a fit, from its preset; empty for anything else.
std::string dataOf(const std::string& path) {
    std::error_code error;
    if (extensionOf(path) != ".json" || std::filesystem::file_size(path, error) > (1 << 20) ||
        error)
        return {};
    std::ifstream file(path, std::ios::binary);
    const Json json = Json::parse(file, nullptr, false);
    if (!json.is_object() || json.value("format", Json()) != "hshfit-preset" ||
        !json.contains("fit"))
        return {};
    const Json& fit = json["fit"];
    return fit.is_object() && fit.contains("data") && fit["data"].is_string()
               ? fit["data"].get<std::string>()
               : std::string();
}

std::string_view modelOf(std::string_view spec) {
    const std::string_view name = spec.substr(0, spec.find(':'));
    const bool sum = spec.find(" + ") != spec.npos;
    return !sum && (name == "gltf-pbr" || name == "openpbr") ? name : std::string_view();
}

Input openInput(const std::string& text, const MaterialExportOptions& options) {
    Input input;
    input.source = options.source;
    if (looksLikeCoefficients(text)) {
        if (input.source.empty()) input.source = readRepresentation(text).head.source;
        try {
            input.brdf = openBrdf(input.source, true);
        } catch (const Error& error) {
            if (!options.source.empty()) throw;
            throw InputError(fmt::format(
                "{}: the BRDF that a material would be fitted to does not open ({}); name it with "
                "{}",
                text, error.what(), Setting{"ExportOptions::source"}));
        }
        input.fitTo = input.source;
        input.spec = input.brdf->name();
        return input;
    }
    auto own = openBrdf(text, true);
    input.spec = own->name();
    input.fitTo = text;
    if (input.source.empty()) input.source = dataOf(text);
    if (input.source.empty() && modelOf(input.spec).empty()) {
        input.source = text;
        input.brdf = std::move(own);
    } else if (input.source.empty()) {
        input.reason = "the material is given by its parameters";
    } else {
        try {
            input.brdf = openSource(input.source, true);
        } catch (const Error& error) {
            if (!options.source.empty()) throw;
            input.reason = fmt::format("the data of the fit do not open ({}); name them with {}",
                                       error.what(), Setting{"ExportOptions::source"});
        }
    }
    return input;
}

/// The parameters of a specification of one model, with defaults.
Parameters parametersOf(const std::string& spec) {
    const std::string_view name = modelOf(spec);
    const auto row = std::ranges::find(brdfs::models(), name, &brdfs::Model::name);
    const std::string_view values =
        spec.size() > name.size() ? std::string_view(spec).substr(name.size() + 1) : "";
    return parseParameters(name, row->parameters, values);
}

MaterialColour colourOf(const Parameters& p, std::string_view name) {
    const std::vector<double> values = p.colour(name);
    return values.size() == 1 ? MaterialColour{values[0], values[0], values[0]}
                              : MaterialColour{values[0], values[1], values[2]};
}

/// Extensions at their defaults, which leave them out, are not written.
GltfMaterial gltfOf(const std::string& name, const Parameters& p) {
    GltfMaterial material{.name = name,
                          .baseColour = colourOf(p, "baseColorFactor"),
                          .metallic = p.number("metallicFactor"),
                          .roughness = p.number("roughnessFactor"),
                          .ior = {},
                          .specular = {},
                          .sheen = {},
                          .clearcoat = {},
                          .anisotropy = {},
                          .iridescence = {}};
    constexpr MaterialColour black{0, 0, 0}, white{1, 1, 1};
    if (p.number("ior") != 1.5) material.ior = p.number("ior");
    const GltfMaterial::Specular specular{p.number("specularFactor"),
                                          colourOf(p, "specularColorFactor")};
    if (specular.factor != 1 || specular.colour != white) material.specular = specular;
    const GltfMaterial::Sheen sheen{colourOf(p, "sheenColorFactor"),
                                    p.number("sheenRoughnessFactor")};
    if (sheen.colour != black) material.sheen = sheen;
    if (p.number("clearcoatFactor") > 0)
        material.clearcoat = {p.number("clearcoatFactor"), p.number("clearcoatRoughnessFactor")};
    if (p.number("anisotropyStrength") > 0)
        material.anisotropy = {p.number("anisotropyStrength"), p.number("anisotropyRotation")};
    if (p.number("iridescenceFactor") > 0)
        material.iridescence = {p.number("iridescenceFactor"), p.number("iridescenceIor"),
                                p.number("iridescenceThickness")};
    return material;
}

/// glTF's names for parameters of MaterialX's node gltf_pbr; `factor` is no part of them.
std::string nodeInput(std::string_view name) {
    static constexpr std::pair<std::string_view, std::string_view> renamed[] = {
        {"baseColorFactor", "base_color"},
        {"metallicFactor", "metallic"},
        {"roughnessFactor", "roughness"},
        {"specularFactor", "specular"},
        {"specularColorFactor", "specular_color"},
        {"sheenColorFactor", "sheen_color"},
        {"sheenRoughnessFactor", "sheen_roughness"},
        {"clearcoatFactor", "clearcoat"},
        {"clearcoatRoughnessFactor", "clearcoat_roughness"},
        {"anisotropyStrength", "anisotropy_strength"},
        {"anisotropyRotation", "anisotropy_rotation"},
        {"iridescenceFactor", "iridescence"},
        {"iridescenceIor", "iridescence_ior"},
        {"iridescenceThickness", "iridescence_thickness"}};
    for (const auto& [from, to] : renamed)
        if (from == name) return std::string(to);
    return std::string(name);
}

/// Inputs with other values than the model's defaults, or that the node does not share, the base in
/// any case, and all of a film, of which the node gltf_pbr has another thickness by default.
std::vector<MaterialXInput> inputsOf(std::string_view model, const Parameters& p) {
    const auto row = std::ranges::find(brdfs::models(), model, &brdfs::Model::name);
    std::vector<MaterialXInput> inputs;
    for (const Parameter& parameter : row->parameters) {
        const bool colour = parameter.kind == Parameter::Kind::colour;
        const bool optional = std::ranges::any_of(row->parts, [&](const brdfs::ModelPart& part) {
            const bool film = !part.with.empty() && p.number(part.parameters.front()) > 0;
            return !film &&
                   std::ranges::find(part.parameters, parameter.name) != part.parameters.end();
        });
        const std::vector<double> values = p.colour(parameter.name);
        if (optional && values == std::vector<double>{*parameter.fallback}) continue;
        if (parameter.name == "geometry_tangent") {
            inputs.push_back({"geometry_tangent", {degrees(values[0])}, true});
            if (p.number("coat_weight") > 0 && p.number("coat_roughness_anisotropy") > 0)
                inputs.push_back({"geometry_coat_tangent", {degrees(values[0])}, true});
            continue;
        }
        MaterialXInput input{nodeInput(parameter.name), values};
        if (colour && values.size() == 1) input.values.assign(3, values[0]);
        inputs.push_back(std::move(input));
    }
    return inputs;
}

std::string wantedModel(const std::string& target, const Input& input) {
    if (target != "materialx") return "gltf-pbr";
    const std::string_view own = modelOf(input.spec);
    return own.empty() ? "openpbr" : std::string(own);
}

bool hasTarget(const std::string& targets, std::string_view name) {
    return std::ranges::any_of(gpu::selectTargets(targets),
                               [&](const Target* target) { return target->name == name; });
}

/// Whether a target has the input as it is.
bool holds(const std::string& target, const Input& input) {
    if (modelOf(input.spec) != wantedModel(target, input)) return false;
    return target != "usd" || outsidePreview(parametersOf(input.spec)).empty();
}

/// The models that a target may have, of which the best fit is taken.
std::vector<PreviewModel> modelsFor(const std::string& target, const Input& input,
                                    const std::string& parts) {
    if (target == "usd") return previewModels(parts);
    return {{wantedModel(target, input), parts}};
}

/// The reason that a material whose sheen was given colours is poor, if it still is.
void restatePoor(ExportedMaterial& material) {
    const auto reason = poorReason(1 - material.loss->energyLeft.value, material.picture);
    if (reason)
        material.poor->reason = *reason;
    else
        material.poor.reset();
}

/// The material of a target: the input itself, or a fit to it.
ExportedMaterial materialFor(const std::string& target, const Input& input,
                             const MaterialExportOptions& options, const Listener& listener) {
    ExportedMaterial material;
    material.target = target;
    bool coloured = false;
    if (holds(target, input)) {
        material.spec = input.spec;
    } else {
        if (modelOf(input.spec) == "gltf-pbr")
            listener.say(fmt::format("{}: UsdPreviewSurface has no {}; fitted without", input.fitTo,
                                     fmt::join(outsidePreview(parametersOf(input.spec)), ", ")));
        std::optional<Fitted> best;
        for (const PreviewModel& each : modelsFor(target, input, options.parts)) {
            FitOptions how{.model = each.model};
            how.parts = each.parts;
            how.accept = true;
            how.rgb = true;
            how.advise = options.advise;
            Fitted fitted = fit(input.fitTo, "", how, listener);
            if (!best || fitted.result.loss < best->result.loss) best = std::move(fitted);
        }
        material.spec = brdfs::open(best->result.spec)->name();
        material.fitted = true;
        material.converged = best->result.converged;
        material.search = best->search;
        material.poor = best->poor;
        if (target == "gltf") {
            std::string spec = withColouredSheen(material.spec, *openBrdf(input.fitTo, true));
            coloured = spec != material.spec;
            material.spec = std::move(spec);
        }
    }
    if (!input.brdf) {
        material.reason = input.reason;
        return material;
    }
    const auto own = openBeside(material.spec, *input.brdf);
    if (own->channels().count() != input.brdf->channels().count())
        material.reason = "the source has other channels than the material";
    else {
        material.loss = summaryOf(*input.brdf, *own);
        material.picture = pictureErrorOf(*input.brdf, *own);
        if (material.poor && coloured) restatePoor(material);
    }
    return material;
}

Json statement(const ExportedMaterial& material, const std::string& source) {
    Json json = {{"spec", material.spec}};
    if (!source.empty()) json["source"] = source;
    json["loss"] = lossJson(material);
    return json;
}

std::string sentence(const ExportedMaterial& material, const std::string& source) {
    std::string text = fmt::format("{} by hshfit", material.spec);
    if (!material.loss) return text + fmt::format("; no loss stated: {}", material.reason);
    const PairSummary& loss = *material.loss;
    const Direction &wi = loss.at.wi, &wo = loss.at.wo;
    return text + fmt::format(
                      "; against {}: {}{}mean log error {:.4g}, largest error of f cos(theta_i) "
                      "{:.4g} at wi ({:.4g}, {:.4g}, {:.4g}), wo ({:.4g}, {:.4g}, {:.4g})",
                      source, material.picture ? summaryOf(*material.picture) : "",
                      material.picture ? ", " : "", loss.meanLog.value, loss.maximum, wi.x, wi.y,
                      wi.z, wo.x, wo.y, wo.z);
}

/// The text or bytes of a file, and its name.
void setContent(const ExportedMaterials& exported, const Surface& surface, const Input& input,
                ExportedMaterial& material) {
    const Parameters parameters = parametersOf(material.spec);
    const std::string materialX = exported.name + ".mtlx";
    const std::string said = sentence(material, input.source);
    if (material.target == "gltf") {
        material.path = exported.name + ".glb";
        const Json extras = {{"hshfit", statement(material, input.source)}};
        material.content = glbBytes(gltfOf(exported.name, parameters), surface, jsonText(extras));
    } else if (material.target == "usd") {
        material.path = exported.name + ".usda";
        material.content = usdText(exported.name, materialX, previewOf(parameters), surface, said);
    } else {
        const std::string_view model = modelOf(material.spec);
        material.path = materialX;
        material.content =
            materialXText(exported.name, model == "openpbr" ? "open_pbr_surface" : "gltf_pbr",
                          inputsOf(model, parameters), said);
    }
}

}  // namespace

std::string exportName(const std::string& input) {
    const std::string_view path = pathIn(input);
    if (!path.empty()) return std::filesystem::path(path).stem().string();
    const std::string_view preset = "preset:";
    if (input.starts_with(preset))
        return std::filesystem::path(input.substr(preset.size())).filename().string();
    return input.substr(0, input.find_first_of(": "));
}

bool areMaterials(const std::string& targets) {
    const auto chosen = gpu::selectTargets(targets);
    const auto isMaterial = [](const Target* target) {
        return target->kind == Target::Kind::material;
    };
    if (std::ranges::none_of(chosen, isMaterial)) return false;
    if (!std::ranges::all_of(chosen, isMaterial))
        throw UsageError(fmt::format(
            "'{}': gltf, materialx and usd are written apart from the other targets", targets));
    return true;
}

Json lossJson(const ExportedMaterial& material) {
    if (!material.loss) return {{"reason", material.reason}};
    const PairSummary& loss = *material.loss;
    const auto array = [](const Direction& d) { return Json::array({d.x, d.y, d.z}); };
    Json json = {{"metric", "mean |ln(1 + f cos(theta_i)) - ln(1 + g cos(theta_i))|"},
                 {"pairs", loss.pairs},
                 {"mean_log", loss.meanLog.value},
                 {"mean_log_error", loss.meanLog.error},
                 {"maximum",
                  {{"value", loss.maximum}, {"wi", array(loss.at.wi)}, {"wo", array(loss.at.wo)}}},
                 {"albedo",
                  {{"difference", loss.albedo.value},
                   {"of", loss.albedoThere},
                   {"theta_from", degrees(loss.albedoFrom)},
                   {"theta_to", degrees(loss.albedoTo)}}}};
    if (material.picture) json["picture"] = pictureErrorJson(*material.picture);
    return json;
}

Json materialsJson(const ExportedMaterials& exported, const std::string& folder) {
    Json document = {{"format", "hshfit-export-materials"},
                     {"version", 1},
                     {"folder", folder},
                     {"name", exported.name},
                     {"source", exported.source},
                     {"vertices", exported.vertices},
                     {"triangles", exported.triangles},
                     {"files", Json::array()}};
    for (const ExportedMaterial& file : exported.files) {
        Json json = {{"target", file.target}, {"path", file.path},
                     {"bytes", file.bytes},   {"spec", file.spec},
                     {"fitted", file.fitted}, {"converged", file.converged}};
        if (file.search) json["parts"] = brdfs::searchJson(*file.search);
        json["loss"] = lossJson(file);
        if (file.poor) json["poor"] = poorJson(*file.poor);
        if (!file.pictures.empty()) json["pictures"] = file.pictures;
        document["files"].push_back(std::move(json));
    }
    return document;
}

MaterialExportOptions withShared(const ExportOptions& shared, MaterialExportOptions own) {
    own.targets = shared.targets;
    own.name = shared.name;
    own.source = shared.source;
    own.force = shared.force;
    return own;
}

ExportedMaterials makeMaterials(const std::string& text, const MaterialExportOptions& options,
                                const Listener& listener) {
    if (!areMaterials(options.targets))
        throw UsageError(fmt::format("'{}': no standard material", options.targets));
    const Surface surface =
        options.mesh.empty() ? sphereSurface() : surfaceOf(readMesh(options.mesh).mesh);
    // A layer of text has nine times fewer triangles: the outline is off by an eight hundredth of
    // the radius.
    constexpr int ringsInText = 32;
    const Surface inText = options.mesh.empty() ? sphereSurface(ringsInText) : surface;
    if (hasTarget(options.targets, "usd")) {
        previewModels(options.parts);
        requireUsdPath((options.name.empty() ? exportName(text) : options.name) + ".mtlx");
    }
    const Input input = openInput(text, options);
    const Surface& told = hasTarget(options.targets, "gltf") ? surface : inText;
    ExportedMaterials exported{.name = options.name.empty() ? exportName(text) : options.name,
                               .source = input.source,
                               .vertices = told.positions.size(),
                               .triangles = told.indices.size() / 3,
                               .files = {}};
    for (const Target* target : gpu::selectTargets(options.targets)) {
        ExportedMaterial material = materialFor(target->name, input, options, listener);
        setContent(exported, target->name == "usd" ? inText : surface, input, material);
        if (material.picture)
            material.pictures = fmt::format("{}_{}.png", exported.name, target->name);
        material.bytes = material.content.size();
        exported.files.push_back(std::move(material));
    }
    if (input.brdf) requireReadable(*input.brdf);
    return exported;
}

ExportedMaterials exportMaterials(const std::string& text, const std::string& folder,
                                  const MaterialExportOptions& options, const Listener& listener) {
    FileSet files(folder, options.force);
    ExportedMaterials exported = makeMaterials(text, options, listener);
    std::vector<SpherePicture> source;
    for (const ExportedMaterial& material : exported.files) {
        files.write(material.path, material.content);
        if (material.pictures.empty()) continue;
        const auto brdf = openSource(exported.source, true);
        if (source.empty()) source = stripSpheres(*brdf);
        const auto own = stripSpheres(*openBeside(material.spec, *brdf));
        files.write(material.pictures, pngOf(pictureStrips(source, own)));
    }
    files.commit();
    return exported;
}

}  // namespace hshfit::jobs
