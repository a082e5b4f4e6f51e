#pragma once

#include <jobs/maps/filtered.h>

#include <string>

namespace hshfit::cli {

/// The answer for a map of filtered lobes.
std::string textOf(const jobs::FilteredMapAnswer& done);

}  // namespace hshfit::cli
