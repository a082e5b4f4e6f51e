#pragma once

// The two forms of a coefficient file, apart from where their bytes come from.

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/representation/representation.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::inline coefficient_files {

/// Everything but the coefficients as (key, JSON text), in the order in which it is written.
using CoefficientMetadata = std::vector<std::pair<std::string, std::string>>;

CoefficientMetadata metadataOf(const Coefficients& coefficients);

/// `text` is one JSON object; keys that this version does not know are ignored. The result has
/// every field but `values`, and outgoing directions only if they number `outgoingCount`, which the
/// caller has counted in the file. Throws InputError that starts with `file`.
Coefficients coefficientsFromMetadata(std::string_view text, std::size_t outgoingCount,
                                      const std::string& file);

/// Throws NumericError at the first coefficient that is not finite.
void requireFinite(const Coefficients& coefficients);

std::string coefficientsToJson(const Coefficients& coefficients);
Coefficients coefficientsFromJson(std::string_view text, const std::string& file);

/// The form with a member "representation".
std::string representationToJson(const Representation& representation);
Representation representationFromJson(std::string_view text, const std::string& file);
/// Whether a text that begins a JSON file has that member at its top level, by a look at the keys.
bool hasRepresentation(std::string_view text);

void coefficientsToExr(const Coefficients& coefficients, AtomicFile& file);
Coefficients coefficientsFromExr(std::string_view bytes, const std::string& file);

}  // namespace hshfit::inline coefficient_files
