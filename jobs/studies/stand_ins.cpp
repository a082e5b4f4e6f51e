#include "stand_ins.h"

#include <jobs/exports/export_material.h>
#include <jobs/fits/fit.h>
#include <jobs/source/source.h>
#include "convert.h"

#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/error.h>
#include <hshfit/files/json_fields.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/temporary_file.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/tradeoff/projection_cache.h>
#include <hshfit/tradeoff/sweep.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>
#include <utility>

namespace hshfit::jobs {
namespace {

using choice::Candidate;
using choice::Made;
using Kind = Representation::Kind;

/// A row of fits: sums from few lobes to many.
struct LobeModel {
    const char *name, *model;
    int lobes;  ///< of GGX
};
constexpr LobeModel lobeModels[] = {
    {"Lambert", "lambert", 0},
    {"Lambert + GGX", "lambert+ggx", 1},
    {"Lambert + 2 GGX", "lambert+ggx+ggx", 2},
};

/// A row of standard materials; `kind` is that of the candidates.
struct StandardMaterial {
    const char *kind, *name, *target;
    double seconds;  ///< Candidate::seconds, of tables
};
constexpr StandardMaterial standardMaterials[] = {
    {"gltf", "glTF material", "gltf", 20},
    {"openpbr", "OpenPBR Surface", "materialx", 40},
    {"usd", "UsdPreviewSurface", "usd", 60},
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

std::string command(const char* function, const std::string& subject, std::vector<Setting> settings,
                    const std::string& output) {
    return fmt::format("{}", Call{.function = function,
                                  .subject = subject,
                                  .settings = std::move(settings),
                                  .output = output});
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
            .commands = {command("fit", source.spec, settings, file)},
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
            .commands = {command(
                "export", source.spec,
                {{"ExportOptions::targets", target}, {"ExportOptions::name", source.name}},
                source.name)},
            .write = [=](FileSet& files) {
                for (const ExportedMaterial& each : all) files.write(each.path, each.content);
            }};
}

Made converted(const CandidateSource& source) {
    const std::string file = source.name + ".bsdf";
    const auto kept = std::make_shared<TemporaryFile>(file);
    ConvertOptions how;
    how.force = true;
    const Converted made = convert(source.spec, kept->path(), how);
    return {.brdf = openBeside(kept->path(), source.brdf),
            .spec = file,
            .bytes = made.bytes,
            .commands = {command("convert", source.spec, {}, file)},
            .write = [=](FileSet& files) {
                const MappedFile content(kept->path());
                files.write(file, std::string(content.bytes().begin(), content.bytes().end()));
            }};
}

/// The path of a source that is a file of the RGL format; empty for any other.
std::string rglPathOf(const CandidateSource& source) {
    const std::string path(pathIn(source.spec));
    const Fact rgl{"format", std::string("rgl")};
    const std::vector<Fact> facts = source.brdf.facts();
    return path == source.spec && std::ranges::find(facts, rgl) != facts.end() ? path : "";
}

std::string nameOf(const Form& form) {
    const std::string precision = fmt::format(" in {}", precisionName(form.precision));
    if (form.kind == Kind::halfway) {
        const HalfwayOrders& o = form.halfway;
        return fmt::format("halfway {},{},{}", o.half, o.difference, o.azimuth) + precision;
    }
    const std::string where =
        form.kind == Kind::basis ? ", both directions" : fmt::format(" at {}", form.outgoing);
    return fmt::format("{} of order {}{}", form.basis, form.order, where) + precision;
}

/// Candidate::seconds: fits of the halfway form grow with its terms.
double secondsOf(const Form& form) {
    return form.kind == Kind::halfway ? 0.1 * form.halfway.half * form.halfway.half : 3;
}

/// The forms that are tried: of the halfway form few functions and many, in half and in bytes;
/// both directions in one basis, and coefficients per outgoing direction.
std::vector<Form> formsFor(const Brdf& brdf) {
    std::vector<Form> forms;
    Form form;
    form.kind = Kind::halfway;
    for (const HalfwayOrders& orders : tradeoff::Sweep{}.halfway) {
        form.halfway = halfwayOrdersOr(orders, brdf.laws().isotropic, brdf.laws().reciprocal);
        for (const Precision precision : {Precision::unorm8, Precision::half}) {
            form.precision = precision;
            forms.push_back(form);
        }
    }
    form = Form();
    form.kind = Kind::basis;
    form.basis = "zernike";
    form.precision = Precision::half;
    form.reciprocal = brdf.laws().reciprocal;
    for (const int order : {4, 8}) {
        form.order = order;
        forms.push_back(form);
    }
    form = Form();
    form.order = 8;
    form.outgoing = brdf.laws().isotropic ? "16" : "8x8";
    form.precision = Precision::half;
    forms.push_back(form);
    return forms;
}

/// The projections of all forms, each made when the first form asks for it.
class FormMaker {
public:
    explicit FormMaker(const CandidateSource& source)
        : source_(source), cache_(source.brdf, {.tolerance = toleranceOf(source.brdf)}) {}

    Made make(const Form& form, const std::string& target) {
        if (prepared_.insert(optionsOf(projectionOf(form))).second) {
            const Form alone = projectionOf(form);
            cache_.prepare({&alone, 1}, [] {});
        }
        Representation representation = represent(cache_, form);
        representation.head.source = source_.spec;
        const std::string file = source_.name + ".json";
        std::vector<Setting> settings = settingsOf(form);
        if (form.kind != Kind::halfway)
            settings.push_back(
                {"ProjectionOptions::tolerance", fmt::format("{}", toleranceOf(source_.brdf))});
        std::vector<std::string> commands{command("project", source_.spec, settings, file)};
        if (!target.empty())
            commands.push_back(
                command("export", file, {{"ExportOptions::targets", target}}, source_.name));
        Made made{.brdf = reconstruct(representation, sourceOpener()),
                  .spec = optionsOf(form),
                  .bytes = representation.bytes(),
                  .commands = std::move(commands)};
        const auto kept = std::make_shared<const Representation>(std::move(representation));
        made.write = [=](FileSet& files) {
            files.write(file, [&](AtomicFile& open) { writeRepresentation(*kept, open); });
        };
        made.shader = [=] { return gpu::timedShader(*kept); };
        return made;
    }

private:
    /// A hundredth is far below what few bands leave out.
    static double toleranceOf(const Brdf& brdf) { return std::max(brdf.defaultTolerance(), 0.01); }
    static Form projectionOf(Form form) {
        form.precision = Precision::float64;
        return form;
    }
    const CandidateSource& source_;
    tradeoff::ProjectionCache cache_;
    std::set<std::string> prepared_;
};

}  // namespace

std::vector<Candidate> formulaCandidates(const CandidateSource& source) {
    std::vector<Candidate> candidates;
    if (isModel(source.brdf))
        candidates.push_back({"model", "the model itself", [&] { return theModel(source); }});
    for (const LobeModel& row : lobeModels)
        candidates.push_back(
            {"lobes", row.name, [&source, &row] { return fittedLobes(source, row); }});
    for (const StandardMaterial& row : standardMaterials)
        candidates.push_back({row.kind, row.name,
                              [&source, &row] { return standardMaterial(source, row.target); },
                              isModel(source.brdf) ? 4 : row.seconds});
    return candidates;
}

Candidate bsdfCandidate(const CandidateSource& source) {
    const std::string path = rglPathOf(source);
    if (path.empty())
        return {"bsdf", "converted to .bsdf", [&source] { return converted(source); }};
    return {"bsdf", "the measured file", [path] {
                return Made{
                    .brdf = nullptr, .spec = path, .bytes = std::filesystem::file_size(path)};
            }};
}

std::vector<Candidate> formCandidates(const CandidateSource& source, const std::string& target) {
    const auto maker = std::make_shared<FormMaker>(source);
    std::vector<Candidate> candidates;
    for (const Form& form : formsFor(source.brdf))
        candidates.push_back({form.kind == Kind::halfway ? "halfway" : "coefficients", nameOf(form),
                              [=] { return maker->make(form, target); }, secondsOf(form)});
    return candidates;
}

}  // namespace hshfit::jobs
