#pragma once

#include <brdfs/rows/writer.h>

#include <string>

namespace hshfit::brdfs {

/// Samples an isotropic grey or RGB BRDF at the nodes of a MERL table (merl_layout.h) and writes it
/// as a MERL `.binary` file; read back, the nodes have the same values to rounding. A BRDF that
/// does not claim reciprocity is written with 360 differences in azimuth (69,984,012 bytes) in
/// place of 180 (34,992,012 bytes). Cells with a direction below the horizon hold -1; grey values
/// go to all three channels. The file appears only once it is complete.
///
/// Throws UsageError for an anisotropic or spectral BRDF, NumericError where f is negative or not
/// finite, OutputError if the file cannot be written or stands and is not to be replaced.
void writeMerl(const Brdf& brdf, const std::string& path, const WriteOptions& options);

/// The row of the table of writers.
const Writer& merlWriter();

}  // namespace hshfit::brdfs
