#pragma once

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/files/atomic_file.h>

#include <string>

namespace hshfit::inline coefficient_files {

/// Writes a coefficient file; docs/reference/files.md describes both forms.
///
/// .json  every number exact: reading back gives the same doubles.
/// .exr   float32 (relative rounding 2^-24), one channel per coefficient and colour, width x height
///        of the outgoing set; the metadata is exact, in `hshfit:` attributes.
///
/// Throws UsageError for another extension, NumericError for a coefficient that is not finite or,
/// in the EXR form, beyond float32, and OutputError where the file cannot be written.
void writeCoefficients(const Coefficients& coefficients, const std::string& path);
/// The same to an open file, by the extension of its path; not committed.
void writeCoefficients(const Coefficients& coefficients, AtomicFile& file);

/// Reads either form, told apart by content. Sizes, names, ranges and finiteness are checked
/// before anything is allocated from them. Throws InputError naming the file and the field.
Coefficients readCoefficients(const std::string& path);

/// Whether the file says that it is a coefficient file, of whatever version: in its first 64 KiB
/// (JSON) or in its header (EXR). False for anything else, an unreadable file included.
bool looksLikeCoefficients(const std::string& path);

}  // namespace hshfit::inline coefficient_files
