#pragma once

#include <hshfit/gpu/forms/form_payload.h>
#include <hshfit/gpu/shader.h>

#include <string>
#include <string_view>

namespace hshfit::gpu::inline forms {

/// The place of the numbers of a form in a shader.
enum class Storage {
    automatic,  ///< of storageFor
    constants,  ///< in its text, rounded to single precision: no texture, no uniform
    block,      ///< one uniform block of float32 vectors: the texels as a sampler returns them
    texture,    ///< the texels of a container, fetched without a filter
};
/// As many numbers as the smallest uniform block that WebGL2, OpenGL 4.5, Vulkan, Direct3D and
/// WebGPU promise has room for: 16 KiB of float32.
constexpr std::size_t mostConstants = 4096;
std::string_view storageName(Storage storage);  ///< "auto", "constants", "block", "texture"
/// Throws UsageError with the names.
Storage parseStorage(std::string_view name);
/// The storage that `automatic` stands for with this payload: above `mostConstants` numbers
/// texture, else constants.
Storage storageFor(const FormPayload& payload, Storage asked);

struct FormShaderOptions {
    std::string prefix = "hsh";  ///< of every name in the snippet
    Storage storage = Storage::automatic;
};

/// A snippet, to be pasted or included, unrolled for the terms of this file:
///     PREFIX_eval(wo, wi)     f(wo, wi) in 1/sr, as RepresentedBrdf::eval gives it, but not below
///     0;
///                             0 where either direction is not above the horizon
/// in the local frame. It has no trigonometric function and no loop. Constants of the form halfway
/// are the stored numbers in a basis of Chebyshev polynomials, and its lobe and ceilings stand in
/// the text in any storage. Throws UsageError, with the reason,
/// for what the language cannot take, a block beyond 16 KiB, and a form that adds a BRDF without
/// FormPayload::constant.
std::string formShaderSource(Language language, const FormPayload& payload,
                             const FormShaderOptions& options);

}  // namespace hshfit::gpu::inline forms
