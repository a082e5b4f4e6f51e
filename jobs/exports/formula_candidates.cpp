#include "formula_candidates.h"

#include <jobs/common/option_words.h>
#include <jobs/exports/export_material.h>
#include <jobs/fits/fit.h>
#include <jobs/source/source.h>

#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/gpu/timing/timed_shader.h>
#include <hshfit/representation/representation.h>
#include <hshfit/spelling.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace hshfit::jobs {
namespace {

using choice::Candidate;
using choice::Made;

/// A row of fits: sums from few lobes to many.
struct LobeModel {
    const char *name, *model;
    int lobes;  ///< of GGX
};
constexpr LobeModel lobeModels[] = {
    {"Lambert", "lambert", 0},
    {"Lambert + GGX", "lambert+ggx", 1},
    {"Lambert + GGX, ks 1", "lambert+ggx:ks=1", 1},  // of metals
    {"Lambert + 2 GGX", "lambert+ggx+ggx", 2},
};

/// A row of standard materials; `kind` is the kind of the candidates that it gives.
struct StandardMaterial {
    const char *kind, *name, *target;
    double seconds;  ///< Candidate::seconds, of tables
};
constexpr StandardMaterial standardMaterials[] = {
    {"gltf", "glTF material", "gltf", 2},
    {"openpbr", "OpenPBR Surface", "materialx", 12},
    {"usd", "UsdPreviewSurface", "usd", 16},
};

constexpr CandidateKind kindTable[] = {
    {"model", "the specification itself, of models"},
    {"lobes", "fits of Lambert and GGX lobes"},
    {"gltf", "glTF's material"},
    {"openpbr", "OpenPBR Surface"},
    {"usd", "UsdPreviewSurface of OpenUSD, with MaterialX by reference", true},
};

/// Four bytes for each number of a specification, as for what coefficient files add.
std::size_t formulaBytes(const std::string& spec) {
    Representation formula;
    formula.added = spec;
    formula.content = MatrixFactors{};
    return formula.bytes();
}

bool isModel(const Brdf& brdf) {
    std::int64_t terms = 1, models = 0;
    for (const Fact& fact : brdf.facts()) {
        if (fact.first == "terms") terms = std::get<std::int64_t>(fact.second);
        models += fact.first == "model" || fact.first.ends_with("_model") ? 1 : 0;
    }
    return models == terms;
}

std::string presetOf(const std::string& spec) {
    return jsonText(nlohmann::ordered_json{{"format", "hshfit-preset"},
                                           {"version", 1},
                                           {"spec", spec},
                                           {"source", "the model itself"}},
                    2) +
           "\n";
}

Made theModel(const CandidateSource& source) {
    const std::string spec = source.brdf.name(), file = source.name + ".json";
    return {
        .brdf = nullptr, .spec = spec, .bytes = formulaBytes(spec), .write = [=](FileSet& files) {
            files.write(file, presetOf(spec));
        }};
}

Made fittedLobes(const CandidateSource& source, const LobeModel& row) {
    const FitOptions how{.model = row.model, .accept = true, .rgb = true, .advise = false};
    const Fitted fitted = fitBrdf(source.brdf, source.spec, how);
    const std::string file = source.name + ".json", text = presetText(fitted);
    std::vector<Setting> settings{{"FitOptions::model", row.model}};
    if (!fitted.result.converged) settings.push_back({"FitOptions::accept"});
    return {.brdf = openBeside(fitted.result.spec, source.brdf),
            .spec = fitted.result.spec,
            .bytes = formulaBytes(fitted.result.spec),
            .commands = {commandOf("fit", source.spec, settings, file)},
            .write = [=](FileSet& files) { files.write(file, text); },
            .shader = [lobes = row.lobes] { return gpu::lobesShader(lobes); }};
}

Made standardMaterial(const CandidateSource& source, const char* target) {
    const MaterialExportOptions how{.targets = target, .name = source.name, .advise = false};
    const std::vector<ExportedMaterial> all = makeMaterials(source.spec, how).files;
    const ExportedMaterial& made = all.back();  // MaterialX precedes a layer that refers to it
    return {.brdf = openBeside(made.spec, source.brdf),
            .spec = made.spec,
            .bytes = formulaBytes(made.spec),
            .commands = {commandOf(
                "export", source.spec,
                {{"ExportOptions::targets", target}, {"ExportOptions::name", source.name}},
                source.name)},
            .write = [=](FileSet& files) {
                for (const ExportedMaterial& each : all) files.write(each.path, each.content);
            }};
}

}  // namespace

std::string commandOf(const char* function, const std::string& subject,
                      std::vector<Setting> settings, const std::string& output) {
    return fmt::format("{}", Call{.function = function,
                                  .subject = subject,
                                  .settings = std::move(settings),
                                  .output = output});
}

std::span<const CandidateKind> formulaKinds() {
    return kindTable;
}

std::vector<Word> formulaWords() {
    std::vector<Word> words = wordsOf(formulaKinds());
    words.insert(words.begin(), {"none", "no formula"});
    return words;
}

std::vector<Candidate> formulaCandidates(const CandidateSource& source) {
    std::vector<Candidate> candidates;
    if (isModel(source.brdf))
        candidates.push_back(
            {"model", "the model itself", [source] { return theModel(source); }, 0});
    for (const LobeModel& row : lobeModels)
        candidates.push_back({.kind = "lobes",
                              .name = row.name,
                              .make = [source, &row] { return fittedLobes(source, row); },
                              .seconds = 1,
                              .isFormula = true});
    for (const StandardMaterial& row : standardMaterials)
        candidates.push_back(
            {.kind = row.kind,
             .name = row.name,
             .make = [source, &row] { return standardMaterial(source, row.target); },
             .seconds = isModel(source.brdf) ? std::min(row.seconds, 4.0) : row.seconds,
             .isFormula = true});
    return candidates;
}

void requireFormulaKinds(const std::vector<std::string>& kinds) {
    for (const std::string& kind : kinds) {
        const bool known =
            std::ranges::find(kindTable, kind, &CandidateKind::name) != std::end(kindTable);
        if (!known && kind != "none")
            throw spelling::unknown("formula", kind, spelling::namesOf(formulaKinds()));
        if (kind == "none" && kinds.size() > 1)
            throw UsageError("'none' stands alone: no formula is measured with it");
    }
}

std::vector<Candidate> formulaCandidates(const CandidateSource& source,
                                         const std::vector<std::string>& kinds) {
    std::vector<Candidate> all = formulaCandidates(source);
    std::erase_if(all, [&](const Candidate& candidate) {
        return std::ranges::find(kinds, candidate.kind) == kinds.end();
    });
    return all;
}

}  // namespace hshfit::jobs
