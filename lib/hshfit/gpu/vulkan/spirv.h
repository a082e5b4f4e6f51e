#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace hshfit::gpu::inline vulkan {

/// Whether the program was built with the compiler.
bool compilesGlsl();

/// SPIR-V of a GLSL 4.50 compute shader with the entry "main", for Vulkan 1.1, by
/// glslang, whose code drivers optimise. Throws NumericError with the compiler's first message.
std::vector<std::uint32_t> compileGlsl(const std::string& source);

}  // namespace hshfit::gpu::inline vulkan
