#pragma once

#include "command.h"

#include <jobs/maps/filtered.h>

#include <string>

namespace hshfit::cli {

/// Makes a map of filtered lobes and prints the answer.
void runFilteredMap(const std::string& description, const std::string& folder,
                    const jobs::FilteredMapOptions& options, const Globals& globals);

}  // namespace hshfit::cli
