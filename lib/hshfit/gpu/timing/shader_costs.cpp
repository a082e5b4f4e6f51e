#include <hshfit/gpu/timing/shader_costs.h>

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/spirv.h>

namespace hshfit::gpu::inline timing {

ShaderCosts::ShaderCosts() : ggx_(of(lobesShader(1))) {}

ShaderCost ShaderCosts::of(const TimedShader& shader) const {
    return compiler_.costOf(compileGlsl(shader.source), shader.resources);
}

std::optional<ShaderCost> ShaderCosts::of(const Representation& form) const {
    try {
        return of(timedShader(form));
    } catch (const UsageError&) {
        return std::nullopt;
    }
}

}  // namespace hshfit::gpu::inline timing
