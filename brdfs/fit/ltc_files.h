#pragma once

#include <brdfs/fit/ltc_table.h>
#include <hshfit/files/file_set.h>

#include <array>
#include <string>
#include <vector>

namespace hshfit::brdfs {

/// The table as the two RGBA pictures of the published shaders, [row][column][channel]; columns in
/// roughness, rows in sqrt(1 - cos theta), row 0 (wo at the normal) first:
///     1   x, y, z, w of Minv = mat3(vec3(x, 0, y), vec3(0, 1, 0), vec3(z, 0, w)) (ltc.h)
///     2   magnitude, Schlick's part of it, 0, sphereAboveHorizon(2 column / (size - 1) - 1,
///         row / (size - 1)), which does not depend on the model
/// The albedo at F0 is F0 magnitude + (1 - F0) part.
std::array<std::vector<float>, 2> ltcPictures(const LtcTable& table);

/// Writes a table; the extension says how:
///     .json  one file: pictures, errors, what was fitted (docs/schemas/ltc.schema.json)
///     .exr   NAME_1.exr and NAME_2.exr, float32 RGBA
///     .dds   NAME_1.dds and NAME_2.dds, float16 RGBA (D3DFMT_A16B16G16R16F), header and order as
///            in the published files; values beyond 65504 become 65504
/// Returns what was written; of two files, both are complete before either has its name.
/// Throws UsageError for another extension, OutputError.
std::vector<std::string> writeLtcTable(const LtcTable& table, const std::string& path);
/// Writes the table into a set of files that is yet to be committed.
std::vector<std::string> writeLtcTable(const LtcTable& table, const std::string& path,
                                       FileSet& files);

/// The bytes that writeLtcTable would write. Throws UsageError for another extension.
std::vector<std::string> ltcOutputs(const std::string& path);

}  // namespace hshfit::brdfs
