#pragma once

#include "command.h"

#include <jobs/lighting/lighting.h>

#include <string>

namespace hshfit::cli {

/// Refuses --engine and --lobes without prefiltered environments among `models`.
void requirePrefiltered(const CLI::App& command, const std::string& models);

/// Writes tables, light and shaders to `folder` and prints their sizes and errors, or with --json
/// the sidecar without its arrays.
void runExportLighting(const std::string& coefficients, const std::string& folder,
                       const jobs::LightingExportOptions& options, const Globals& globals);

}  // namespace hshfit::cli
