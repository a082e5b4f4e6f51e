#pragma once

#include <hshfit/gpu/payload.h>

#include <span>
#include <string>
#include <string_view>

namespace hshfit::gpu {

/// The languages that shaders are written in. Snippets of Slang are in HLSL; `fileText` makes the
/// module of them.
enum class Language { glslEs, glsl, hlsl, slang, wgsl, metal, osl };

/// A row of the language table.
struct LanguageEntry {
    Language language;
    std::string_view name;       ///< "glsl-es", "glsl", "hlsl", "slang", "wgsl", …
    std::string_view extension;  ///< of the file: "glsl", …
    std::string_view summary;
};
std::span<const LanguageEntry> languages();
/// NAME_PREFIX.glsl and so on.
std::string shaderFileName(const std::string& name, const LanguageEntry& language,
                           const std::string& prefix);

struct ShaderOptions {
    /// The prefix of every name in the snippet, so that one program can contain two snippets.
    std::string prefix = "hsh";
    /// Bands of the SH environment that `shade` takes; 0: no `shade`.
    int environmentOrder = 5;
};

/// A snippet, to be pasted or included, unrolled for this payload:
///     PREFIX_eval(wo, wi)     q(wo, wi) in the local frame, clamped at 0 once, after the sum
///     PREFIX_evalRaw(wo, wi)  the same, not clamped
///     PREFIX_shade(wo, env)   integral of f(wo, wi) L(wi) cos(theta_i) over the hemisphere, L
///     given
///                             by its SH coefficients in the local frame (orthonormal, slot
///                             l(l+1)+m, the sign convention of the payload)
///     PREFIX_shadeWorld(wo, t, b, n, light)  the same, with wo, the axes of the surface and L in
///                             the world
/// Directions below the horizon give 0. Throws UsageError for a payload that the language cannot
/// take, with the reason.
std::string shaderSource(Language language, const Payload& payload, const ShaderOptions& options);

/// The text of a file with one snippet or several; `stem` is the file's name without its extension,
/// by which a Slang module is called (slang.h). Other languages are left as they are.
std::string fileText(Language language, const std::string& snippets, std::string_view stem);

}  // namespace hshfit::gpu
