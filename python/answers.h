#pragma once

// Answers of several functions as dictionaries, with the keys of the program's --json.

#include "module.h"

#include <hshfit/accuracy/metrics.h>
#include <hshfit/coefficients/coefficients.h>
#include <hshfit/pictures/picture_error.h>

#include <jobs/source/quality.h>
#include <jobs/studies/convert.h>

#include <optional>
#include <vector>

namespace hshfit::python {

/// As poorJson, or None.
py::object poorDict(const std::optional<jobs::Poor>& poor);
/// The object "picture" of the program's --json, or None.
py::object pictureDict(const std::optional<PictureError>& picture);
/// {"theta": …, "phi": …} in degrees.
py::dict angles(const Direction& d);
/// Name to {"value", "error", "reason", "wi", "wo"}; value and error are NaN where there are none.
py::dict metricsDict(const std::vector<MetricValue>& metrics);
py::dict convertedDict(const jobs::Converted& done);
/// {"value", "error", "finite", "reason"}
py::dict energyDict(const Energy& energy);

}  // namespace hshfit::python
