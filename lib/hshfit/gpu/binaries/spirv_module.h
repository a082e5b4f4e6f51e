#pragma once

#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/payload.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hshfit::gpu::inline binaries {

/// The work items of a group unless the specialisation constant 0 says otherwise.
constexpr int spirvGroup = 64;

/// SPIR-V 1.3 for Vulkan 1.1 with one entry point, the compute shader "main", which evaluates one
/// pair of directions for each work item. Descriptor set 0:
///     0  the texture array of the coefficients with its sampler, or the numbers of a form as a
///        texture or a uniform block; nothing for a form whose numbers are constants
///     1  the texture array of the basis with its sampler, where the payload has one
///     2  a storage buffer of pairs (std430): wo and wi, a vec4 each, whose fourth is not read
///     3  a storage buffer of floats: the values of each pair, channel after channel
/// Specialisation constant 0 is the size of a group; work items beyond the pairs do nothing. The
/// values are what PREFIX_eval in GLSL returns. Throws UsageError, as the shader's source does, and
/// where the program was built without glslang.
std::vector<std::uint32_t> spirvModule(const Payload& payload, const std::string& prefix);
std::vector<std::uint32_t> spirvModule(const FormPayload& payload,
                                       const FormShaderOptions& options);

/// The GLSL that the module is made of.
std::string spirvSource(const Channels& channels, std::string_view prefix,
                        std::string_view snippet);

/// The bytes of a file .spv, little-endian.
std::string spirvBytes(const std::vector<std::uint32_t>& words);

}  // namespace hshfit::gpu::inline binaries
