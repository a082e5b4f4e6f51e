#pragma once

#include <brdfs/measured/measured_brdf.h>

#include <string>

namespace hshfit::brdfs {

/// Throws InputError, starting with `name`, if all values above the horizon are marked as not
/// measured.
void refuseWithoutValues(const Census& census, const std::string& name);

}  // namespace hshfit::brdfs
