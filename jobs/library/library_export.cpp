#include "library_export.h"

#include "library_sampling.h"

#include <jobs/exports/export_three.h>

#include <hshfit/each_in_parallel.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/containers/sidecar.h>
#include <hshfit/gpu/containers/targets.h>
#include <hshfit/gpu/forms/library_shader.h>
#include <hshfit/gpu/proposals/proposal_shader.h>
#include <hshfit/material_library/library_file.h>
#include <hshfit/material_library/log_terms.h>
#include <hshfit/material_library/shared_functions.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/sampling/efficiency.h>
#include <hshfit/version.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

namespace hshfit::jobs {
namespace {

namespace ml = material_library;
using Json = nlohmann::ordered_json;

/// The most materials whose values are among the tests, and the most of which pictures are drawn.
constexpr std::size_t testedMaterials = 8, drawnMaterials = 64;

gpu::SharedSums sumsOf(const ml::Library& library, ExportedLibrary& exported) {
    gpu::SharedSums sums{.functions = ml::sharedFunctions(library.basis),
                         .offset = ml::logOffset,
                         .topFirst = std::log(ml::logOffset),
                         .topStep = 1 / ml::topsPerLog,
                         .parts = {},
                         .materials = {}};
    for (const auto& [function, scale] : ml::texelParts(library.basis))
        sums.parts.push_back({function, scale});
    for (const ml::Material& material : library.materials) {
        if (material.kind != ml::Kind::coded) {
            exported.leftOut.push_back(material.name);
            continue;
        }
        exported.materials.push_back(material.name);
        const std::vector<double> row = ml::texelsOf(library.basis, material);
        sums.materials.insert(sums.materials.end(), row.begin(), row.end());
    }
    exported.components = library.basis.size();
    return sums;
}

Json array(const Direction& d) {
    return {d.x, d.y, d.z};
}

/// A material as its shader gives it.
std::unique_ptr<Brdf> brdfOf(const ml::Library& library, const ExportedLibrary& exported,
                             const gpu::SharedSums& sums, std::size_t n) {
    if (sums.table) return std::make_unique<gpu::TabledBrdf>(sums, n);
    return ml::open(library, *ml::find(library, exported.materials[n]), "material");
}

/// The bytes of a table, and the error of f by it.
ExportedTable tableOf(const ml::Library& library, const ExportedLibrary& exported,
                      const gpu::TabledLibrary& tabled) {
    ExportedTable table{.size = tabled.sums.table->size(),
                        .bytes = tabled.sums.table->texels().bytes.size(),
                        .error = tabled.error};
    const std::size_t count = exported.materials.size(), drawn = std::min(count, drawnMaterials);
    std::vector<double> flips(drawn);
    const auto material = [&](std::size_t n) { return n * count / drawn; };
    eachInParallel(drawn, [&](std::size_t n) {
        const ml::Material& exact = *ml::find(library, exported.materials[material(n)]);
        flips[n] = pictureError(*ml::open(library, exact, exact.name),
                                gpu::TabledBrdf(tabled.sums, material(n)))
                       .flip.mean;
    });
    for (std::size_t n = 0; n < drawn; ++n) {
        table.flip += flips[n] / static_cast<double>(drawn);
        if (flips[n] < table.largestFlip) continue;
        table.largestFlip = flips[n];
        table.material = exported.materials[material(n)];
    }
    return table;
}

/// f of the first materials in pairs from the mirror direction to grazing ones.
Json testsOf(const ml::Library& library, const ExportedLibrary& exported,
             const gpu::SharedSums& sums) {
    Json tests = Json::array();
    for (std::size_t n = 0; n < std::min(testedMaterials, exported.materials.size()); ++n) {
        const auto brdf = brdfOf(library, exported, sums, n);
        for (const auto& [in, out, phi] :
             {std::array{0., 0., 0.}, std::array{30., 30., 180.}, std::array{45., 50., 170.},
              std::array{60., 20., 90.}, std::array{85., 80., 180.}, std::array{75., 75., 10.}}) {
            const Direction wo = directionFromAngles(radians(out), 0),
                            wi = directionFromAngles(radians(in), radians(phi));
            std::vector<double> f(brdf->channels().count());
            brdf->eval(wo, {&wi.x, &wi.y, &wi.z, 1}, f.data());
            if (f.size() == 1) f.resize(3, f[0]);
            tests.push_back({{"material", n}, {"wo", array(wo)}, {"wi", array(wi)}, {"value", f}});
        }
    }
    return tests;
}

/// Directions of the first materials, drawn by the library, with their densities.
Json samplesOf(const std::vector<Proposal>& proposals) {
    Json samples = Json::array();
    UniformNumbers numbers(1);
    for (std::size_t n = 0; n < std::min(testedMaterials, proposals.size()); ++n) {
        const auto sampler = proposalSampler(proposals[n]);
        for (const double theta : {0., 45., 80.}) {
            const Direction wo = directionFromAngles(radians(theta), 1);
            const Uniforms u = numbers.next();
            const Sample sample = sampler->sample(wo, u);
            samples.push_back({{"material", n},
                               {"wo", array(wo)},
                               {"u", {u[0], u[1], u[2]}},
                               {"wi", array(sample.wi)},
                               {"pdf", sample.pdf}});
        }
    }
    return samples;
}

Json proposalJson(const ExportedSampling& sampling) {
    Json all = samplingJson(sampling);
    all["density"] =
        "(1 - share_0 - share_1) cos / pi + sum_k share_k ggx_k(wo, wi), visible normals of GGX "
        "folded at the horizon";
    all["texel"] = "share_0, width_0, share_1, width_1 (+ 256: a retro lobe)";
    all["share"] = "code / 255";
    all["width"] = "1e-4 * 20000^(code / 255)";
    all["place"] =
        "s rows - 1/2, clamped, s = 1 - sqrt(1 - tan(theta_o / 2)); shares and widths "
        "are interpolated";
    return all;
}

Json sidecarOf(const std::string& path, const ml::Library& library, const gpu::Texels& texels,
               const gpu::SharedSums& sums, const ExportedLibrary& exported,
               std::span<const gpu::ExportedFile> files) {
    Json materials = Json::array();
    for (const std::string& name : exported.materials) {
        const ml::Material& material = *ml::find(library, name);
        materials.push_back({{"name", name},
                             {"source", material.source},
                             {"mean_log", material.error.meanLog},
                             {"flip", material.error.flip}});
    }
    Json table = nullptr;
    if (exported.table) {
        table = tableJson(*exported.table);
        table["sampling"] = {
            {"filter", "linear"}, {"wrap", "clamp"}, {"mip", "none"}, {"lod", 0}, {"srgb", false}};
        table["data"] = Json::parse(gpu::dataText(sums.table->texels(), "table"));
    }
    return {{"format", "hshfit-gpu-library"},
            {"version", 1},
            {"generator", std::string("hshfit ") + version},
            {"library", path},
            {"value", "f = max(exp(min(Phi_0 + sum_k q_k Phi_k, top)) - offset, 0)"},
            {"colorspace", "lin_rec709"},
            {"cos_included", false},
            {"unit", "1/sr"},
            {"frame", Json::parse(gpu::frameText())},
            {"components", exported.components},
            {"texels_per_material", exported.bytes / 8},
            {"proposals", exported.sampling ? proposalJson(*exported.sampling) : Json(nullptr)},
            {"materials", materials},
            {"left_out", exported.leftOut},
            {"table", table},
            {"sampling", {{"filter", "none"}, {"mip", "none"}, {"lod", 0}, {"srgb", false}}},
            {"data", Json::parse(gpu::dataText(texels, "rows"))},
            {"files", Json::parse(gpu::filesText(files))}};
}

std::vector<std::pair<gpu::Role, const gpu::Texels*>> setsOf(const gpu::Texels& texels,
                                                             const gpu::SharedSums& sums) {
    std::vector<std::pair<gpu::Role, const gpu::Texels*>> sets{{gpu::Role::coefficients, &texels}};
    if (sums.table) sets.emplace_back(gpu::Role::basis, &sums.table->texels());
    return sets;
}

/// Throws UsageError for what a library cannot be.
std::vector<const gpu::Target*> targetsOf(const std::string& names) {
    std::vector<const gpu::Target*> chosen;
    for (const gpu::Target* target : gpu::selectTargets(names)) {
        if (holdsLibrary(*target))
            chosen.push_back(target);
        else if (names != "all")
            throw UsageError(fmt::format(
                "a library is no '{}': it is containers, shaders but OSL's, and three; give a "
                "material, LIBRARY:NAME, to export",
                target->name));
    }
    return chosen;
}

bool holds(std::span<const gpu::Target* const> targets, std::string_view name) {
    return std::ranges::any_of(targets,
                               [&](const gpu::Target* target) { return target->name == name; });
}

/// Whether the files of three.js are asked for and possible. Throws UsageError where they are not;
/// with all targets, they are left out, with a note.
bool wantsThree(std::span<const gpu::Target* const> targets, const LibraryExportOptions& options,
                const ExportedLibrary& exported, const Listener& listener) {
    if (!holds(targets, "three")) return false;
    try {
        gpu::checkThree(exported.name, exported.materials.size());
    } catch (const UsageError& error) {
        if (options.targets != "all") throw;
        listener.say(fmt::format("left out: {}", error.what()));
        return false;
    }
    return true;
}

/// The files of three.js.
void addThree(const ml::Library& library, gpu::SharedSums sums, const LibraryExportOptions& options,
              const Listener& listener, FileSet& files, ExportedLibrary& exported) {
    sums.further = 0;  // three.js draws no samples
    const gpu::ThreeOptions three{
        .name = exported.name,
        .shader = {.prefix = options.prefix},
        .lookUps = threeLookUps(
            sums.count(), [&](std::size_t n) { return brdfOf(library, exported, sums, n); },
            options.prefix, exported.name, listener.part("lookups")),
        .fitError = exported.table ? jsonText(tableJson(*exported.table)["error"]) : ""};
    const auto made = gpu::threeFiles(sums, exported.materials, three);
    for (std::string& path : writeThreeFiles(made, options.force, listener, files))
        exported.texts.push_back(std::move(path));
}

}  // namespace

Json tableJson(const ExportedTable& table) {
    return {{"half", table.size.half},
            {"plane", table.size.plane},
            {"horizon", table.size.horizon},
            {"bytes", table.bytes},
            {"error", {{"largest", table.error.largest}, {"mean", table.error.mean}}},
            {"flip",
             {{"mean", table.flip}, {"largest", table.largestFlip}, {"material", table.material}}}};
}

bool holdsLibrary(const gpu::Target& target) {
    using Kind = gpu::Target::Kind;
    return target.kind == Kind::container || target.name == "three" ||
           (target.kind == Kind::shader && target.name != "osl");
}

ExportedLibrary exportLibrary(const std::string& path, const std::string& folder,
                              const LibraryExportOptions& options, const Listener& listener) {
    const std::vector<const gpu::Target*> targets = targetsOf(options.targets);
    const ml::Library library = ml::readLibrary(path);
    ExportedLibrary exported;
    exported.name = std::filesystem::path(path).stem().string();
    if (library.basis.mean.empty())
        throw InputError(fmt::format("{}: has no basis; export its materials one by one", path));
    gpu::SharedSums sums = sumsOf(library, exported);
    if (exported.materials.empty())
        throw InputError(
            fmt::format("{}: none of its materials is in the basis; export them one by one", path));
    const bool three = wantsThree(targets, options, exported, listener);
    if (options.tableError > 0) {
        gpu::TabledLibrary tabled = gpu::tabledWithin(sums, options.tableError);
        exported.table = tableOf(library, exported, tabled);
        sums = std::move(tabled.sums);
    }
    std::vector<Proposal> proposals;
    if (options.sampling > 0) {
        LibraryProposals made = addProposals(
            sums, options.sampling,
            [&](std::size_t n) { return brdfOf(library, exported, sums, n); },
            listener.part("sampling"));
        proposals = std::move(made.proposals);
        exported.sampling = std::move(made.sampling);
    }
    const gpu::Texels texels = gpu::materialTexels(sums);
    exported.bytes = sums.width() * 4 * gpu::numberBytes(texels.number);

    // All of them hold halves.
    std::vector<const gpu::Container*> containers;
    for (const gpu::Target* target : targets)
        if (target->kind == gpu::Target::Kind::container)
            containers.push_back(&gpu::findContainer(target->name));
    FileSet files(folder, options.force);
    const Json tests = testsOf(library, exported, sums), samples = samplesOf(proposals);
    exported.textures = gpu::writeTexels(
        {.sets = setsOf(texels, sums),
         .facts = {{"form", "library"},
                   {"materials", std::to_string(exported.materials.size())},
                   {"layout", "rows"}},
         .sidecar =
             [&](std::span<const gpu::ExportedFile> written, std::optional<gpu::Role>) {
                 Json sidecar = sidecarOf(path, library, texels, sums, exported, written);
                 sidecar["tests"] = tests;
                 if (exported.sampling) sidecar["samples"] = samples;
                 return gpu::readableSidecar(jsonText(sidecar));
             },
         .tests = gpu::readableSidecar(jsonText(
             Json{{"format", "hshfit-gpu-library-test"}, {"version", 1}, {"tests", tests}}))},
        containers, exported.name, false, files);
    for (const gpu::LanguageEntry& language : gpu::languages()) {
        if (!holds(targets, language.name)) continue;
        const std::string file = gpu::shaderFileName(exported.name, language, options.prefix);
        std::string source = gpu::libraryShaderSource(language.language, sums, options.prefix);
        if (exported.sampling)
            source +=
                gpu::materialProposalSource(language.language, {.prefix = options.prefix,
                                                                .first = exported.sampling->first,
                                                                .rows = exported.sampling->rows});
        files.write(file, gpu::fileText(language.language, source,
                                        std::filesystem::path(file).stem().string()));
        exported.texts.push_back(file);
    }
    if (three) addThree(library, sums, options, listener, files, exported);
    files.commit();
    return exported;
}

}  // namespace hshfit::jobs
