#pragma once

#include <hshfit/gpu/vulkan/compute.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace hshfit::gpu::inline vulkan {

/// The cost of a compute shader, as a driver's compiler states it
/// (VK_KHR_pipeline_executable_properties).
struct ShaderCost {
    std::uint64_t instructions = 0;
    std::uint64_t registers = 0;  ///< vector registers of a thread
    std::uint64_t spilled = 0;    ///< vector registers that memory has to hold
    /// Inverse throughput: cycles of the busiest unit for a wave of 64 threads, as the compiler
    /// estimates it, without waits for memory.
    std::uint64_t cycles = 0;
};

/// Mesa's compiler for AMD GPUs, which needs no card: it compiles for a Navi 21, or for the family
/// in the environment variable RADV_FORCE_FAMILY.
class AmdCompiler {
public:
    /// Throws NumericError where Mesa's driver is not there. The environment is changed while the
    /// driver is looked for: make one before threads read it.
    AmdCompiler();
    AmdCompiler(const AmdCompiler&) = delete;
    AmdCompiler& operator=(const AmdCompiler&) = delete;
    ~AmdCompiler();

    const std::string& device() const { return name_; }  ///< as Mesa names it: "NAVI21"

    /// The cost of a shader with the entry "main" and things at bindings of descriptor set 0.
    /// Throws NumericError for one that does not compile.
    ShaderCost costOf(std::span<const std::uint32_t> spirv,
                      std::span<const ComputeResource> resources) const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
    std::string name_;
};

}  // namespace hshfit::gpu::inline vulkan
