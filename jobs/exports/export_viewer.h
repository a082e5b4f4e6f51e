#pragma once

#include "export.h"

#include <hshfit/files/file_set.h>
#include <hshfit/light/catalog.h>
#include <hshfit/representation/representation.h>

namespace hshfit::jobs {

/// Adds the viewer's page to `files` and `exported`, if there are `lights`: of the coefficients in
/// `exported`, or of the form there beside order-7 HSH textures of the same source. `source` may be
/// null; `stored` is the coefficient file.
void writeViewer(const Representation& stored, const Brdf* source,
                 const std::vector<LightSpecification>& lights, const ExportOptions& options,
                 const Listener& listener, FileSet& files, Exported& exported);

}  // namespace hshfit::jobs
