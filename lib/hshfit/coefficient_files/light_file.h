#pragma once

#include <hshfit/coefficients/light_coefficients.h>
#include <hshfit/files/atomic_file.h>

#include <string>
#include <string_view>

namespace hshfit::inline coefficient_files {

/// Writes coefficients of light as a JSON file (docs/explanation/light.md, schema light_file):
/// every number exact, so that reading back gives the same doubles. Throws NumericError for a
/// coefficient that is not finite, and OutputError where the file cannot be written.
void writeLight(const LightCoefficients& light, const std::string& path);
/// The same to an open file; not committed.
void writeLight(const LightCoefficients& light, AtomicFile& file);

/// Reads such a file. Names, ranges, shapes and finiteness are checked; keys that this version does
/// not know are ignored. Throws InputError naming the file and the field.
LightCoefficients readLight(const std::string& path);

/// Coefficients of light as a JSON document, and back; `file` is the name in messages. Reading
/// throws as `readLight` does.
std::string lightToJson(const LightCoefficients& light);
LightCoefficients lightFromJson(std::string_view text, const std::string& file);

/// Whether the file says in its first 64 KiB that it holds coefficients of light, of whatever
/// version. False for anything else, an unreadable file included.
bool isLightFile(const std::string& path);

}  // namespace hshfit::inline coefficient_files
