#pragma once

#include <hshfit/gpu/timing/timed_shader.h>
#include <hshfit/gpu/vulkan/cost.h>

#include <optional>
#include <string>

namespace hshfit::gpu::inline timing {

/// Costs of shaders on an AMD GPU that need not be there (AmdCompiler), with the directions of the
/// pixel that they are evaluated for, if they need any.
class ShaderCosts {
public:
    /// Throws NumericError where Mesa's driver or a compiler for GLSL is not there.
    ShaderCosts();

    const std::string& device() const { return compiler_.device(); }
    const ShaderCost& ggx() const { return ggx_; }  ///< of Lambert with one lobe of GGX

    /// Throws NumericError for a shader that does not compile.
    ShaderCost of(const TimedShader& shader) const;
    /// The same for a form; none where it has no shader of its own.
    std::optional<ShaderCost> of(const Representation& form) const;

private:
    AmdCompiler compiler_;
    ShaderCost ggx_;
};

}  // namespace hshfit::gpu::inline timing
