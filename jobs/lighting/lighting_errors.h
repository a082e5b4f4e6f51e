#pragma once

#include "lighting_models.h"

#include <hshfit/light/catalog.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct LightingErrorOptions {
    /// Specifications of lights; empty: lightExamples().
    std::vector<std::string> lights = {};
    std::vector<LightSpecification> given = {};  ///< in place of `lights`, if there are any
    int size = 48;                               ///< pixels along an edge of the sphere's picture
    double viewTheta = 75, viewPhi = 0;
    double tolerance = 5e-3;  ///< of direct integration
    /// After that time no further light is tried; one always is.
    std::optional<double> seconds = {};
    LightingTableOptions tables = {};
};

/// A model under a light, against direct integration on a sphere.
struct LightingError {
    std::string light, model;
    PictureDifference difference = {};
    double flip = 0;  ///< sphereFlip
    /// For a prefiltered environment: the error over all turns of the light
    /// (lighting::turnedError).
    std::optional<double> turned = {};
    double reference = 0;   ///< estimated relative error of direct integration
    std::size_t bytes = 0;  ///< of the table
    std::size_t lightBytes = 0;
    double nanoseconds = 0;     ///< of one thread, for a point
    double integration = 0;     ///< the same of direct integration
    double prepareSeconds = 0;  ///< of the light
};

/// A sphere under one light by direct integration.
struct LightingReference {
    std::string light;          ///< its specification
    std::vector<Light> lights;  ///< that it stands for
    LitPicture picture = {};
    double nanoseconds = 0;  ///< of one thread, for a point
};
/// renderByIntegration of `truth` under every light, or under as many of the first lights as half
/// of the time is enough for. Throws UsageError, InputError, NumericError.
std::vector<LightingReference> lightingReferences(const Brdf& truth,
                                                  const LightingErrorOptions& options,
                                                  const Listener& listener = {});

/// Every model under every light against the references, which have the same options: relative L2,
/// FLIP, and the largest difference of a pixel and where it is. The first lights alone where the
/// other half of the time is over.
std::vector<LightingError> lightingErrors(std::span<const LightingReference> references,
                                          const LightingTables& tables,
                                          std::span<const LightingModel* const> models,
                                          const LightingErrorOptions& options);

/// One object for each: light, model, relative_l2, flip, maximum, where, bytes and times.
nlohmann::ordered_json lightingErrorsJson(std::span<const LightingError> errors);

}  // namespace hshfit::jobs
