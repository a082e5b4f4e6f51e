#pragma once

#include <jobs/common/listener.h>
#include "svbrdf.h"

#include <hshfit/material_maps/map_writer.h>

#include <string>

namespace hshfit::jobs {

/// Writes the texture of a map, of all levels of `result`, to a file that stands, and puts sizes,
/// rates and errors into the result; by all processes together.
MapWritten writeTexture(TexelSource& texels, TexelEncoder& encoder, const SvbrdfOptions& options,
                        const std::string& path, Svbrdf& result, const Listener& listener);

/// Errors as a PNG in grey, white at the largest; on a logarithmic scale over three decades.
std::string errorPicture(const MapWritten& written);

/// Says that errors are missing, where the time was over.
void sayTimeIsOver(const Svbrdf& result, const Listener& listener);

}  // namespace hshfit::jobs
