#pragma once

#include "module.h"

#include <jobs/lighting/rotate.h>

#include <string>

namespace hshfit::python {

/// Throws UsageError for an unknown method.
jobs::RotateOptions rotateOptions(const Rotation& rotation, const std::string& method,
                                  double tolerance, int tables);
/// {"method", "lost_energy", "error", "bands"}
py::dict rotatedDict(const jobs::Rotated& done);

}  // namespace hshfit::python
