#pragma once

#include <hshfit/gpu/vulkan/compute.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace hshfit::gpu::inline vulkan {

/// The statements of a compiler on a compute shader.
struct ShaderCost {
    std::uint64_t instructions = 0;
    std::uint64_t vectorRegisters = 0;  ///< that a subgroup has, in steps of the hardware
    std::uint64_t scalarRegisters = 0;
    std::uint64_t spilled = 0;            ///< registers of both kinds that are kept in memory
    std::uint64_t inverseThroughput = 0;  ///< estimated busy cycles for one subgroup
    std::uint64_t latency = 0;            ///< the same with stalls
    std::uint64_t codeBytes = 0;
};

/// Mesa's compiler for AMD GPUs (RADV), which needs no card: the driver makes a device of a family
/// without hardware (RADV_FORCE_FAMILY, docs.mesa3d.org/envvars.html), and its pipelines state what
/// VK_KHR_pipeline_executable_properties has. Estimates of a compiler; nothing runs.
class ShaderCompiler {
public:
    /// `family` as the driver names it: "navi21", "polaris10", "vega10", "gfx1100". The variable is
    /// set while the driver looks for devices, so that no other thread should open one meanwhile.
    /// Throws NumericError where the driver or the family is missing.
    explicit ShaderCompiler(const std::string& family = "navi21");
    ShaderCompiler(const ShaderCompiler&) = delete;
    ShaderCompiler& operator=(const ShaderCompiler&) = delete;
    ~ShaderCompiler();

    const std::string& name() const { return name_; }  ///< as the driver gives it

    /// Of `resources` the bindings and kinds count. Throws NumericError for a shader that does not
    /// compile.
    ShaderCost costOf(std::span<const std::uint32_t> spirv,
                      std::span<const ComputeResource> resources) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
    std::string name_;
};

}  // namespace hshfit::gpu::inline vulkan
