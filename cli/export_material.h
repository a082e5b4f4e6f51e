#pragma once

#include "command.h"

#include <jobs/exports/export_material.h>

#include <string>

namespace hshfit::cli {

/// Writes standard materials and prints the answer, as text or JSON.
void runMaterialExport(const std::string& input, const std::string& folder,
                       const jobs::MaterialExportOptions& options, const Globals& globals);

}  // namespace hshfit::cli
