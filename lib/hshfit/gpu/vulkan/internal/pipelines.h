#pragma once

#include <hshfit/error.h>
#include <hshfit/gpu/vulkan/compute.h>

#include <fmt/format.h>
#include <vulkan/vulkan_raii.hpp>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace hshfit::gpu::inline vulkan {

/// The result of `make`, with Vulkan's errors as NumericError.
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

inline vk::DescriptorType typeOf(ComputeResource::Kind kind) {
    switch (kind) {
        case ComputeResource::Kind::sampledTexture:
            return vk::DescriptorType::eCombinedImageSampler;
        case ComputeResource::Kind::texture:
            return vk::DescriptorType::eSampledImage;
        case ComputeResource::Kind::sampler:
            return vk::DescriptorType::eSampler;
        case ComputeResource::Kind::uniforms:
            return vk::DescriptorType::eUniformBuffer;
        case ComputeResource::Kind::buffer:
            break;
    }
    return vk::DescriptorType::eStorageBuffer;
}

inline vk::raii::DescriptorSetLayout setLayoutOf(const vk::raii::Device& device,
                                                 std::span<const ComputeResource> resources) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (const ComputeResource& resource : resources) {
        bindings.emplace_back(resource.binding, typeOf(resource.kind), 1,
                              vk::ShaderStageFlagBits::eCompute);
    }
    return {device, vk::DescriptorSetLayoutCreateInfo({}, bindings)};
}

inline vk::raii::Pipeline pipelineOf(const vk::raii::Device& device,
                                     const vk::raii::PipelineLayout& layout,
                                     std::span<const std::uint32_t> spirv,
                                     vk::PipelineCreateFlags flags = {}) {
    const vk::raii::ShaderModule code(
        device, vk::ShaderModuleCreateInfo({}, spirv.size_bytes(), spirv.data()));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *code,
                                                  "main");
    return {device, nullptr, vk::ComputePipelineCreateInfo(flags, stage, *layout)};
}

}  // namespace hshfit::gpu::inline vulkan
