#pragma once

#include <jobs/source/facet_lobes.h>

#include <hshfit/filtered_maps/exports/lobe_text.h>

#include <string>

namespace hshfit::jobs {

/// The lobe of a map's model for shaders. Throws UsageError, which starts with `file`, for a model
/// without a closed form, naming those with one.
LobeText lobeText(const FacetLobes& lobes, const std::string& file);

}  // namespace hshfit::jobs
