#include "project.h"

#include <jobs/common/inputs.h>
#include <jobs/common/kept_outputs.h>
#include <jobs/common/named_errors.h>
#include <jobs/source/picture.h>
#include <jobs/source/source.h>

#include <hshfit/accuracy/exchange.h>
#include <hshfit/bases/catalog.h>
#include <hshfit/brdf/transmission.h>
#include <hshfit/coefficient_files/coefficient_file.h>
#include <hshfit/coefficient_files/coefficient_path.h>
#include <hshfit/coefficient_files/representation_file.h>
#include <hshfit/coefficients/reconstruction.h>
#include <hshfit/error.h>
#include <hshfit/files/file_set.h>
#include <hshfit/projection/least_squares.h>
#include <hshfit/projection/one_basis.h>
#include <hshfit/representation/forms/represented_brdf.h>
#include <hshfit/wording.h>

#include <brdfs/measured/mueller.h>
#include <brdfs/measured/scattered/scattered.h>

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

namespace hshfit::jobs {
namespace {

Quantity quantityOf(const ProjectOptions& options) {
    return options.cosine ? Quantity::brdfCosine : Quantity::brdf;
}

std::optional<Form> formOf(const ProjectOptions& options) {
    std::optional<Form> form = options.form.form();
    if (!form) return form;
    if (options.leastSquares) {
        throw UsageError(fmt::format("{} writes plain coefficients: leave out the form",
                                     Setting{"ProjectOptions::leastSquares"}));
    }
    form->basis = options.basis;
    form->order = options.order;
    form->condonShortley = options.condonShortley;
    form->quantity = quantityOf(options);
    form->outgoing = options.outgoing;
    return form;
}

std::string anglesOf(const Direction& d) {
    return fmt::format("{:.3g},{:.3g}", degrees(polarAngle(d)), degrees(azimuth(d)));
}

/// The exchange that a reciprocal form of this BRDF gets wrong; empty where there is none to see.
std::string whyNotReciprocal(const Brdf& brdf) {
    constexpr double least = 1.25;
    const ExchangeAtHorizon worst = exchangeAtHorizon(brdf);
    if (worst.ratio() < least) return {};
    return fmt::format(
        "{}: f is {:.3g} for wi {} and wo {} degrees, and {:.3g} with both "
        "exchanged; {} keeps their mean, which is wrong towards the horizon: leave "
        "it out",
        brdf.name(), worst.value, anglesOf(worst.wi), anglesOf(worst.wo), worst.exchanged,
        Setting{"Form::reciprocal"});
}

/// Projects scattered samples by least squares, without interpolating between them.
Projection projectSamples(const Brdf& brdf, const Basis& basis, const OutgoingSet& outgoing,
                          const ProjectOptions& options, ProgressCall progress) {
    const std::optional<brdfs::MeasuredPairs> measured = brdfs::measuredPairs(brdf);
    if (!measured) {
        throw UsageError(
            fmt::format("{}: {} is for files of scattered samples; project others without it",
                        brdf.name(), Setting{"ProjectOptions::leastSquares"}));
    }
    LeastSquaresProjection fit = projectLeastSquares(measured->directionSamples(), basis, outgoing,
                                                     {.quantity = quantityOf(options),
                                                      .regularisation = options.regularise,
                                                      .kernel = radians(options.kernel),
                                                      .progress = std::move(progress)});
    return {.coefficients = std::move(fit.coefficients), .captured = {}, .evaluations = 0};
}

/// The basis and form that all inputs share.
class Projector {
public:
    explicit Projector(const ProjectOptions& options)
        : options_(options),
          basis_(bases::make(options.basis, options.order,
                             {.condonShortley = options.condonShortley})),
          form_(formOf(options)) {
        // A word that is none fails before any file is opened.
        if (!options.outgoing.empty()) OutgoingSet::parse(options.outgoing);
    }

    /// All but the file.
    Projected run(const std::string& spec, const std::string& output,
                  const ProgressCall& progress) const {
        Projected result;
        withFileNamed(spec, [&] {
            result =
                projected(*openBrdf(spec, options_.rgb, Sides::eitherAndNamed), output, progress);
        });
        return result;
    }

    static void write(const Projected& result, AtomicFile& file) {
        if (result.kept)
            writeRepresentation(*result.kept, file);
        else
            writeCoefficients(result.projection.coefficients, file);
    }

    Projected projected(const Brdf& brdf, const std::string& output,
                        const ProgressCall& progress) const {
        const ProjectionOptions how = {
            .quantity = quantityOf(options_),
            .tolerance = options_.tolerance,
            .maxEvaluations = static_cast<std::size_t>(options_.maxEvaluations),
            .progress = progress};
        Projected result{.projection = {}, .output = output};
        if (form_ && form_->reciprocal && transmits(brdf))
            throw UsageError(
                fmt::format("{}: is a transmission, whose directions are not exchanged; leave out "
                            "{}",
                            brdf.name(), Setting{"Form::reciprocal"}));
        if (form_) {
            brdfs::requireReflectance(brdf, "a form of coefficients");
            result.kept = represent(brdf, *form_, sourceOpener(), how);
            result.projection.coefficients = {result.kept->head};
            const auto again = reconstruct(*result.kept, sourceOpener());
            if (result.kept->kind() == Representation::Kind::halfway)
                result.errors = summaryOf(brdf, *again);
            result.captured = capturedShare(*result.kept, brdf, result.errors);
            if (!result.captured)
                result.remark = whyZero(brdf);
            else if (form_->reciprocal && !brdf.laws().reciprocal)
                result.remark = whyNotReciprocal(brdf);
            result.picture = pictureErrorOf(brdf, *again);
            result.poor = judge(*result.kept, result.captured, result.picture, brdf, output);
            return result;
        }
        const OutgoingSet outgoing = outgoingOf({.outgoing = options_.outgoing}, brdf.laws());
        result.projection = options_.leastSquares
                                ? projectSamples(brdf, *basis_, outgoing, options_, progress)
                                : hshfit::project(brdf, *basis_, outgoing, how);
        result.captured = capturedShare(result.projection, brdf);
        if (!result.captured) result.remark = whyZero(brdf);
        result.picture = pictureErrorOf(brdf, Reconstruction(result.projection.coefficients));
        result.poor = judge(result.projection, result.captured, result.picture, brdf, output);
        return result;
    }

private:
    const ProjectOptions& options_;
    std::unique_ptr<Basis> basis_;
    std::optional<Form> form_;
};

/// Throws OutputError for a folder in place of the file of one BRDF.
void requireFile(const std::string& spec, const std::string& output) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (!output.ends_with('/') && !fs::is_directory(output, error)) return;
    throw OutputError(
        fmt::format("'{}' is a folder; the coefficients of one BRDF go to a file, such as '{}'",
                    output, (fs::path(output) / (nameOf(spec) + ".json")).string()));
}

}  // namespace

Projected project(const std::string& spec, const std::string& output, const ProjectOptions& options,
                  const Listener& listener) {
    requireFile(spec, output);
    requireCoefficientPath(output);
    const Projector projector(options);
    Projected result = projector.run(spec, output, listener.part("project"));
    writeProjected(result, output);
    return result;
}

Projected projectBrdf(const Brdf& brdf, const ProjectOptions& options, const Listener& listener,
                      const std::string& output) {
    return Projector(options).projected(brdf, output, listener.part("project"));
}

void writeProjected(const Projected& result, const std::string& path) {
    AtomicFile file(path);
    Projector::write(result, file);
    file.commit();
}

ManyProjected projectMany(const std::vector<std::string>& specs, const std::string& folder,
                          const std::string& extension, const ProjectOptions& options,
                          const Listener& listener) {
    const Projector projector(options);
    ManyProjected many;
    many.specs = expandInputs(specs);
    std::vector<std::string> outputs = outputPaths(many.specs, folder, extension);
    requireFolder(folder);
    many.kept = takeKept(many.specs, outputs);
    FileSet files(folder, true);
    many.results.resize(many.specs.size());
    many.failures = forEachInput(
        many.specs, listener, "project", [&](std::size_t i, const ProgressCall& progress) {
            Projected result = projector.run(many.specs[i], outputs[i], progress);
            const OutputKey key(keyOf({many.specs[i]}));
            files.write(std::filesystem::path(outputs[i]).filename().string(),
                        [&](AtomicFile& file) { Projector::write(result, file); });
            result.projection.coefficients.values = {};  // the values are in the file
            many.results[i] = std::move(result);
        });
    files.commit();
    return many;
}

}  // namespace hshfit::jobs
