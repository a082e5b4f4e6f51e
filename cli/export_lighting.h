#pragma once

#include "command.h"

#include <jobs/lighting.h>

#include <string>

namespace hshfit::cli {

/// Writes tables, light and shaders to `folder` and prints their sizes and errors, or with --json
/// the sidecar without its arrays.
void runExportLighting(const std::string& coefficients, const std::string& folder,
                       const jobs::LightingExportOptions& options, const Globals& globals);

}  // namespace hshfit::cli
