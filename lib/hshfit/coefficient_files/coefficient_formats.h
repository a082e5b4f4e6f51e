#pragma once

// The two forms of a coefficient file, apart from where their bytes come from.

#include <hshfit/coefficients/coefficients.h>
#include <hshfit/files/atomic_file.h>
#include <hshfit/representation/representation.h>

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hshfit::inline files {
class JsonFields;
}

namespace hshfit::inline coefficient_files {

/// The "format" of a coefficient file.
inline constexpr const char* coefficientFormat = "hshfit-coefficients";

/// No form of a coefficient file nests its JSON more deeply.
inline constexpr int deepestJson = 8;

/// At most `limit` bytes of a regular file. Throws InputError.
std::string readRegularFile(const std::string& path, std::size_t limit);

/// The values with commas between them, so that reading gives the same doubles.
void appendJsonNumbers(std::span<const double> values, std::string& out);

/// Radians in degrees, rounded to 1e-10: 52 comes back from a unit vector as 51.99999999999999.
double tidyDegrees(double angle);

/// Throws InputError unless the root says this "format" and a "version" of at most `newest`.
void requireFormat(const JsonFields& root, std::string_view format, int newest);

/// The object "basis" of a file.
struct BasisName {
    std::string name;
    int order = 0;
    bool condonShortley = false;
};
std::string basisText(const BasisName& basis);
/// Throws InputError that names the field.
BasisName readBasisName(const JsonFields& basis);

/// The head as (key, JSON text), in the order in which it is written.
using CoefficientMetadata = std::vector<std::pair<std::string, std::string>>;

/// The head of a coefficient file as it is written.
CoefficientMetadata metadataOf(const CoefficientHead& head);

/// The head of a coefficient file from its root object; keys that this version does not know are
/// ignored. It has outgoing directions only if they number `outgoingCount`, which the caller has
/// counted in the file. Throws InputError that names the file and the field.
CoefficientHead readHead(const JsonFields& root, std::size_t outgoingCount);

/// The part of it that sidecars of texels hold as well: no format, version, tolerance and least
/// squares.
CoefficientHead readSharedHead(const JsonFields& root, std::size_t outgoingCount);

/// Throws NumericError at the first coefficient that is not finite.
void requireFinite(const Coefficients& coefficients);

/// Coefficients as a JSON document, and back. `file` is the name in messages; reading throws
/// InputError that names it and the field.
std::string coefficientsToJson(const Coefficients& coefficients);
Coefficients coefficientsFromJson(std::string_view text, const std::string& file);

/// The form with a member "representation".
std::string representationToJson(const Representation& representation);
Representation representationFromJson(std::string_view text, const std::string& file);
/// Whether a text that begins a JSON file has that member at its top level, by a look at the keys.
bool hasRepresentation(std::string_view text);

/// Coefficients as an OpenEXR file, and back. `file` is the name in messages; reading throws
/// InputError that names it.
void coefficientsToExr(const Coefficients& coefficients, AtomicFile& file);
Coefficients coefficientsFromExr(std::string_view bytes, const std::string& file);

}  // namespace hshfit::inline coefficient_files
