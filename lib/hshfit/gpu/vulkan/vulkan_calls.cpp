#include <hshfit/gpu/vulkan/internal/vulkan_calls.h>

namespace hshfit::gpu::inline vulkan {

vk::DescriptorType typeOf(ComputeResource::Kind kind) {
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

vk::raii::Instance makeInstance(const vk::raii::Context& context, vk::InstanceCreateInfo info) {
    const vk::ApplicationInfo application("hshfit", 1, nullptr, 0, VK_API_VERSION_1_1);
    info.setPApplicationInfo(&application);
    return {context, info};
}

vk::raii::DescriptorSetLayout setLayoutOf(const vk::raii::Device& device,
                                          std::span<const ComputeResource> resources) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (const ComputeResource& resource : resources) {
        bindings.emplace_back(resource.binding, typeOf(resource.kind), 1,
                              vk::ShaderStageFlagBits::eCompute);
    }
    return {device, vk::DescriptorSetLayoutCreateInfo({}, bindings)};
}

vk::raii::Pipeline computePipeline(const vk::raii::Device& device,
                                   const vk::raii::PipelineLayout& layout,
                                   std::span<const std::uint32_t> spirv,
                                   vk::PipelineCreateFlags flags) {
    const vk::raii::ShaderModule code(
        device, vk::ShaderModuleCreateInfo({}, spirv.size_bytes(), spirv.data()));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *code,
                                                  "main");
    return {device, nullptr, vk::ComputePipelineCreateInfo(flags, stage, *layout)};
}

}  // namespace hshfit::gpu::inline vulkan
