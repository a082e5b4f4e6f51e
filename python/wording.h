#pragma once

#include <hshfit/wording.h>

namespace hshfit::python {

/// Settings and functions of the library in messages, as Python has them: "order=12" for
/// Form::order, "hshfit.project('ggx', order=12)" for a projection.
Wording pythonWording();

}  // namespace hshfit::python
