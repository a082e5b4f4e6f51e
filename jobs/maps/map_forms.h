#pragma once

#include "choice_errors.h"
#include "map_work.h"

#include <hshfit/material_maps/texel_encoder.h>

#include <memory>

namespace hshfit::jobs {

/// A form that texels are stored in, and the means to measure its texels against their BRDFs.
struct MapForm {
    std::unique_ptr<TexelEncoder> encoder = {};
    std::unique_ptr<ChoiceErrors> checks = {};  ///< none of measured texels, or without checks
};

/// The form that the options ask for; forms with shared shapes list their choices. Of the form
/// halfway these are clusters, whose materials follow when the indices are written. Throws
/// UsageError.
MapForm formFor(MapWork& work, const SvbrdfOptions& options, Svbrdf& result, Processes& processes,
                const Listener& listener);

}  // namespace hshfit::jobs
