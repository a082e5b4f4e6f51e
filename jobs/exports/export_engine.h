#pragma once

#include "export.h"

#include <hshfit/brdf/brdf.h>
#include <hshfit/files/file_set.h>

#include <string_view>

namespace hshfit::jobs {

/// Whether the target is an engine with a file of gpu/engines.
bool hasEngineFile(std::string_view target);

/// Adds the material files of an engine to `files` and `exported`. `brdf` is what is shown, or its
/// source. A material that a file cannot hold is left out with a note: the target's textures and
/// shaders stay.
void writeEngine(std::string_view target, const Brdf& brdf, const ExportOptions& options,
                 const Listener& listener, FileSet& files, Exported& exported);

}  // namespace hshfit::jobs
