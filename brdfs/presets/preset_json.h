#pragma once

// The JSON of presets, included by sources only.

#include <hshfit/files/json_fields.h>

#include <string>
#include <string_view>

namespace hshfit::brdfs {

using Json = nlohmann::json;

/// An object whose "format" is this one and whose "version" is 1. `where` starts every message.
/// Throws InputError, as do the others.
Json parsePresetJson(std::string_view text, const std::string& format, const std::string& where);

/// "model": a bare name, because a ':' would start parameters.
std::string modelField(const JsonFields& preset);

/// "model:key=value,…" from an object of numbers, triples of numbers, booleans and words.
std::string presetSpec(const std::string& model, const Json& parameters, const std::string& where);

}  // namespace hshfit::brdfs
