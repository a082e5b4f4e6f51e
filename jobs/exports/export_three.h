#pragma once

#include "export.h"

#include <hshfit/brdf/brdf.h>
#include <hshfit/files/file_set.h>

namespace hshfit::jobs {

/// Adds the modules and the page of the target three to `files` and `exported`. `brdf` is what is
/// shown, or its source. A package.json that stands in the folder stays, with a note, unless files
/// are replaced.
void writeThree(const Brdf& brdf, const ExportOptions& options, const Listener& listener,
                FileSet& files, Exported& exported);

}  // namespace hshfit::jobs
