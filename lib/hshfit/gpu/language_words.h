#pragma once

#include <hshfit/brdf/channels.h>
#include <hshfit/gpu/shader.h>

#include <kainjow/mustache.hpp>

#include <string>
#include <string_view>

namespace hshfit::gpu {

/// A template for each language; GLSL ES and GLSL, or HLSL and Slang, may have one together.
struct LanguageTexts {
    std::string_view glslEs, glsl, hlsl, wgsl, metal, osl;
};
std::string_view textOf(Language language, const LanguageTexts& texts);

/// Sets the words in which languages differ, as the templates of all shaders name them:
///     real, vec2, vec3, vec4, int           types, which also construct and convert
///     let, let2, let3, let4, letInt         begin the declaration of a constant
///     var, var3, varInt                     begin the declaration of a variable
///     toReal, toInt, atan2, dot, inline     conversions, functions, the word before a function
///     texel, basisTexel, env, light         lookups, coefficients of the light: local and world
///     prefix, PREFIX                        of names
///     glslEs, glsl, hlsl, wgsl, metal, osl  true for the language; Slang is HLSL
void setLanguageWords(Language language, const std::string& prefix, kainjow::mustache::data& page);

/// After setLanguageWords: the kind of channels as `grey`, `colour` or `spectral`, `channelCount`
/// and `channelNames`, the `type` of a BRDF's value and its `zero`.
void setChannelWords(const Channels& channels, kainjow::mustache::data& page);

/// The text of a word that is set.
std::string wordOf(const kainjow::mustache::data& page, const std::string& key);

}  // namespace hshfit::gpu
