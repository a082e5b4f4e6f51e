#pragma once

#include "lighting_errors.h"

#include <jobs/common/option_row.h>
#include <jobs/exports/export.h>

#include <hshfit/gpu/texels.h>

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hshfit::jobs {

struct LightingExportOptions {
    std::string models = "all";  ///< selectLightingModels
    /// The light that is written with the tables (light/catalog.h).
    std::string light = "sky:type=12,elevation=40";
    std::string targets = "glsl-es";  ///< languages of gpu::selectTargets; others are left out
    std::string name = {};            ///< of the files; empty: the coefficient file's
    /// The BRDF that errors are measured against; empty: the one that the coefficients name.
    std::string source = {};
    std::string prefix = "hsh";  ///< of every name in a shader
    /// The number of the cube, float16 or float32; none: float16, or float32 for a light beyond
    /// 65504.
    std::optional<gpu::Number> number = {};
    bool measureError = true;
    bool force = false;                ///< replace existing files
    LightingErrorOptions errors = {};  ///< `tables` has the options of the tables
};

OptionRows<LightingExportOptions> lightingExportOptions();
/// `own` with those that exports of coefficients have, too. Errors are measured under the light
/// that is written, if one is stated, and under those of the catalog.
LightingExportOptions withShared(const ExportOptions& shared, LightingExportOptions own);

struct LightingExport {
    /// The sidecar: tables, the light, shaders, tests, errors (docs/schemas/lighting.schema.json).
    nlohmann::ordered_json sidecar;
    std::vector<std::string> files;  ///< names in the folder
};

/// The sidecar without what its readers alone need, as the answer of a command.
nlohmann::ordered_json lightingJson(const LightingExport& exported, const std::string& folder);

/// Tables by elevation, and by azimuth where it is not isotropic, of the BRDF in a coefficient file
/// of any form, for each of the models, with one light made ready for them, as textures, shaders
/// and a sidecar: all files or none. Spectra become RGB. Throws UsageError, InputError,
/// NumericError and OutputError.
LightingExport exportLighting(const std::string& coefficients, const std::string& folder,
                              const LightingExportOptions& options, const Listener& listener = {});

}  // namespace hshfit::jobs
