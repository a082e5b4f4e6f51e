#pragma once

#include "job_options.h"

#include <jobs/lighting/rotate.h>

#include <string>

namespace hshfit::python {

/// Throws as Keywords does.
jobs::RotateOptions rotationBy(const Rotation& rotation, const py::kwargs& keywords);
/// The method rotate of a class of coefficients.
OptionFunction rotateMethod(const std::string& type, const std::string& text);
/// {"method", "lost_energy", "error", "bands"}
py::dict rotatedDict(const jobs::Rotated& done);

}  // namespace hshfit::python
