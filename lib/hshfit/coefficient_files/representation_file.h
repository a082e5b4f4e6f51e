#pragma once

#include <hshfit/files/atomic_file.h>
#include <hshfit/representation/representation.h>

#include <string>

namespace hshfit::inline coefficient_files {

/// Writes a coefficient file (coefficient_file.h) in any form. Coefficients that are neither
/// rounded nor changed in kind are written plain; all others as JSON with a member
/// "representation", whose arrays are base64 of `packed`. Throws UsageError for an EXR of a
/// form that only JSON can hold, otherwise as `writeCoefficients`.
void writeRepresentation(const Representation& representation, const std::string& path);
/// The same to an open file, by the extension of its path; not committed.
void writeRepresentation(const Representation& representation, AtomicFile& file);

/// Reads a coefficient file in any form; plain coefficients become the form outgoing in float64
/// (EXR: float32). Shapes and sizes are checked against what the file holds before anything is
/// allocated. Throws InputError naming the file and the field.
Representation readRepresentation(const std::string& path);

}  // namespace hshfit::inline coefficient_files
