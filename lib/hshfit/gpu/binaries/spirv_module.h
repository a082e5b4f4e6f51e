#pragma once

#include <hshfit/gpu/binaries/module_bindings.h>
#include <hshfit/gpu/forms/form_shader.h>
#include <hshfit/gpu/payload.h>
#include <hshfit/gpu/proposals/proposal_record.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hshfit::gpu::inline binaries {

/// The work items of a group unless the specialisation constant 0 says otherwise.
constexpr int spirvGroup = 64;

/// SPIR-V 1.3 for Vulkan 1.1 with one entry point, the compute shader "main", which calls one
/// function of a snippet for each work item. Descriptor set 0:
///     0, 1  the textures or the uniform block that the function reads; nothing for constants
///     2     a storage buffer of items (std430), vectors of four floats, of which the fourth is not
///           read
///     3     a storage buffer of floats: the results of each item
///     4     of models of lighting, a storage buffer of the light
/// Specialisation constant 0 is the size of a group; work items beyond buffer 2 do nothing.
struct SpirvModule {
    std::string function;  ///< "eval", "sample", "pdf" or the function of a model of lighting
    std::vector<std::uint32_t> words;
    std::vector<ModuleBinding> bindings;
};

/// PREFIX_eval of pairs and, with a proposal, PREFIX_sample and PREFIX_pdf in modules of their own.
/// The values are what the functions return in GLSL. Throws UsageError, as the shader's source
/// does, and where the program was built without glslang.
std::vector<SpirvModule> spirvModules(const Payload& payload, const std::string& prefix,
                                      const std::optional<ProposalRecord>& proposal = {});
std::vector<SpirvModule> spirvModules(const FormPayload& payload, const FormShaderOptions& options,
                                      const std::optional<ProposalRecord>& proposal = {});

/// A function that gives the radiance of a surface (lighting/lighting_shader.h), as its module
/// calls it.
struct LightingCall {
    std::string prefix, function, snippet;
    bool tangent = false;    ///< after the normal
    bool cube = false;       ///< a cube map at binding 1
    bool areas = false;      ///< quadrilaterals, whose radiances are summed
    std::size_t lights = 0;  ///< else vectors that it takes as an array; 0: none
};
SpirvModule spirvLightingModule(const LightingCall& call);

/// The bytes of a file .spv, little-endian.
std::string spirvBytes(const std::vector<std::uint32_t>& words);

}  // namespace hshfit::gpu::inline binaries
