#pragma once

#include "bound_shader.h"
#include "kept_shader.h"
#include "shader_job.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hshfit::shaders {

/// The inputs of a job as compute shaders take them: wo and wi of every pair (6 numbers), then the
/// environment.
std::vector<float> inputNumbers(const ShaderJob& job);

/// The uniform block of a form that has one (binding 0 in place of the texture), else nothing: the
/// texels as a sampler returns them.
std::vector<float> blockNumbers(const ShaderJob& job);

/// The software device; with HSHFIT_TEST_GPU set, a GPU. Throws Missing where there is none.
std::unique_ptr<gpu::ComputeDevice> vulkanDevice(bool validate);

/// Runs a shader on the device of its interface: the software renderer, or with HSHFIT_TEST_GPU set
/// a GPU. Throws Missing where there is none.
std::vector<float> runHere(const BoundShader& shader);
/// If HSHFIT_KEEP_SHADERS names a folder, writes the shader that ran last there.
void keepLast(const std::string& kind, gpu::Language language, const std::string& name,
              const Wanted& wanted, const Bounds& bounds);

/// A function to be timed: a snippet in GLSL and an expression of type vec3.
struct TimedCall {
    int place = 0;  ///< of its row in the table
    std::string name, snippet;
    std::string before = {};  ///< declarations
    /// The expression. It may use wo and wi in the local frame, or the normal n and the viewer in
    /// the world; `material` is a number below 8.
    std::string call = "hsh_eval(wo, wi)";
};
/// If HSHFIT_KEEP_SHADERS names a folder, writes a shader there that evaluates the call as often as
/// its input says, for every pixel of a square (tests/gpu/device/timed.mustache). The snippet needs
/// `resources`.
void keepTimed(const TimedCall& timed, std::vector<gpu::ComputeResource> resources);

/// Vulkan: texture arrays at bindings 0 (coefficients) and 2 (basis), combined with their sampler
/// or not (then at 1), storage buffers at 3 (input) and 4 (output).
std::vector<float> runVulkan(const ShaderJob& job, const std::vector<std::uint32_t>& spirv,
                             bool combined);
/// OpenGL 4.5 compute shader, through EGL without a surface.
std::vector<float> runOpenGl(const ShaderJob& job, const std::string& source);
/// OpenGL ES 3 fragment shader into float targets, likewise.
std::vector<float> runOpenGlEs(const ShaderJob& job, const std::string& source);
/// A C++ program, made from `source` and the stubs in tests/gpu/shaders/metal and osl.
std::vector<float> runStub(const ShaderJob& job, const std::string& source);

/// The default runner of each language: Vulkan; OpenGL ES for GLSL ES; C++ for Metal and OSL.
std::vector<float> run(gpu::Language language, const ShaderJob& job, const std::string& source);

/// A runner of one language.
using Run = std::function<std::vector<float>(const ShaderJob&, const std::string& source)>;
/// The default one.
Run runnerOf(gpu::Language language);

/// The snippet with a main around it that evaluates every pair (tests/gpu/shaders/wrappers).
std::string wrapped(gpu::Language language, const ShaderJob& job, const std::string& snippet);

/// A snippet with a fault: `wrong` in place of the first `right`, which has to be there.
std::string withFault(std::string snippet, const std::string& right, const std::string& wrong);

/// SPIR-V by glslangValidator (GLSL, HLSL) or naga (WGSL), checked by spirv-val. Throws Refused.
std::vector<std::uint32_t> toSpirv(gpu::Language language, const std::string& source);
/// spirv-val for Vulkan 1.1. Throws Refused.
void validateSpirv(const std::vector<std::uint32_t>& words);
/// The text of spirv-dis.
std::string disassembled(const std::vector<std::uint32_t>& words);
/// glslangValidator on a fragment shader. Throws Refused.
void validateFragment(const std::string& source);

}  // namespace hshfit::shaders
