#include "stand_ins.h"

#include <jobs/source/source.h>
#include "convert.h"

#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/files/mapped_file.h>
#include <hshfit/files/temporary_file.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/representation/halfway/halfway_terms.h>
#include <hshfit/tradeoff/kept_projections.h>
#include <hshfit/tradeoff/sweep.h>
#include <hshfit/wording.h>

#include <brdfs/catalog.h>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <utility>

namespace hshfit::jobs {
namespace {

using choice::Candidate;
using choice::Made;
using Kind = Representation::Kind;

/// Brdf::defaultTolerance of models; interpolated tables have a looser one.
constexpr double smoothTolerance = 1e-6;

Made converted(const CandidateSource& source) {
    const std::string file = source.name + ".bsdf";
    const auto kept = std::make_shared<TemporaryFile>(file);
    ConvertOptions how;
    how.force = true;
    const Converted made = convert(source.spec, kept->path(), how);
    return {.brdf = openBeside(kept->path(), source.brdf),
            .spec = file,
            .bytes = made.bytes,
            .commands = {commandOf("convert", source.spec, {}, file)},
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

std::string formName(const Form& form) {
    const std::string precision = fmt::format(" in {}", precisionName(form.precision));
    if (form.kind == Kind::halfway) {
        const HalfwayOrders& o = form.halfway;
        return fmt::format("halfway {},{},{}", o.half, o.difference, o.azimuth) + precision;
    }
    const std::string where =
        form.kind == Kind::basis
            ? ", both directions"
            : fmt::format(
                  " at {} {}", form.outgoing,
                  form.outgoing.find('x') == std::string::npos ? "elevations" : "directions");
    return fmt::format("{} of order {}{}", form.basis, form.order, where) + precision;
}

/// Candidate::seconds: fits of the halfway form grow with its terms; anisotropic BRDFs have more
/// terms and directions. Matrices of tables converge slowly, if they do.
double secondsOf(const Form& form, const Brdf& brdf) {
    const double fit = 0.09 * form.halfway.half * form.halfway.half;
    const bool table = brdf.defaultTolerance() > smoothTolerance;
    const double matrix = table ? 10 : 2;
    const double seconds = form.kind == Kind::halfway ? fit : form.kind == Kind::basis ? matrix : 1;
    return brdf.laws().isotropic ? seconds : 4 * seconds;
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
    FormMaker(const CandidateSource& source, const std::vector<Form>& forms,
              const tradeoff::ProjectionFolder& folder)
        : source_(source),
          kept_(source.brdf,
                {.projection = {.tolerance = toleranceOf(source.brdf)}, .folder = &folder}) {
        kept_.expect(forms);
    }

    bool hasProjected(const Form& form) const { return kept_.isMade(form); }

    Made make(const Form& form, const std::string& target) {
        Representation representation = represent(kept_, form);
        representation.head.source = source_.spec;
        const std::string file = source_.name + ".json";
        std::vector<Setting> settings = settingsOf(form);
        if (form.kind != Kind::halfway)
            settings.push_back(
                {"ProjectionOptions::tolerance", fmt::format("{}", toleranceOf(source_.brdf))});
        std::vector<std::string> commands{commandOf("project", source_.spec, settings, file)};
        if (!target.empty())
            commands.push_back(
                commandOf("export", file, {{"ExportOptions::targets", target}}, source_.name));
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
    const CandidateSource& source_;
    tradeoff::KeptProjections kept_;
};

}  // namespace

Candidate bsdfCandidate(const CandidateSource& source) {
    const std::string path = rglPathOf(source);
    if (path.empty())
        return {"bsdf", "converted to .bsdf", [&source] { return converted(source); }};
    return {"bsdf", "the measured file", [path] {
                return Made{
                    .brdf = nullptr, .spec = path, .bytes = std::filesystem::file_size(path)};
            }};
}

std::vector<Candidate> formCandidates(const CandidateSource& source, const std::string& target,
                                      const tradeoff::ProjectionFolder& folder) {
    const std::vector<Form> forms = formsFor(source.brdf);
    const auto maker = std::make_shared<FormMaker>(source, forms, folder);
    std::vector<Candidate> candidates;
    for (const Form& form : forms)
        candidates.push_back({.kind = form.kind == Kind::halfway ? "halfway" : "coefficients",
                              .name = formName(form),
                              .make = [=] { return maker->make(form, target); },
                              .seconds = secondsOf(form, source.brdf),
                              .isHalfMade = [=] { return maker->hasProjected(form); }});
    return candidates;
}

}  // namespace hshfit::jobs
