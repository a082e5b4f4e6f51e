#pragma once

// The calls of Vulkan that devices and compilers share.

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/compute.h>

#include <fmt/format.h>
#include <vulkan/vulkan_raii.hpp>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace hshfit::gpu::inline vulkan {

/// Calls `make`; errors of Vulkan and of its loader become NumericError.
template <class Make>
auto vulkanCall(const Make& make) {
    try {
        return make();
    } catch (const vk::Error& error) {
        throw NumericError(fmt::format("Vulkan failed: {}", error.what()));
    } catch (const Error&) {
        throw;
    } catch (const std::runtime_error& error) {
        throw NumericError(fmt::format("there is no Vulkan here: {}", error.what()));
    }
}

vk::DescriptorType typeOf(ComputeResource::Kind kind);

/// The program as instances know it: Vulkan 1.1, with the layers and extensions of `info`.
vk::raii::Instance makeInstance(const vk::raii::Context& context, vk::InstanceCreateInfo info = {});

/// Descriptor set 0 of compute shaders with these bindings.
vk::raii::DescriptorSetLayout setLayoutOf(const vk::raii::Device& device,
                                          std::span<const ComputeResource> resources);

vk::raii::Pipeline computePipeline(const vk::raii::Device& device,
                                   const vk::raii::PipelineLayout& layout,
                                   std::span<const std::uint32_t> spirv,
                                   vk::PipelineCreateFlags flags = {});

}  // namespace hshfit::gpu::inline vulkan
