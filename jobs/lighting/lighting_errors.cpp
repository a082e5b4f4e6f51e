#include "lighting_errors.h"

#include <hshfit/light/catalog.h>
#include <hshfit/pictures/picture_error.h>
#include <hshfit/rendering/lit_picture.h>
#include <hshfit/time_limit.h>

#include <nlohmann/json.hpp>

#include <chrono>

namespace hshfit::jobs {
namespace {

/// The time of one thread, over a few points.
double lightingIntegrationTime(const Brdf& brdf, const SurfacePoints& points, const View& view,
                               const DirectIntegral& light, double tolerance) {
    constexpr std::size_t timed = 20;
    const std::size_t step = std::max<std::size_t>(1, points.count() / timed);
    std::size_t count = 0;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t k = 0; k < points.count(); k += step, ++count) {
        const Frame frame = frameAt(points.normals[k]);
        light.at(brdf, frame, frame.toLocal(points.viewer(k, view)), {.tolerance = tolerance});
    }
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
    return time.count() / static_cast<double>(std::max<std::size_t>(1, count));
}

View lightingView(const LightingErrorOptions& options) {
    return View(radians(options.viewTheta), radians(options.viewPhi));
}

}  // namespace

std::vector<LightingReference> lightingReferences(const Brdf& truth,
                                                  const LightingErrorOptions& options,
                                                  const Listener& listener) {
    const View view = lightingView(options);
    const SurfacePoints points = spherePoints(view, options.size, 1);
    const IntegrationOptions how{.tolerance = options.tolerance};
    std::vector<LightingReference> references;
    const ProgressCall progress = listener.part("integration");
    std::vector<LightSpecification> specs = options.given;
    if (specs.empty())
        for (const std::string& spec : options.lights.empty() ? lightExamples() : options.lights)
            specs.push_back(parseLights(spec));
    const TimeLimit limit = TimeLimit(options.seconds).share(2);
    for (const LightSpecification& spec : specs) {
        if (!references.empty() && limit.isOver()) break;
        LightingReference reference{.light = spec.text, .lights = spec.lights};
        const DirectIntegral direct(reference.lights);
        reference.picture = renderByIntegration(truth, points, view, direct, how);
        reference.nanoseconds =
            lightingIntegrationTime(truth, points, view, direct, options.tolerance);
        references.push_back(std::move(reference));
        if (progress) progress(references.size(), specs.size());
    }
    return references;
}

std::vector<LightingError> lightingErrors(std::span<const LightingReference> references,
                                          const LightingTables& tables,
                                          std::span<const LightingModel* const> models,
                                          const LightingErrorOptions& options) {
    const View view = lightingView(options);
    const SurfacePoints points = spherePoints(view, options.size, 1);
    const TimeLimit limit = TimeLimit(options.seconds).share(2);
    std::vector<LightingError> errors;
    for (const LightingReference& reference : references) {
        if (!errors.empty() && limit.isOver()) break;
        const LightingEnvironment light = lightFor(tables, reference.lights, options.tables);
        for (const LightingModel* model : models) {
            const lighting::ShadedPicture shaded =
                lighting::render(shadingOf(model->kind, tables, light), points, view);
            std::optional<double> turned;
            if (model->kind == LightingModel::Kind::prefiltered)
                turned = lighting::turnedError(*tables.prefiltered, reference.lights);
            errors.push_back({.light = reference.light,
                              .model = std::string(model->name),
                              .difference = differenceOf(reference.picture.picture, shaded.picture),
                              .flip = sphereFlip(reference.picture.picture, shaded.picture),
                              .turned = turned,
                              .reference = reference.picture.error,
                              .bytes = tables.bytes(model->kind),
                              .lightBytes = light.bytes(model->kind),
                              .nanoseconds = shaded.nanoseconds,
                              .integration = reference.nanoseconds,
                              .prepareSeconds = light.seconds[static_cast<int>(model->kind)]});
        }
    }
    return errors;
}

nlohmann::ordered_json lightingErrorsJson(std::span<const LightingError> errors) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const LightingError& error : errors) {
        rows.push_back({{"light", error.light},
                        {"model", error.model},
                        {"relative_l2", error.difference.relativeL2},
                        {"flip", error.flip},
                        {"maximum", error.difference.maximum},
                        {"pixel", {error.difference.column, error.difference.row}},
                        {"reference_error", error.reference},
                        {"bytes", error.bytes},
                        {"light_bytes", error.lightBytes},
                        {"nanoseconds", error.nanoseconds},
                        {"integration_nanoseconds", error.integration},
                        {"prepare_seconds", error.prepareSeconds}});
        if (error.turned) rows.back()["turned_l2"] = *error.turned;
    }
    return rows;
}

}  // namespace hshfit::jobs
