#include "runners.h"
#include "vk_device.h"

#include <algorithm>
#include <cstring>
#include <optional>

namespace hshfit::shaders {
namespace {

VkSampler makeSampler(VkDevice device) {
    VkSamplerCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    info.magFilter = info.minFilter = VK_FILTER_LINEAR;
    info.addressModeU = info.addressModeV = info.addressModeW =
        VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    VkSampler sampler = nullptr;
    check(vkCreateSampler(device, &info, nullptr, &sampler), "vkCreateSampler");
    return sampler;
}

}  // namespace

std::vector<float> runVulkan(const ShaderJob& job, const std::vector<std::uint32_t>& spirv,
                             bool combined) {
    Device device;
    const std::vector<float> inputs = inputNumbers(job);
    const std::size_t pairs = job.pairs.wo.size();
    std::vector<float> outputs(pairs * job.outputs());
    const VkSampler sampler = makeSampler(device.device);
    {
        Buffer in(device, inputs.size() * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        Buffer out(device, outputs.size() * 4, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        std::memcpy(in.data, inputs.data(), inputs.size() * 4);
        const Image coefficients(device, job.payload.coefficients);
        std::optional<Image> basis;
        if (job.payload.basisTexels) basis.emplace(device, *job.payload.basisTexels);

        const auto imageType =
            combined ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
        const auto buffer = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        const auto ready = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        const std::vector<float> numbers = blockNumbers(job);
        Buffer block(device, std::max<std::size_t>(numbers.size(), 4) * 4,
                     VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
        std::memcpy(block.data, numbers.data(), numbers.size() * 4);
        std::vector<Pipeline::Resource> resources{{3, buffer, {}, {in.buffer, 0, VK_WHOLE_SIZE}},
                                                  {4, buffer, {}, {out.buffer, 0, VK_WHOLE_SIZE}}};
        if (numbers.empty())
            resources.push_back({0, imageType, {sampler, coefficients.view, ready}, {}});
        else
            resources.push_back(
                {0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, {}, {block.buffer, 0, VK_WHOLE_SIZE}});
        if (!combined) resources.push_back({1, VK_DESCRIPTOR_TYPE_SAMPLER, {sampler, {}, {}}, {}});
        if (basis) resources.push_back({2, imageType, {sampler, basis->view, ready}, {}});
        const Pipeline pipeline(device, spirv, resources);
        device.submit([&](VkCommandBuffer commands) {
            pipeline.dispatch(commands, static_cast<std::uint32_t>(pairs / 64));
            VkMemoryBarrier barrier{};
            barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
            barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
            barrier.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
            vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                 VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0,
                                 nullptr);
        });
        std::memcpy(outputs.data(), out.data, outputs.size() * 4);
    }
    vkDestroySampler(device.device, sampler, nullptr);
    if (!device.messages().empty()) throw Refused(device.messages().front());
    return outputs;
}

}  // namespace hshfit::shaders
